// "WIDTHxHEIGHT" as users write it.
#pragma once

#include <string>

#include "common/geometry/camera.h"

namespace vislab {

/// Throws InputError unless both numbers are whole and from 1 to 16384.
Viewport parse_resolution(const std::string& text);

}  // namespace vislab
