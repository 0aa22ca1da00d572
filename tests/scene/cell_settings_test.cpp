// Cells and portals written by hand in a scene's description.
#include "common/scene/cell_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "common/scene/cell_check.h"
#include "tests/input_error.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

/// A sheet that reaches through two cells.
constexpr const char* mesh = "OFF\n3 1 0\n-2 0.5 0\n2 0.5 0\n-2 0.5 1\n3 0 1 2\n";
constexpr const char* two_cells = R"(
[mesh]
file = "mesh.off"
[[cells]]
boxes = [[-3, 0, -3], [0, 3, 3], [-3, 3, -3], [-1, 4, 3]]
[[cells]]
through = [[0, 0, 0], [3, 0, 0], [0, 0, 0], [0, 3, 0], [0, 0, -3], [0, 0, 3]]
inward = [[2, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
)";
constexpr const char* portal = R"(
[[portals]]
from = 0
to = 1
corners = [[0, 0, -1], [0, 0, 1], [0, 2, 1], [0, 2, -1]]
)";

Scene loaded(const TemporaryFolder& folder, const std::string& text) {
  folder.write("mesh.off", mesh);
  return load_scene(folder.write("scene.toml", text).string(), test::repository_data()).scene;
}

TEST(CellSettings, ReadBoxesPlanesAndPortalsBothWays) {
  const TemporaryFolder folder;
  const Scene scene = loaded(folder, std::string(two_cells) + portal);
  ASSERT_EQ(scene.cells.size(), 2U);
  EXPECT_EQ(scene.cells[0].regions.size(), 2U);
  EXPECT_EQ(scene.cells[0].bounds.max, glm::vec3(0.0F, 4.0F, 3.0F));
  EXPECT_EQ(scene.cells[1].bounds.min, glm::vec3(0.0F, 0.0F, -3.0F));
  EXPECT_EQ(scene.cells[1].bounds.max, glm::vec3(3.0F, 3.0F, 3.0F));
  ASSERT_EQ(scene.portals.size(), 2U);
  EXPECT_EQ(scene.portals[0].plane.normal, glm::dvec3(-1.0, 0.0, 0.0));
  EXPECT_EQ(scene.portals[1].plane.normal, glm::dvec3(1.0, 0.0, 0.0));
  EXPECT_EQ(scene.portals[1].from, 1U);
  EXPECT_EQ(scene.cells[0].objects, std::vector<ObjectId>{0});
  EXPECT_EQ(scene.cells[1].objects, std::vector<ObjectId>{0});
  const CellCheck check = check_cells(scene);
  EXPECT_EQ(check.overlaps.count + check.gaps.count + check.off.count, 0U);
}

std::string with_corners(const std::string& corners) {
  return std::string(two_cells) + "[[portals]]\nfrom = 0\nto = 1\ncorners = " + corners + "\n";
}

TEST(CellSettings, TakeCornersOnStraightEdgesAndRepeatedOnes) {
  const TemporaryFolder folder;
  // On an edge through thirds and tenths, where rounding makes corners turn right a little.
  const Scene scene =
      loaded(folder, with_corners("[[0, 0, -2], [0, 0, -2], [0, 0, 1], [0, 3, 1], [0, 2.1, 0.1],"
                                  " [0, 1.9, -0.1], [0, 0.3, -1.7], [0, 0, -2]]"));
  ASSERT_EQ(scene.portals.size(), 2U);
  EXPECT_EQ(scene.portals[0].polygon.size(), 6U);
  EXPECT_EQ(loaded(folder, with_corners("[[0, 0, 0], [0, 0, 2], [0, 3, 2], [0, 2.1, 1.4], "
                                        "[0, 0.9, 0.6], [0, 0.3, 0.2]]"))
                .portals[0]
                .polygon.size(),
            6U);
  EXPECT_EQ(
      loaded(folder, with_corners("[[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 0.333333, 0.333333]]"))
          .portals.size(),
      2U);
}

