#include "common/render/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/render/class_view.h"
#include "common/render/outside_view.h"
#include "tests/render/small_scenes.h"

namespace vislab {
namespace {

using test::cube_mesh;
using test::frame_of;
using test::object_at;
using test::square_mesh;

/// Where the view from the eye starts in the picture.
constexpr int eye_left = 16;
constexpr int eye_top = 64;

Color pixel(const Image& image, int x, int y) {
  const std::uint8_t* const p = &image.rgb[3 * (static_cast<std::size_t>(y) * image.width + x)];
  return {p[0], p[1], p[2]};
}

bool has(const Image& image, const Color& color, int left, int top, int right, int bottom) {
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      if (pixel(image, x, y) == color) return true;
    }
  }
  return false;
}

/// CIE lightness, 0 to 100, of an sRGB colour.
double lightness(const Color& color) {
  const auto linear = [](std::uint8_t value) {
    const double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  const double y =
      0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
  return 116.0 * std::cbrt(y) - 16.0;
}

/// A square that faces the eye, upper right of the middle, and a cube behind the eye.
class Picture : public testing::Test {
 protected:
  Picture() {
    scene_.meshes = {square_mesh(), cube_mesh()};
    scene_.objects = {object_at(0, {1.0, 1.0, -4.0}, 2.0), object_at(1, {0.0, 0.0, 5.0})};
    scene_.finish();
    state_ = std::make_unique<SceneState>(scene_);
    frame_ = frame_of(*state_, {64, 64});
    classes_.assign(scene_.triangle_count(), TriangleClass::culled_rightly);
    input_.scene = &scene_;
    input_.frame = &frame_;
    input_.title = "scene · culler · frame 1";
  }

  Image render(TriangleClass square) {
    classes_[0] = classes_[1] = square;
    input_.classes = classes_;
    return render_picture(input_);
  }

  Scene scene_;
  std::unique_ptr<SceneState> state_;
  Frame frame_;
  std::vector<TriangleClass> classes_;
  PictureInput input_;
};

TEST_F(Picture, ShowsEachClassInItsColourFromTheEye) {
  for (std::size_t i = 0; i < triangle_class_count; ++i) {
    const Image image = render(static_cast<TriangleClass>(i));
    const Color shown = pixel(image, eye_left + 300, eye_top + 200);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(shown[channel], class_colors[i][channel], 12) << i;
    }
    EXPECT_EQ(pixel(image, eye_left + 200, eye_top + 300), background_color);
  }
}

TEST_F(Picture, ShowsWhatIsCulledOutsideTheViewInTheOtherView) {
  const Image image = render(TriangleClass::kept_visible);
  bool dim = false;
  bool bright = false;
  for (int y = eye_top; y < eye_top + 512; ++y) {
    for (int x = eye_left + 528; x < image.width - 16; ++x) {
      const Color color = pixel(image, x, y);
      dim = dim || (color[0] > 40 && color[0] < 85 && std::abs(color[0] - color[2]) < 25);
      bright = bright || color[2] > 150;
    }
  }
  EXPECT_TRUE(dim);
  EXPECT_TRUE(bright);
}

TEST_F(Picture, HasALegendWithAllColours) {
  const Image image = render(TriangleClass::kept_visible);
  for (const Color& color : class_colors) {
    EXPECT_TRUE(has(image, color, eye_left, eye_top + 520, eye_left + 40, image.height));
  }
}

TEST_F(Picture, EnlargesTheWorstPlaceOnlyWhereThereAreWrongPixels) {
  const int height = render(TriangleClass::culled_wrongly).height;
  // (0, 0) is the lower left pixel: the square is in the upper right quarter.
  for (int y = 40; y < 50; ++y) {
    for (int x = 40; x < 50; ++x) input_.wrong_pixels.push_back({x, y});
  }
  input_.wrong_pixels.push_back({3, 3});
  const Image image = render(TriangleClass::culled_wrongly);
  EXPECT_GT(image.height, height);
  bool found = false;
  for (int y = eye_top + 528; y < image.height - 16; ++y) {
    const Color color = pixel(image, eye_left + 528 + 96, y);
    found = found || (color[0] > 190 && color[2] < 20);
  }
  EXPECT_TRUE(found);
}

