// Camera paths: what happens from frame to frame. Deterministic; made from a description or
// recorded.
#pragma once

#include <string>
#include <vector>

#include "common/scene/frame.h"

namespace vislab {

struct PathFrame {
  Camera camera;
  Changes changes;  // applied before this frame is drawn
};

struct Path {
  std::string name;
  std::vector<PathFrame> frames;  // at least one

  /// Hash of all cameras and changes; 32 hexadecimal digits.
  std::string content_hash() const;
};

}  // namespace vislab
