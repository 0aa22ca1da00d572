#include "common/render/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/render/canvas.h"

namespace vislab {
namespace {

constexpr Color white = {255, 255, 255};
constexpr Color grey = {110, 110, 110};
constexpr double margin = 16.0;
constexpr double title_height = 40.0;
constexpr double panel_height = 512.0;
constexpr double bar_width = 30.0;
constexpr double tick_width = 110.0;
constexpr double row_height = 22.0;

/// Ten colours of viridis, equally spaced; between them it is straight to within 2 of 255.
constexpr std::array<Color, 10> viridis = {{{68, 1, 84},
                                            {72, 40, 120},
                                            {62, 74, 137},
                                            {49, 104, 142},
                                            {38, 130, 142},
                                            {31, 158, 137},
                                            {53, 183, 121},
                                            {109, 205, 89},
                                            {180, 222, 44},
                                            {253, 231, 37}}};

Color color_at(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * (viridis.size() - 1.0);
  const auto i = std::min(static_cast<std::size_t>(place), viridis.size() - 2);
  const double rest = place - static_cast<double>(i);
  Color color{};
  for (std::size_t k = 0; k < 3; ++k) {
    color[k] = static_cast<std::uint8_t>(
        std::lround(viridis[i][k] * (1.0 - rest) + viridis[i + 1][k] * rest));
  }
  return color;
}

Image colored(const HeatMapInput& input, std::uint32_t top) {
  Image image{input.width, input.height, {}};
  image.rgb.reserve(3 * input.counts.size());
  const auto width = static_cast<std::size_t>(input.width);
  for (std::size_t row = static_cast<std::size_t>(input.height); row-- > 0;) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint32_t count = input.counts[row * width + x];
      const Color color = count == 0 ? white : heat_color(count, top);
      image.rgb.insert(image.rgb.end(), color.begin(), color.end());
    }
  }
  return image;
}

/// Counts that the bar names: 1, 2, 5, 10, ... below the top, and the top itself.
std::vector<std::uint32_t> ticks_up_to(std::uint32_t top) {
  std::vector<std::uint32_t> ticks;
  std::uint64_t decade = 1;
  while (decade < top) {
    for (const std::uint64_t step : {1, 2, 5}) {
      const std::uint64_t tick = step * decade;
      // Keeps clear of the top's own number.
      if (static_cast<double>(tick) < 0.8 * top) ticks.push_back(static_cast<std::uint32_t>(tick));
    }
    decade *= 10;
  }
  ticks.push_back(top);
  return ticks;
}

void draw_bar(Canvas& canvas, double left, std::uint32_t top, const std::string& counted) {
  const double foot = title_height + panel_height;
  for (int i = 0; i < static_cast<int>(panel_height); ++i) {
    canvas.fill(left, foot - 1.0 - i, bar_width, 1.0, color_at(i / (panel_height - 1.0)));
  }
  canvas.outline(left, title_height, bar_width, panel_height, grey, 1.0);
  for (const std::uint32_t tick : ticks_up_to(top)) {
    const double share = std::log(static_cast<double>(tick)) / std::log(static_cast<double>(top));
    const double y = foot - share * (panel_height - 1.0);
    canvas.fill(left + bar_width, y - 0.5, 6.0, 1.0, grey);
    canvas.text(left + bar_width + 10.0, std::clamp(y + 5.0, title_height + 12.0, foot),
                tick_width - bar_width, 14.0, false, std::to_string(tick));
  }
  canvas.text(left, foot + row_height, bar_width + tick_width, 14.0, false, counted);
  canvas.text(left, foot + 2.0 * row_height, bar_width + tick_width, 14.0, false, "white: none");
}

}  // namespace

Color heat_color(std::uint32_t count, std::uint32_t top) {
  return color_at(std::log(static_cast<double>(count)) / std::log(static_cast<double>(top)));
}

Image render_heat_map(const HeatMapInput& input) {
  const auto pixels =
      static_cast<std::size_t>(input.width) * static_cast<std::size_t>(input.height);
  if (input.width < 1 || input.height < 1 || input.counts.size() != pixels) {
    throw std::logic_error("render_heat_map: there must be a count for each pixel");
  }
  const std::uint32_t top = std::max(*std::ranges::max_element(input.counts), 2U);
  const double zoom = std::min(panel_height / input.height, 1024.0 / input.width);
  const double map_width = std::max(1.0, std::round(zoom * input.width));
  const double map_height = std::max(1.0, std::round(zoom * input.height));
  const double bar_left = 2.0 * margin + map_width;
  const double width = bar_left + bar_width + tick_width + margin;
  const double rows = std::max(2.0, static_cast<double>(input.lines.size()));
  const double height = title_height + panel_height + (rows + 1.0) * row_height;
  Canvas canvas(static_cast<int>(width), static_cast<int>(height), white);
  canvas.text(margin, 27.0, width - 2.0 * margin, 20.0, true, input.title);
  canvas.picture(colored(input, top), {0, 0}, {input.width, input.height}, margin, title_height,
                 map_width, map_height);
  canvas.outline(margin, title_height, map_width, map_height, grey, 1.0);
  draw_bar(canvas, bar_left, top, input.counted);
  for (std::size_t i = 0; i < input.lines.size(); ++i) {
    canvas.text(margin, title_height + panel_height + row_height * static_cast<double>(i + 1),
                map_width, 14.0, false, input.lines[i]);
  }
  return canvas.image();
}

}  // namespace vislab
