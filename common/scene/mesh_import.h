// Mesh files of any format that assimp reads: ply, off, obj, stl, glTF, … and each of them gzipped.
#pragma once

#include <filesystem>

#include "common/scene/scene.h"

namespace vislab {

/// Meshes and objects of a file, not yet finished; `name` is the file's stem. Nodes that bear
/// meshes become objects with the node's transform; nodes that share a mesh still do. Polygons are
/// triangulated and vertices at equal positions joined; nothing else is dropped, moved or
/// reordered.
///
/// The foreign importer runs in a child process, for `time_limit_s` seconds at most: its crash,
/// hang or failure is an InputError here. ply, off, obj and stl files are checked by the lab first,
/// since assimp takes truncated ones for whole.
Scene import_mesh_file(const std::filesystem::path& file, unsigned time_limit_s = 120);

}  // namespace vislab
