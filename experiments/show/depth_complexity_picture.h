// Depth complexity of frames by all three definitions, and a heat map of one.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "common/judge/depth_complexity.h"

namespace vislab {

/// By DepthComplexity.
using DepthComplexityTable = std::array<DepthComplexityFigures, 3>;

/// Measures a frame by all three definitions and writes a heat map by `pictured` to `file` (PNG).
/// An empty `file`: no picture. Throws InputError if the file cannot be written.
DepthComplexityTable measure_depth_complexity(const Scene& scene, const Frame& frame,
                                              DepthComplexity pictured, const std::string& title,
                                              const std::filesystem::path& file);

}  // namespace vislab