TEST_F(Picture, DoesNotDrawHiddenObjects) {
  Changes changes;
  changes.hidden = {0};
  state_->apply(changes);
  frame_.objects = state_->view();
  const Image image = render(TriangleClass::kept_visible);
  EXPECT_EQ(pixel(image, eye_left + 300, eye_top + 200), background_color);
}

TEST_F(Picture, IsTheSameEachTime) {
  EXPECT_EQ(render(TriangleClass::kept_visible), render(TriangleClass::kept_visible));
}

TEST_F(Picture, TakesFramesOfAnyShapeAndCamera) {
  for (const Viewport viewport : {Viewport{1, 1}, Viewport{300, 7}, Viewport{5, 200}}) {
    frame_.viewport = viewport;
    input_.wrong_pixels = {{0, 0}};
    EXPECT_GT(render(TriangleClass::culled_wrongly).width, 512);
  }
  frame_.viewport = {64, 64};
  frame_.camera.lens.far_m = std::numeric_limits<double>::infinity();
  EXPECT_GT(render(TriangleClass::kept_visible).width, 512);
  frame_.camera.lens = orthographic_lens(8.0, 1.0, -1.0, 50.0);
  const Image image = render(TriangleClass::kept_visible);
  EXPECT_GT(pixel(image, eye_left + 300, eye_top + 200)[2], 200);
}

TEST_F(Picture, RefusesInputThatDoesNotFitTogether) {
  input_.wrong_pixels = {{64, 0}};
  EXPECT_THROW(render(TriangleClass::kept_visible), std::logic_error);
  input_.wrong_pixels.clear();
  classes_.pop_back();
  EXPECT_THROW(render(TriangleClass::kept_visible), std::logic_error);
}

TEST(ClassColors, DifferInLightnessToo) {
  for (std::size_t i = 0; i < class_colors.size(); ++i) {
    EXPECT_GT(lightness(class_colors[i]), lightness(background_color) + 15.0);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GT(std::abs(lightness(class_colors[i]) - lightness(class_colors[j])), 15.0)
          << i << " " << j;
    }
  }
}

TEST_F(Picture, TheOutsideViewHoldsTheEyeAndAllThatIsVisible) {
  classes_[0] = classes_[1] = TriangleClass::kept_visible;
  input_.classes = classes_;
  for (const glm::dvec3& target :
       {glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 1)}) {
    frame_.camera.pose = look_at({0.5, 0.5, 0.0}, glm::dvec3(0.5, 0.5, 0.0) + target);
    const OutsideView view = fit_outside_view(input_, 1.5);
    EXPECT_GT(view.frustum_depth, 0.0);
    for (const glm::dvec3& point :
         {frame_.camera.pose.eye, glm::dvec3(0, 0, -4), glm::dvec3(2, 2, -4)}) {
      WindowLine line{};
      ASSERT_TRUE(project_line(view.camera, {600, 400}, point, point, line));
      EXPECT_TRUE(line.from.x > 0 && line.from.x < 600 && line.from.y > 0 && line.from.y < 400);
    }
  }
}

TEST(ProjectLine, CutsAtTheNearPlaneAndDropsWhatIsBehind) {
  Camera camera;
  camera.lens = perspective_lens(1.5707963267948966, 1.0, 1.0, 100.0);
  WindowLine line{};
  EXPECT_FALSE(project_line(camera, {100, 100}, {0, 0, 1}, {5, 0, 2}, line));
  ASSERT_TRUE(project_line(camera, {100, 100}, {0.5, 0, 3}, {0.5, 0, -5}, line));
  EXPECT_NEAR(line.from.x, 75.0, 1e-9);  // at depth 1
  EXPECT_NEAR(line.to.x, 55.0, 1e-9);
  EXPECT_NEAR(line.to.y, 50.0, 1e-9);
}

TEST(FrustumEdges, StartAtTheEyeAndEndAtTheGivenDepth) {
  Camera camera;
  camera.lens = perspective_lens(1.0, 1.0, 0.1, std::numeric_limits<double>::infinity());
  double deepest = 0.0;
  double nearest = 1.0;
  for (const auto& edge : frustum_edges(camera, 20.0)) {
    for (const glm::dvec3& point : edge) {
      deepest = std::max(deepest, camera.planar_depth(point));
      nearest = std::min(nearest, camera.planar_depth(point));
    }
  }
  EXPECT_NEAR(deepest, 20.0, 1e-9);
  EXPECT_NEAR(nearest, 0.0, 1e-9);
}

}  // namespace
}  // namespace vislab
