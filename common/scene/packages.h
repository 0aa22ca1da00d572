// Which packages a scene needs that are not there.
#pragma once

#include <string>
#include <vector>

#include "common/scene/library.h"

namespace vislab {

/// The packages with files of the scene that have not been fetched, each once; empty for scenes
/// that need none, and for meshes and worlds that are files. `name_or_file` is as load_scene takes
/// it; descriptions are read, and nothing is loaded. Throws InputError as load_scene does.
std::vector<std::string> missing_packages(const std::string& name_or_file,
                                          const DataFolders& folders);

}  // namespace vislab
