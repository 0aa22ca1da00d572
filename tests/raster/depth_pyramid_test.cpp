// The Z-pyramid against brute force, and the wrong ones against it.
#include "common/raster/depth_pyramid.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/geometry/random.h"

namespace vislab {
namespace {

class Image {
 public:
  Image(int width, int height, Random& random)
      : width_(width), values_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    // Few different values, so that many are equal.
    for (float& value : values_) value = static_cast<float>(random.below(20));
  }

  std::span<const float> values() const { return values_; }
  float& at(int x, int y) {
    return values_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(x)];
  }
  float farthest(const TexelRect& rect) {
    float least = at(rect.x0, rect.y0);
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) least = std::min(least, at(x, y));
    }
    return least;
  }

 private:
  int width_;
  std::vector<float> values_;
};

TexelRect random_rect(int width, int height, Random& random) {
  const auto below = [&](int end) {
    return static_cast<int>(random.below(static_cast<std::uint64_t>(end)));
  };
  TexelRect rect;
  rect.x0 = below(width);
  rect.y0 = below(height);
  rect.x1 = rect.x0 + 1 + below(width - rect.x0);
  rect.y1 = rect.y0 + 1 + below(height - rect.y0);
  return rect;
}

template <typename Rules>
bool equal(const BasicDepthPyramid<Rules>& a, const BasicDepthPyramid<Rules>& b) {
  for (int level = 0; level < a.level_count(); ++level) {
    for (int y = 0; y < a.height(level); ++y) {
      for (int x = 0; x < a.width(level); ++x) {
        if (a.at(level, x, y) != b.at(level, x, y)) return false;
      }
    }
  }
  return true;
}

/// Rectangles of images of all sizes up to 70 x 70 that the pyramid calls nearer than they are.
template <typename Rules>
int lies_about_rectangles() {
  Random random(1);
  int lies = 0;
  for (int height = 1; height <= 70; ++height) {
    for (int width = 1; width <= 70; ++width) {
      Image image(width, height, random);
      BasicDepthPyramid<Rules> pyramid(width, height);
      pyramid.build(image.values());
      for (int i = 0; i < 4; ++i) {
        const TexelRect rect = random_rect(width, height, random);
        const float farthest = image.farthest(rect);
        if (pyramid.not_nearer_than(rect) > farthest) ++lies;
        if (pyramid.nearer_everywhere(rect, farthest)) ++lies;
        // Exact, so that nothing hidden is kept either.
        EXPECT_TRUE(pyramid.nearer_everywhere(rect, farthest - 0.5F));
      }
    }
  }
  return lies;
}

struct RoundedDown : PyramidRules {
  static int halved(int size) { return size / 2; }
};

TEST(DepthPyramid, AnswersAboutRectanglesOfImagesOfAnySizeExactly) {
  EXPECT_EQ(lies_about_rectangles<PyramidRules>(), 0);
}

TEST(DepthPyramid, WhoseLevelsAreRoundedDownLosesTheLastOddRowAndColumn) {
  EXPECT_GT(lies_about_rectangles<RoundedDown>(), 100);
}

TEST(DepthPyramid, RoundsItsLevelsUpToASingleTexel) {
  const DepthPyramid pyramid(129, 3);
  ASSERT_EQ(pyramid.level_count(), 9);
  EXPECT_EQ(pyramid.width(1), 65);
  EXPECT_EQ(pyramid.height(1), 2);
  EXPECT_EQ(pyramid.width(8), 1);
  EXPECT_EQ(pyramid.height(8), 1);
  EXPECT_EQ(DepthPyramid(1, 1).level_count(), 1);
}

TEST(DepthPyramid, StaysAsIfBuiltAnewWhenTexelsComeNearer) {
  Random random(2);
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 5}, {64, 32}, {65, 33}}) {
    Image image(width, height, random);
    DepthPyramid pyramid(width, height);
    pyramid.build(image.values());
    for (int i = 0; i < 2'000; ++i) {
      const TexelRect place = random_rect(width, height, random);
      float& value = image.at(place.x0, place.y0);
      const auto offered = static_cast<float>(random.below(40));
      value = std::max(value, offered);
      pyramid.raise(place.x0, place.y0, offered);
      if (i % 100 != 99) continue;
      DepthPyramid anew(width, height);
      anew.build(image.values());
      EXPECT_TRUE(equal(pyramid, anew)) << width << " x " << height;
    }
  }
}

struct OnlyIfFarther : PyramidRules {
  static bool concerns_parent(float /*overwritten*/, float value, float parent) {
    return value < parent;
  }
};

// Kowalka 2016, 2.4.2.
TEST(DepthPyramid, UpdatedOnlyWithWhatIsFartherNeverGetsNearer) {
  BasicDepthPyramid<OnlyIfFarther> pyramid(8, 8);
  pyramid.clear(1.0F);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) pyramid.raise(x, y, 2.0F);
  }
  EXPECT_EQ(pyramid.at(3, 0, 0), 1.0F);
}

TEST(DepthPyramid, LeavesParentsAloneThatAnotherTexelHoldsBack) {
  DepthPyramid pyramid(64, 64);
  pyramid.clear(0.0F);
  const std::uint64_t before = pyramid.texels_touched();
  pyramid.raise(10, 10, 1.0F);
  // The texel, its parent, and the four that the parent is made of.
  EXPECT_EQ(pyramid.texels_touched() - before, 6U);
  pyramid.raise(10, 10, 2.0F);
  EXPECT_EQ(pyramid.texels_touched() - before, 8U);
}

TEST(DepthPyramid, AsksForTheTexelsThatItDoesNotDecideOnly) {
  DepthPyramid pyramid(64, 64);
  pyramid.clear(2.0F);
  pyramid.build([](int x, int y) { return x == 40 && y == 9 ? 1.0F : 2.0F; });
  int asked = 0;
  const auto decide = [&](int x, int y) {
    EXPECT_EQ(x, 40);
    EXPECT_EQ(y, 9);
    ++asked;
    return true;
  };
  EXPECT_TRUE(pyramid.nearer_everywhere({0, 0, 64, 64}, 1.5F, decide));
  EXPECT_EQ(asked, 1);
  EXPECT_TRUE(pyramid.nearer_everywhere({0, 0, 40, 64}, 1.5F, decide));
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace vislab
