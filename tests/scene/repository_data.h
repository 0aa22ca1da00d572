// The scenes and paths that the repository describes.
#pragma once

#include "common/scene/library.h"

namespace vislab::test {

inline DataFolders repository_data() {
  const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  return {data, data / "cache"};
}

}  // namespace vislab::test
