// Idea: a polygon mesh of the triangles that have an area; boxes of triangles that overlap are
// found
//   by sweeping, and the triangles in them are tested with exact predicates; so is the highest
//   vertex of each part for which way its triangles face (CGAL).
// Source: CGAL 5.5, Polygon Mesh Processing, does_self_intersect() and is_outward_oriented(), which
//   are under the GPL.
#include "common/scene/solid_mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/helpers.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "common/scene/weld.h"

namespace vislab {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;

using Surface = CGAL::Surface_mesh<Point>;

/// Makes `surface` of the triangles that have an area. False if they are not a closed surface in
/// which the triangles around each vertex are one ring.
bool make_surface(const Mesh& mesh, Surface& surface) {
  const std::vector<std::uint32_t> welded = weld_positions(mesh.positions);
  std::vector<Surface::Vertex_index> vertices(mesh.positions.size());  // by welded vertex
  std::vector<Surface::size_type> triangles_around;                    // by vertex of the surface
  const auto point = [&](std::uint32_t vertex) {
    const glm::vec3& p = mesh.positions[vertex];
    return Point(p.x, p.y, p.z);
  };
  for (const glm::uvec3& triangle : mesh.triangles) {
    if (CGAL::collinear(point(triangle.x), point(triangle.y), point(triangle.z))) continue;
    std::array<Surface::Vertex_index, 3> corners;
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t vertex = welded[triangle[i]];
      if (!vertices[vertex].is_valid()) {
        vertices[vertex] = surface.add_vertex(point(vertex));
        triangles_around.push_back(0);
      }
      corners[static_cast<std::size_t>(i)] = vertices[vertex];
      ++triangles_around[vertices[vertex]];
    }
    if (surface.add_face(corners) == Surface::null_face()) return false;
  }
  // Where two rings meet in a point only one of them is found by going around it.
  for (const Surface::Vertex_index vertex : surface.vertices()) {
    if (surface.degree(vertex) != triangles_around[vertex]) return false;
  }
  return surface.number_of_faces() > 0 && CGAL::is_closed(surface);
}

/// Does every part of a closed surface that hangs together face outward, by itself?
bool parts_face_outward(Surface& surface) {
  using Part = Surface::faces_size_type;
  const auto part_of = surface.add_property_map<Surface::Face_index, Part>("f:part", 0).first;
  const Part count = processing::connected_components(surface, part_of);
  if (count == 1) return processing::is_outward_oriented(surface);
  std::vector<Surface> parts(count);
  std::vector<Surface::Vertex_index> vertices(surface.number_of_vertices());  // in their parts
  for (const Surface::Face_index face : surface.faces()) {
    Surface& part = parts[part_of[face]];
    std::vector<Surface::Vertex_index> corners;
    for (const Surface::Vertex_index vertex :
         surface.vertices_around_face(surface.halfedge(face))) {
      if (!vertices[vertex].is_valid()) vertices[vertex] = part.add_vertex(surface.point(vertex));
      corners.push_back(vertices[vertex]);
    }
    part.add_face(corners);
  }
  return std::ranges::all_of(
      parts, [](const Surface& part) { return processing::is_outward_oriented(part); });
}

}  // namespace

bool is_solid(const Mesh& mesh) {
  Surface surface;
  return make_surface(mesh, surface) && !processing::does_self_intersect(surface) &&
         parts_face_outward(surface);
}

}  // namespace vislab