TEST(CellSettings, RefusePortalsThatAreNotConvexOrNotFlat) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& corners) {
    return input_error([&] { loaded(folder, with_corners(corners)); });
  };
  const std::string convex = "it must be a convex polygon, whose";
  const std::string l_shape = "[[0, 0, -2], [0, 0, 2], [0, 1, 2], [0, 1, 0],";
  EXPECT_TRUE(says(message(l_shape + "[0, 3, 0], [0, 3, -2]]"), convex));
  EXPECT_TRUE(says(message(l_shape + "[0, 1, 0], [0, 3, 0], [0, 3, -2]]"), convex));
  EXPECT_TRUE(says(message("[[0, 2.5, 0], [0, 0.38, 0.69], [0, 1.69, -1.11], "
                           "[0, 1.69, 1.11], [0, 0.38, -0.69]]"),
                   convex))
      << "a star";
  EXPECT_TRUE(says(message("[[0, 0, 0], [0, 0, 2], [0, 0, 1], [0, 1, 1], [0, 1, 0]]"), convex))
      << "an edge that turns back";
  EXPECT_TRUE(says(message("[[0, 0, 0], [0, 0, 1], [0, 0, 1], [0, 0, 0]]"), "three different"));
  EXPECT_TRUE(says(message("[[0, 0, -1], [0, 0, 1], [0, 2, 1], [0.002, 2, -1]]"), "one plane"));
  EXPECT_NO_THROW(
      loaded(folder, with_corners("[[0, 0, -1], [0, 0, 1], [0, 2, 1], [0.0001, 2, -1]]")));
}

TEST(CellSettings, RefuseEdgesThatTurnBackWhicheverWayRoundingTurnsThem) {
  const TemporaryFolder folder;
  for (int i = 0; i < 24; ++i) {
    const glm::dvec3 along(0.0, std::sin(0.3 * i), std::cos(0.3 * i));
    const glm::dvec3 aside(0.0, along.z, -along.y);  // to the left, seen from smaller x
    std::string corners;
    // There, too far, back, and on again.
    for (const auto& [u, v] : {std::pair(0, 0), {3, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}) {
      const glm::dvec3 p = along * (0.1 * u) + aside * (0.1 * v);
      corners += (corners.empty() ? "[0, " : ", [0, ") + std::to_string(p.y) + ", " +
                 std::to_string(p.z) + "]";
    }
    EXPECT_TRUE(
        says(input_error([&] { loaded(folder, with_corners("[" + corners + "]")); }), "convex"))
        << i;
  }
}

TEST(CellSettings, AreCheckedAsExactlyAsWalksNeed) {
  const TemporaryFolder folder;
  const Scene scene = loaded(folder, std::string(two_cells) + portal);
  const auto off = [&](double x) {
    Scene moved = scene;
    for (Portal& each : moved.portals) {
      for (glm::dvec3& corner : each.polygon) corner.x += x;
      each = make_portal(each.polygon, each.from, each.to);
    }
    return check_cells(moved).off.count;
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(off(sign * 5e-5), 0U);
    EXPECT_EQ(off(sign * 2e-4), 2U) << "either way";
    EXPECT_EQ(off(sign * 8e-4), 2U);
  }
}

TEST(CellSettings, RefuseWhatIsNoCellOrNoPortal) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    return input_error([&] { loaded(folder, text); });
  };
  const std::string head = "[mesh]\nfile = \"mesh.off\"\n";
  const std::string cells = two_cells;
  EXPECT_TRUE(says(refused(head + portal), "`portals` needs `cells`"));
  EXPECT_TRUE(says(refused(head + "[[cells]]\n"), "either `boxes` or"));
  EXPECT_TRUE(says(refused(head + "[[cells]]\nboxes = [[0, 0, 0]]\n"), "lower and an upper"));
  EXPECT_TRUE(says(refused(head + "[[cells]]\nboxes = [[0, 0, 0], [1, 0, 1]]\n"), "box 0"));
  EXPECT_TRUE(says(refused(head + "[[cells]]\nthrough = [[0, 0, 0]]\ninward = [[1, 0, 0]]\n"),
                   "no region"));
  EXPECT_TRUE(
      says(refused(head + "[[cells]]\nthrough = [[0, 0, 0]]\ninward = [[0, 0, 0]]\n"), "zero"));
  EXPECT_TRUE(says(refused(with_corners("[[0, 0, 0], [0, 1, 0]]")), "three different"));
  EXPECT_TRUE(
      says(refused(with_corners("[[0, 0, 0], [0, 0, 1], [0, 2, 1], [1, 2, 0]]")), "one plane"));
  EXPECT_TRUE(
      says(refused(with_corners("[[0, 0, -1], [0, 0.1, 0], [0, 0, 1], [0, 2, 0]]")), "convex"));
  EXPECT_TRUE(
      says(refused(cells + "[[portals]]\nfrom = 0\nto = 0\ncorners = [[0, 0, 0]]\n"), "different"));
  EXPECT_TRUE(
      says(refused(cells + "[[portals]]\nfrom = 0\nto = 2\ncorners = [[0, 0, 0]]\n"), "`to`"));
  EXPECT_TRUE(
      says(refused("[generator]\nkind = \"room_line\"\n[[cells]]\nboxes = []\n"), "`cells`"));
}

}  // namespace
}  // namespace vislab
