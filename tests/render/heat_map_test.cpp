#include "common/render/heat_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace vislab {
namespace {

double lightness(const Color& color) {
  return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

TEST(HeatMap, ColoursGrowLighterWithTheCount) {
  for (const std::uint32_t top : {2U, 10U, 1000U}) {
    for (std::uint32_t count = 1; count < top; ++count) {
      EXPECT_LE(lightness(heat_color(count, top)), lightness(heat_color(count + 1, top)) + 0.5);
    }
    EXPECT_EQ(heat_color(1, top), (Color{68, 1, 84}));
    EXPECT_EQ(heat_color(top, top), (Color{253, 231, 37}));
    EXPECT_EQ(heat_color(2 * top, top), heat_color(top, top));
  }
}

TEST(HeatMap, ShowsEveryPixelInItsColourAndUpright) {
  // Lower row 0 and 1, upper row 1 and 16.
  const std::vector<std::uint32_t> counts{0, 1, 1, 16};
  const Image image = render_heat_map({2, 2, counts, "title", "things", {"a line"}});
  const auto pixel = [&](int x, int y) {
    const std::size_t at = 3 * (static_cast<std::size_t>(y) * image.width + x);
    return Color{image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
  };
  // The map is 512 by 512 from (16, 40) on.
  EXPECT_EQ(pixel(16 + 128, 40 + 128), heat_color(1, 16));
  EXPECT_EQ(pixel(16 + 384, 40 + 128), heat_color(16, 16));
  EXPECT_EQ(pixel(16 + 128, 40 + 384), (Color{255, 255, 255}));
  EXPECT_EQ(pixel(16 + 384, 40 + 384), heat_color(1, 16));
}

TEST(HeatMap, IsDrawnOfNothingAndOfOddSizesAndRefusesCountsThatDoNotFit) {
  const std::vector<std::uint32_t> counts(33 * 7, 0);
  EXPECT_GT(render_heat_map({33, 7, counts, "", "", {}}).width, 33);
  EXPECT_THROW(render_heat_map({33, 8, counts, "", "", {}}), std::logic_error);
  EXPECT_THROW(render_heat_map({0, 0, {}, "", "", {}}), std::logic_error);
}

}  // namespace
}  // namespace vislab
