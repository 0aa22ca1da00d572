#include "common/render/cell_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <span>
#include <stdexcept>

#include "common/render/class_view.h"
#include "common/render/plan_shapes.h"
#include "common/scene/convex_region.h"
#include "tests/render/small_scenes.h"

namespace vislab {
namespace {

TEST(PlanShapes, TheOutlineOfABoxIsItsRectangle) {
  const PlanPolygon outline = outline_of(box_region({0.0, 0.0, 0.0}, {2.0, 1.0, 3.0}));
  ASSERT_EQ(outline.size(), 4U);
  for (const glm::dvec2& corner : outline) {
    EXPECT_TRUE(std::abs(corner.x) < 1e-9 || std::abs(corner.x - 2.0) < 1e-9);
    EXPECT_TRUE(std::abs(corner.y) < 1e-9 || std::abs(corner.y - 3.0) < 1e-9);
  }
}

TEST(PlanShapes, PointsWithinAHullAndOnItsEdgesAreNoCorners) {
  const PlanPolygon hull =
      convex_hull({{0, 0}, {2, 0}, {1, 0}, {2, 2}, {1, 1}, {0, 2}, {0, 0}, {0, 1}});
  EXPECT_EQ(hull, (PlanPolygon{{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
  EXPECT_TRUE(convex_hull({}).empty());
}

TEST(PlanShapes, ARegionIsCutOnlyWhereItIs) {
  const ConvexRegion region = box_region({0.0, 1.0, 0.0}, {2.0, 2.0, 3.0});
  EXPECT_EQ(cut_at(region, 1.5).size(), 4U);
  EXPECT_TRUE(cut_at(region, 0.5).empty());
  EXPECT_TRUE(cut_at(region, 2.5).empty());
}

TEST(PlanShapes, APolygonIsCutInALineUnlessItLiesToOneSide) {
  const std::vector<glm::dvec3> door = {{1, 0, 0}, {1, 2, 0}, {1, 2, 4}, {1, 0, 4}};
  PlanLine line;
  ASSERT_TRUE(cut_at(door, 1.0, line));
  EXPECT_EQ(std::min(line[0].y, line[1].y), 0.0);
  EXPECT_EQ(std::max(line[0].y, line[1].y), 4.0);
  EXPECT_EQ(line[0].x, 1.0);
  EXPECT_FALSE(cut_at(door, 2.5, line));
  const std::vector<glm::dvec3> floor = {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}};
  EXPECT_FALSE(cut_at(floor, 1.0, line));
}

/// Two rooms beside each other along x with an opening between them, and a wall in each.
class CellPlan : public testing::Test {
 protected:
  CellPlan() {
    scene_.meshes = {test::square_mesh()};
    scene_.objects = {test::object_at(0, {-2.0, 0.0, 0.0}, 3.0),
                      test::object_at(0, {2.0, 0.0, 0.0}, 3.0)};
    for (const double left : {-4.0, 0.0}) {
      Cell cell;
      cell.regions = {box_region({left, -2.0, -4.0}, {left + 4.0, 2.0, 4.0})};
      cell.bounds = cell.regions[0].bounds;
      scene_.cells.push_back(cell);
    }
    scene_.portals = {make_portal({{0, -1, -1}, {0, -1, 1}, {0, 1, 1}, {0, 1, -1}}, 0, 1)};
    scene_.finish();
    state_ = std::make_unique<SceneState>(scene_);
    frame_ = test::frame_of(*state_, {64, 64});
    input_.scene = &scene_;
    input_.frame = &frame_;
    input_.objects = classes_;
  }

  /// Lines are drawn smoothly.
  static std::size_t count(const Image& image, const Color& color, int tolerance) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
      int difference = 0;
      for (std::size_t k = 0; k < 3; ++k) difference += std::abs(image.rgb[i + k] - color[k]);
      found += difference <= tolerance ? 1 : 0;
    }
    return found;
  }

  Scene scene_;
  std::unique_ptr<SceneState> state_;
  Frame frame_;
  std::vector<TriangleClass> classes_{TriangleClass::kept_visible, TriangleClass::culled_wrongly};
  CellPlanInput input_;
};

TEST_F(CellPlan, LightsTheCellsThatWereReached) {
  // To the right, where both rooms have their place: half of the picture's panel each.
  const auto lit_right = [&](std::span<const CellId> reached) {
    input_.reached = reached;
    Image image = render_cell_plan(input_);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
      if (i / 3 % image.width < static_cast<std::size_t>(image.width / 2)) image.rgb[i] = 255;
    }
    return count(image, {40, 92, 76}, 6);
  };
  const std::vector<CellId> one = {1};
  const std::vector<CellId> both = {0, 1};
  EXPECT_EQ(lit_right({}), 0U);
  EXPECT_GT(lit_right(one), 50000U);
  EXPECT_GT(lit_right(both), 3 * lit_right(one) / 2);
}

TEST_F(CellPlan, DrawsObjectsInTheColourOfTheirClass) {
  const Color& missing = class_colors[static_cast<std::size_t>(TriangleClass::culled_wrongly)];
  const std::size_t with = count(render_cell_plan(input_), missing, 60);
  classes_[1] = TriangleClass::culled_rightly;
  const std::size_t without = count(render_cell_plan(input_), missing, 60);
  EXPECT_GT(with, without + 100);
}

TEST_F(CellPlan, RefusesASceneWithoutCellsAndMissingClasses) {
  input_.objects = {};
  EXPECT_THROW(render_cell_plan(input_), std::logic_error);
  input_.objects = classes_;
  Scene bare = scene_;
  bare.cells.clear();
  input_.scene = &bare;
  EXPECT_THROW(render_cell_plan(input_), std::logic_error);
}

}  // namespace
}  // namespace vislab
