// Closed and outward: meshes that bound solids, if they do not intersect themselves.
//
// Idea: vertices at equal positions are one; every edge must be borne by exactly two triangles that
// run along it in opposite directions; the parts that hang together by edges must each enclose a
// positive volume (the sum of signed tetrahedra, divergence theorem).
// Guarantee: what passes is a closed oriented surface. Self-intersection is looked for elsewhere
//   (solid_mesh.h).
// Cost: O(n log n) for n triangles.
#include <algorithm>
#include <cstdint>
#include <numeric>

#include "common/scene/scene.h"
#include "common/scene/weld.h"

namespace vislab {
namespace {

struct Edge {
  std::uint32_t low, high;  // welded vertices
  bool forward;             // the triangle runs from low to high
  std::uint32_t triangle;

  bool same_line(const Edge& other) const { return low == other.low && high == other.high; }
};

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t node) {
  while (parent[node] != node) {
    parent[node] = parent[parent[node]];
    node = parent[node];
  }
  return node;
}

}  // namespace

bool is_closed_outward(const Mesh& mesh) {
  const std::vector<std::uint32_t> welded = weld_positions(mesh.positions);
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  std::vector<std::uint8_t> collapsed(mesh.triangles.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& triangle = mesh.triangles[t];
    const glm::uvec3 v(welded[triangle.x], welded[triangle.y], welded[triangle.z]);
    // A triangle with two corners in one place bounds nothing: its edges cancel.
    collapsed[t] = v.x == v.y || v.y == v.z || v.z == v.x ? 1 : 0;
    if (collapsed[t] != 0) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = v[corner];
      const std::uint32_t to = v[(corner + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to, t});
    }
  }
  if (edges.empty()) return false;
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.triangle < b.triangle;
  });

  std::vector<std::uint32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    if (i + 1 == edges.size() || !edges[i].same_line(edges[i + 1])) return false;
    if (i + 2 < edges.size() && edges[i].same_line(edges[i + 2])) return false;
    if (edges[i].forward == edges[i + 1].forward) return false;
    parent[root_of(parent, edges[i].triangle)] = root_of(parent, edges[i + 1].triangle);
  }

  // Volumes are summed about the box's centre, where they lose least to rounding.
  Aabb box;
  for (const Edge& edge : edges) box.extend(mesh.positions[edge.low]);
  const glm::dvec3 center = box.center();
  std::vector<double> volume(mesh.triangles.size(), 0.0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (collapsed[t] != 0) continue;
    const glm::uvec3& triangle = mesh.triangles[t];
    const glm::dvec3 a = glm::dvec3(mesh.positions[triangle.x]) - center;
    const glm::dvec3 b = glm::dvec3(mesh.positions[triangle.y]) - center;
    const glm::dvec3 c = glm::dvec3(mesh.positions[triangle.z]) - center;
    volume[root_of(parent, t)] += glm::dot(a, glm::cross(b, c));
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (collapsed[t] == 0 && root_of(parent, t) == t && !(volume[t] > 0.0)) return false;
  }
  return true;
}

}  // namespace vislab
