// Idea: a board with several openings is cut into upright strips with one opening each. A strip is
//   a convex ring: walking round its outline, each corner is joined to the corner of the opening
//   where the tangent from it touches, and the opening's edges between two such corners are joined
//   to the next corner of the outline. All lines are tangents, so none crosses the opening.
// Guarantee: strips meet in whole edges, so that the mesh is closed.
#include "common/scene/generators/pierced_board.h"

#include <algorithm>

namespace vislab {
namespace {

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Collects triangles; vertices at equal positions are one.
class Board {
 public:
  explicit Board(double half_thickness) : half_(half_thickness) {}

  /// On both sides.
  void face(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    add(at(a, half_), at(b, half_), at(c, half_));
    add(at(c, -half_), at(b, -half_), at(a, -half_));
  }
  /// Between the sides, along an edge that has the board on its left.
  void rim(const glm::dvec2& a, const glm::dvec2& b) {
    add(at(a, half_), at(a, -half_), at(b, -half_));
    add(at(a, half_), at(b, -half_), at(b, half_));
  }
  Mesh mesh;

 private:
  std::uint32_t at(const glm::dvec2& p, double z) {
    const glm::vec3 position(p.x, p.y, z);
    const auto found = std::find(mesh.positions.begin(), mesh.positions.end(), position);
    if (found != mesh.positions.end()) {
      return static_cast<std::uint32_t>(found - mesh.positions.begin());
    }
    mesh.positions.push_back(position);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  }
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.emplace_back(a, b, c);
  }

  double half_;
};

double least_x(const BoardOpening& opening) {
  return std::ranges::min(opening, {}, &glm::dvec2::x).x;
}
double greatest_x(const BoardOpening& opening) {
  return std::ranges::max(opening, {}, &glm::dvec2::x).x;
}

}  // namespace

std::vector<std::array<std::size_t, 3>> triangles_between(const std::vector<glm::dvec2>& outline,
                                                          const BoardOpening& opening) {
  const std::size_t outer = outline.size();
  const std::size_t inner = opening.size();
  const auto sees = [&](const glm::dvec2& p, std::size_t edge) {
    return turn(opening[edge % inner], opening[(edge + 1) % inner], p) < 0.0;
  };
  // The edge before the tangent's corner is seen from the outline's first corner, the next is not.
  std::size_t touch = 0;
  while (!(sees(outline[0], touch + inner - 1) && !sees(outline[0], touch))) ++touch;
  std::vector<std::array<std::size_t, 3>> triangles;
  for (std::size_t i = 0; i < outer; ++i) {
    const std::size_t next = (i + 1) % outer;
    triangles.push_back({i, next, outer + touch % inner});
    while (sees(outline[next], touch)) {
      triangles.push_back({next, outer + (touch + 1) % inner, outer + touch % inner});
      ++touch;
    }
  }
  return triangles;
}

Mesh pierced_board_mesh(const glm::dvec2& min, const glm::dvec2& max, double half_thickness,
                        std::vector<BoardOpening> openings) {
  std::ranges::sort(openings, {}, least_x);
  Board board(half_thickness);
  const std::vector<glm::dvec2> edge{min, {max.x, min.y}, max, {min.x, max.y}};
  if (openings.empty()) {
    board.face(edge[0], edge[1], edge[2]);
    board.face(edge[0], edge[2], edge[3]);
    for (std::size_t i = 0; i < 4; ++i) board.rim(edge[i], edge[(i + 1) % 4]);
    return board.mesh;
  }
  double left = min.x;
  for (std::size_t n = 0; n < openings.size(); ++n) {
    const BoardOpening& opening = openings[n];
    const bool last = n + 1 == openings.size();
    const double right = last ? max.x : 0.5 * (greatest_x(opening) + least_x(openings[n + 1]));
    const std::vector<glm::dvec2> strip{
        {left, min.y}, {right, min.y}, {right, max.y}, {left, max.y}};
    const auto corner = [&](std::size_t i) { return i < 4 ? strip[i] : opening[i - 4]; };
    for (const auto& t : triangles_between(strip, opening)) {
      board.face(corner(t[0]), corner(t[1]), corner(t[2]));
    }
    for (std::size_t i = 0; i < opening.size(); ++i) {
      board.rim(opening[(i + 1) % opening.size()], opening[i]);
    }
    board.rim(strip[0], strip[1]);
    board.rim(strip[2], strip[3]);
    if (n == 0) board.rim(strip[3], strip[0]);
    if (last) board.rim(strip[1], strip[2]);
    left = right;
  }
  return board.mesh;
}

}  // namespace vislab
