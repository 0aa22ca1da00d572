#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "algorithms/surface/polygon_bsp.h"
#include "common/scene/generators/surfaces.h"

namespace vislab::surface {
namespace {

using Tree2 = PolygonBsp<2>;
using Tree3 = PolygonBsp<3>;

std::vector<Tree2::Face> edges_of(const std::vector<glm::dvec2>& corners) {
  std::vector<Tree2::Face> edges;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    edges.push_back({corners[i], corners[(i + 1) % corners.size()]});
  }
  return edges;
}

/// As a textbook draws it: a rectangle R, to its right a triangle D, and above them, before and
/// behind R's right side, a hexagon S whose edges 1 and 4 are horizontal. All are
/// counter-clockwise.
std::vector<Tree2::Face> rectangle() {
  // Its right side is the first.
  return edges_of({{4, 0}, {4, 2}, {0, 2}, {0, 0}});
}
std::vector<Tree2::Face> triangle() { return edges_of({{10, 0}, {14, 0}, {12, 2}}); }
std::vector<Tree2::Face> hexagon() {
  return edges_of({{3, 4.5}, {5, 4.5}, {6, 6}, {5, 7.5}, {3, 7.5}, {2, 6}});
}

std::vector<Tree2::Face> joined(std::vector<Tree2::Face> a, const std::vector<Tree2::Face>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Tree2::Limits as_inserted() { return {Tree2::Splitter::first, 1e-12, 1000, 1000}; }

/// The cells that a tree's planes make, numbered as its faces were inserted: all of the plane is
/// C0, and face k divides its cell into C(2k-1), in front, and C(2k). By the number of the face:
/// the cell that it divides. For trees in which no face is cut.
std::vector<std::size_t> divided_cells(const Tree2& tree) {
  std::vector<std::size_t> cell(tree.nodes().size());
  std::vector<std::size_t> by_face(tree.nodes().size());
  for (std::size_t n = 0; n < tree.nodes().size(); ++n) {
    const Tree2::Node& node = tree.nodes()[n];
    const std::size_t k = tree.pieces_of(node)[0].face + 1;
    by_face[k - 1] = cell[n];
    if (node.front != Tree2::none) cell[node.front] = 2 * k - 1;
    if (node.back != Tree2::none) cell[node.back] = 2 * k;
  }
  return by_face;
}

TEST(PolygonBsp, InsertsTheTextbooksRectangleAndTriangleWithoutACut) {
  Tree2 tree;
  ASSERT_TRUE(tree.build(joined(rectangle(), triangle()), as_inserted()));
  EXPECT_EQ(tree.splits(), 0U);
  EXPECT_EQ(tree.nodes().size(), 7U);
  // R: each side lies behind the one before. D stands before R's first side, in C1. Its third side
  // divides C12, which its second has made, into C13 and C14.
  EXPECT_EQ(divided_cells(tree), (std::vector<std::size_t>{0, 2, 4, 6, 1, 10, 12}));
}

TEST(PolygonBsp, CutsEdgesOneAndFourOfTheTextbooksHexagonAndNothingElse) {
  Tree2 tree;
  ASSERT_TRUE(tree.build(joined(joined(rectangle(), triangle()), hexagon()), as_inserted()));
  std::map<std::uint32_t, int> fragments;
  for (const Tree2::Node& node : tree.nodes()) {
    for (const Tree2::Piece& piece : tree.pieces_of(node)) ++fragments[piece.face];
  }
  constexpr std::uint32_t first_of_hexagon = 7;
  for (const auto& [face, count] : fragments) {
    const bool cut = face == first_of_hexagon || face == first_of_hexagon + 3;
    EXPECT_EQ(count, cut ? 2 : 1) << "face " << face;
  }
  EXPECT_EQ(fragments.size(), 13U);
  EXPECT_EQ(tree.splits(), 2U);
  // The cut is by R's first side, the root.
  for (const Tree2::Cut& cut : tree.cuts()) EXPECT_EQ(cut.node, 0U);
}

/// Faces in the order of a traversal.
template <typename Tree, typename Point>
std::vector<std::uint32_t> order_from(const Tree& tree, const Point& eye, bool back_to_front) {
  std::vector<std::uint32_t> faces;
  typename Tree::Stack stack;
  tree.visit(
      back_to_front, [&](const typename Tree::Plane& plane) { return plane.distance(eye); },
      [&](const typename Tree::Node& node) {
        for (const auto& piece : tree.pieces_of(node)) faces.push_back(piece.face);
        return true;
      },
      stack);
  return faces;
}

TEST(PolygonBsp, EmitsEveryFragmentAndTheNodesOwnFacesFromBackToFront) {
  Tree2 tree;
  ASSERT_TRUE(tree.build(joined(rectangle(), triangle()), as_inserted()));
  // From the left, R's left side (2) is in front and D's right side (5) at the back.
  const std::vector<std::uint32_t> order = order_from(tree, glm::dvec2(-10.0, 1.0), true);
  ASSERT_EQ(order.size(), 7U);
  const auto place = [&](std::uint32_t face) { return std::ranges::find(order, face); };
  EXPECT_LT(place(5), place(6));
  EXPECT_LT(place(6), place(0));
  EXPECT_LT(place(0), place(2));
  std::vector<std::uint32_t> reversed = order_from(tree, glm::dvec2(-10.0, 1.0), false);
  std::ranges::reverse(reversed);
  EXPECT_EQ(order, reversed);
}

/// The triangles of a scene in the world.
std::vector<Tree3::Face> faces_of(Scene scene) {
  scene.finish();
  std::vector<Tree3::Face> faces;
  for (ObjectId object = 0; object < scene.object_count(); ++object) {
    for (std::uint32_t i = 0; i < scene.triangle_count(object); ++i) {
      faces.push_back(world_triangle(scene.mesh_of(object), scene.objects[object].transform, i));
    }
  }
  return faces;
}

Tree3::Limits generous(Tree3::Splitter splitter) {
  return {splitter, 1e-13, 10'000'000, 10'000'000'000};
}

TEST(PolygonBsp, CutsGrowFasterThanTheNumberOfRandomPolygons) {
  // n log n would be an exponent of about 1.2 here, n^2 one of 2.
  std::array<double, 2> pieces{};
  const std::array<std::uint32_t, 2> counts{30, 300};
  for (std::size_t i = 0; i < 2; ++i) {
    TiltedPolygonsParameters parameters;
    parameters.count = counts[i];
    Tree3 tree;
    ASSERT_TRUE(
        tree.build(faces_of(make_tilted_polygons(parameters)), generous(Tree3::Splitter::sampled)));
    pieces[i] = static_cast<double>(tree.pieces());
  }
  const double exponent = std::log10(pieces[1] / pieces[0]);
  std::cout << pieces[0] << " and " << pieces[1] << " fragments: exponent " << exponent << '\n';
  EXPECT_GT(exponent, 1.1);
  EXPECT_LT(exponent, 2.0);
}

TEST(PolygonBsp, LeavesOutFacesWithoutAreaAndTakesNoneAtAll) {
  Tree3 tree;
  ASSERT_TRUE(tree.build({}, generous(Tree3::Splitter::sampled)));
  EXPECT_TRUE(tree.nodes().empty());
  EXPECT_TRUE(order_from(tree, glm::dvec3(0.0), true).empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Tree3::Face> faces = {
      {glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec3(1.0)},          // a line
      {glm::dvec3(nan), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0)},  // nowhere
      {glm::dvec3(0.0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)}};
  ASSERT_TRUE(tree.build(faces, generous(Tree3::Splitter::first)));
  EXPECT_EQ(order_from(tree, glm::dvec3(0, 0, 1), true), std::vector<std::uint32_t>{2});
}

TEST(PolygonBsp, KeepsCoplanarFacesAtOneNode) {
  std::vector<Tree3::Face> faces;
  for (int i = 0; i < 5; ++i) {
    const glm::dvec3 at(0.3 * i, 0.1 * i, 0.0);
    faces.push_back({at, at + glm::dvec3(1, 0, 0), at + glm::dvec3(0, 1, 0)});
  }
  Tree3 tree;
  ASSERT_TRUE(tree.build(faces, generous(Tree3::Splitter::first)));
  ASSERT_EQ(tree.nodes().size(), 1U);
  EXPECT_EQ(tree.pieces(), 5U);
}

TEST(PolygonBsp, GivesUpAtItsLimits) {
  TiltedPolygonsParameters parameters;
  const std::vector<Tree3::Face> faces = faces_of(make_tilted_polygons(parameters));
  Tree3 tree;
  Tree3::Limits few_pieces = generous(Tree3::Splitter::sampled);
  few_pieces.max_pieces = faces.size() + 10;
  EXPECT_FALSE(tree.build(faces, few_pieces));
  EXPECT_TRUE(tree.nodes().empty());
  Tree3::Limits few_tests = generous(Tree3::Splitter::sampled);
  few_tests.max_tests = 100;
  EXPECT_FALSE(tree.build(faces, few_tests));
}

}  // namespace
}  // namespace vislab::surface
