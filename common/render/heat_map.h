// Counts by pixel as a picture with a colour bar.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/render/class_view.h"

namespace vislab {

struct HeatMapInput {
  int width = 0, height = 0;              // of the counts, at least 1
  std::span<const std::uint32_t> counts;  // rows from bottom to top
  std::string title;
  std::string counted;             // what the counts count, for the bar
  std::vector<std::string> lines;  // of text below
};

/// The colour of a count from 1 to `top`, by its logarithm: the palette viridis (van der Walt and
/// Smith, 2015), which grows lighter evenly and is read with every kind of colour vision. Counts
/// above `top` look like it. `top` is at least 2.
Color heat_color(std::uint32_t count, std::uint32_t top);

/// Pixels without anything are white. Throws std::logic_error if the input does not fit together.
/// O(pixels).
Image render_heat_map(const HeatMapInput& input);

}  // namespace vislab
