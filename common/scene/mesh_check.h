// Checks of mesh files before a foreign importer sees them: that all is there which the file
// promises.
#pragma once

#include <string>
#include <string_view>

namespace vislab {

/// `format` is the file name's extension in lower case without the dot; `where` begins messages.
/// ply: elements as counted in the header, vertex indices in range. off: vertices and faces as
/// counted, indices in range. obj: whole vertices and faces, indices in range. stl: as many
/// triangles as counted, or an end. Other formats pass. Throws InputError. O(size), no copies.
void check_mesh_bytes(std::string_view bytes, const std::string& format, const std::string& where);

}  // namespace vislab
