// The check of ply files that mesh_check.h describes.
#pragma once

#include <string>
#include <string_view>

namespace vislab {

/// Throws InputError unless every element that the header counts is there and the faces' vertex
/// indices are in range. Text and both binary orders.
void check_ply(std::string_view bytes, const std::string& where);

}  // namespace vislab
