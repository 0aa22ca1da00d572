#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "common/render/colored_view.h"
#include "common/render/query_boxes.h"
#include "common/render/query_strip.h"
#include "common/render/query_timeline.h"
#include "tests/render/small_scenes.h"

namespace vislab {
namespace {

using test::frame_of;
using test::object_at;
using test::square_mesh;

constexpr Color nothing = {0, 0, 0};

Color pixel(const Image& image, int x, int y) {
  const std::uint8_t* const p = &image.rgb[3 * (static_cast<std::size_t>(y) * image.width + x)];
  return {p[0], p[1], p[2]};
}

/// Shading takes some of a colour.
bool is_like(const Color& seen, const Color& wanted) {
  int difference = 0;
  for (std::size_t k = 0; k < 3; ++k) difference += std::abs(seen[k] - wanted[k]);
  return difference <= 12;
}

/// The same hue in any light.
bool is_hue_of(const Color& seen, const Color& color) {
  const int light = std::max({seen[0], seen[1], seen[2]});
  const int full = std::max({color[0], color[1], color[2]});
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(seen[k] * full - color[k] * light) > 6 * 255) return false;
  }
  return light > full / 3;
}

/// A square left of the middle and one right of it, both facing the eye, and a third behind it.
class QueryPictures : public testing::Test {
 protected:
  QueryPictures() {
    scene_.meshes = {square_mesh()};
    scene_.objects = {object_at(0, {-1.0, 0.0, -4.0}), object_at(0, {1.0, 0.0, -4.0}),
                      object_at(0, {0.0, 0.0, 5.0})};
    scene_.finish();
    state_ = std::make_unique<SceneState>(scene_);
    frame_ = frame_of(*state_, {64, 64});
  }

  Scene scene_;
  std::unique_ptr<SceneState> state_;
  Frame frame_;
};

// In a picture of 64 x 64 with a lens of 60 degrees, x = 1 at depth 4 lies 14 pixels from the
// middle.
constexpr int left_x = 18, right_x = 46, middle_y = 32;

TEST_F(QueryPictures, ObjectsHaveTheirColoursAndThoseWithoutOneAreLeftAway) {
  const std::vector<Color> colors = {cycled_color(1), nothing, nothing};
  const Image image = draw_colored(scene_, frame_, colors, {}, false);
  ASSERT_EQ(image.width, 64);
  EXPECT_TRUE(is_like(pixel(image, left_x, middle_y), cycled_color(1)));
  EXPECT_EQ(pixel(image, right_x, middle_y), background_color);
  EXPECT_EQ(pixel(image, 1, 1), background_color);
}

TEST_F(QueryPictures, BoxesHideWhatIsBehindThemAndNotWhatIsBefore) {
  const std::vector<Color> colors(3, cycled_color(1));
  const Aabb behind{{-2.0F, -0.5F, -8.0F}, {-1.0F, 0.5F, -7.0F}};
  const Aabb before{{0.5F, -0.5F, -4.0F}, {1.5F, 0.5F, -3.9F}};
  const std::vector<ColoredBox> boxes = {
      {behind, cycled_color(3)}, {before, cycled_color(4)}, {Aabb{}, cycled_color(5)}};
  const Image image = draw_colored(scene_, frame_, colors, boxes, false);
  EXPECT_TRUE(is_like(pixel(image, left_x, middle_y), cycled_color(1)));
  EXPECT_TRUE(is_like(pixel(image, right_x, middle_y), cycled_color(4)));
}

TEST_F(QueryPictures, AFlatBoxIsDrawnToo) {
  const std::vector<Color> colors(3, nothing);
  const ColoredBox flat{{{0.5F, -0.5F, -4.0F}, {1.5F, 0.5F, -4.0F}}, cycled_color(2)};
  const Image image = draw_colored(scene_, frame_, colors, {&flat, 1}, false);
  EXPECT_TRUE(is_like(pixel(image, right_x, middle_y), cycled_color(2)));
}

TEST_F(QueryPictures, NeighbouringStatesHaveDifferentColours) {
  for (std::size_t i = 0; i < 2 * cycled_colors; ++i) {
    EXPECT_FALSE(is_like(cycled_color(i), cycled_color(i + 1)));
  }
}

TEST_F(QueryPictures, TheStripHasAMarkForEachCommandInTheColourOfItsState) {
  StripRow row;
  row.name = "some.culler";
  row.states = {{false, 2}, {true, 1}, {false, 1}};
  row.state_of_object = {0, 2, none_id};
  const Image image = render_query_strip({&scene_, &frame_, "title", {row}});
  // Marks are 12 wide from x = 16 on; a draw is 14 high from y = 66 on, a query the lower 6 of it.
  for (const int x : {17, 29}) EXPECT_EQ(pixel(image, x, 68), cycled_color(0));
  EXPECT_EQ(pixel(image, 41, 68), (Color{255, 255, 255}));
  EXPECT_EQ(pixel(image, 41, 77), cycled_color(1));
  EXPECT_EQ(pixel(image, 53, 68), cycled_color(2));
  EXPECT_EQ(pixel(image, 65, 77), (Color{255, 255, 255}));
  // The frame: 528 pixels wide from (16, 154) on.
  const double zoom = 528.0 / 64.0;
  const auto at = [&](int x) {
    return pixel(image, static_cast<int>(16 + zoom * x), static_cast<int>(154 + zoom * middle_y));
  };
  EXPECT_TRUE(is_like(at(left_x), cycled_color(0)));
  EXPECT_TRUE(is_like(at(right_x), cycled_color(2)));
}

