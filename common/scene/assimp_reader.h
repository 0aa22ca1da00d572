// What runs in the importer's child process: the only code that meets assimp.
#pragma once

#include <optional>
#include <string>

#include "common/scene/scene.h"

namespace vislab {

/// Reads `file`, or `bytes` if given, as `format` (an extension without the dot). Gives meshes and
/// objects as import_mesh_file says. Throws std::runtime_error, or crashes, or never returns.
Scene read_with_assimp(const std::string& file, const std::optional<std::string>& bytes,
                       const std::string& format);

}  // namespace vislab