TEST_F(QueryPictures, AFrameOfManyCommandsStaysAsWideAndGetsLines) {
  StripRow row;
  row.state_of_object.assign(3, none_id);
  for (int i = 0; i < 4000; ++i) row.states.push_back({i % 2 == 1, 1});
  const Image many = render_query_strip({&scene_, &frame_, "", {row}});
  row.states.resize(10);
  const Image few = render_query_strip({&scene_, &frame_, "", {row}});
  EXPECT_EQ(many.width, few.width);
  EXPECT_GT(many.height, few.height);
  EXPECT_LT(many.height, few.height + 30 * 18);
}

TEST_F(QueryPictures, BoxesOfOneQueryHaveOneColourAndSeenOnesAreLeftAway) {
  QueryBoxesRow row;
  row.name = "some.culler";
  row.is_drawn.assign(3, 1);
  const Aabb left{{-1.5F, -0.5F, -6.0F}, {-0.5F, 0.5F, -5.0F}};
  const Aabb right{{0.5F, -0.5F, -6.0F}, {1.5F, 0.5F, -5.0F}};
  const auto colored = [&](const std::vector<BoxesOfQuery>& queries) {
    row.queries = queries;
    const Image image = render_query_boxes({&scene_, &frame_, "title", {row}});
    std::array<int, 2> pixels{};  // of the first colour and the second
    for (int y = 100; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        for (std::size_t k = 0; k < 2; ++k) {
          if (is_hue_of(pixel(image, x, y), cycled_color(k))) ++pixels[k];
        }
      }
    }
    return pixels;
  };
  const std::array<int, 2> together = colored({{{left, right}, 0}});
  EXPECT_GT(together[0], 100);
  EXPECT_EQ(together[1], 0);
  const std::array<int, 2> apart = colored({{{left, left}, 0}, {{right, right}, 0}});
  EXPECT_GT(apart[0], 100);
  EXPECT_GT(apart[1], 100);
  EXPECT_LT(apart[0], together[0]);
  EXPECT_EQ(colored({{{left, right}, 5}})[0], 0);
  EXPECT_EQ(colored({{{left}, 0}})[0], 0);
}

GpuCommand command(GpuCommandKind kind, GpuInterval host, GpuInterval device, bool changes) {
  GpuCommand made;
  made.kind = kind;
  made.count = 2;
  made.host = host;
  made.device = device;
  made.changes_state = changes;
  return made;
}

std::vector<GpuCommand> a_frame() {
  return {command(GpuCommandKind::draw, {0.0, 250.0}, {250.0, 500.0}, false),
          command(GpuCommandKind::query, {250.0, 500.0}, {500.0, 750.0}, true),
          command(GpuCommandKind::wait, {500.0, 1000.0}, {}, false)};
}

TEST_F(QueryPictures, TheTimeLineAddsUpWhatBothClocksDid) {
  const TimelineFigures figures = figures_of(a_frame());
  EXPECT_EQ(figures.frame_us, 1000.0);
  EXPECT_EQ(figures.waits_us, 500.0);
  EXPECT_EQ(figures.device_us, 500.0);
  EXPECT_EQ(figures.draws, 2U);
  EXPECT_EQ(figures.queries, 1U);
  EXPECT_EQ(figures.boxes, 2U);
  EXPECT_EQ(figures.state_changes, 1U);
}

TEST_F(QueryPictures, TheTimeLineShowsWhatBothDoWhen) {
  const Image image = render_query_timeline({"title", {{"some.culler", a_frame()}}});
  // Lanes are 980 wide from x = 110 on; the processor's from y = 96, the device's from y = 138.
  const auto host = [&](int percent) { return pixel(image, 110 + 980 * percent / 100, 110); };
  const auto device = [&](int percent) { return pixel(image, 110 + 980 * percent / 100, 155); };
  const Color draws = {0, 114, 178};
  const Color queries = {230, 159, 0};
  const Color waits = {204, 121, 167};
  const Color idle = {238, 240, 243};
  EXPECT_EQ(host(12), draws);
  EXPECT_EQ(host(37), queries);
  EXPECT_EQ(host(75), waits);
  EXPECT_EQ(device(12), idle);
  EXPECT_EQ(device(37), draws);
  EXPECT_EQ(device(62), queries);
  EXPECT_EQ(device(87), idle);
}

TEST_F(QueryPictures, InputThatDoesNotFitTogetherIsRefused) {
  EXPECT_THROW(draw_colored(scene_, frame_, std::vector<Color>(2), {}, false), std::logic_error);
  EXPECT_THROW(render_query_strip({&scene_, &frame_, "", {}}), std::logic_error);
  EXPECT_THROW(render_query_strip({&scene_, &frame_, "", {StripRow{}}}), std::logic_error);
  EXPECT_THROW(render_query_boxes({&scene_, &frame_, "", {QueryBoxesRow{}}}), std::logic_error);
  EXPECT_THROW(render_query_timeline({}), std::logic_error);
  EXPECT_EQ(figures_of({}).frame_us, 0.0);
}

}  // namespace
}  // namespace vislab
