#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/geometry/random.h"
#include "common/scene/convex_region.h"
#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

constexpr double half_depth_m = 5.0;
constexpr double half_door_m = 1.0;
constexpr double door_height_m = 2.5;
constexpr double room_height_m = 5.0;
constexpr double half_wall_m = 0.1;

/// Points of the ring by partition, side of the partition, radius and height. Rooms share them
/// exactly: walls, floors and doors are cut along the same lines, so that neither rays nor pixels
/// find a gap.
class Ring {
 public:
  explicit Ring(std::uint32_t rooms)
      : rooms_(rooms),
        radius_(std::max(10.0, rooms * 2.0 * half_depth_m / (2.0 * std::numbers::pi))) {}

  std::uint32_t rooms() const { return rooms_; }
  double half_angle() const { return std::numbers::pi / rooms_; }
  double radius() const { return radius_; }
  std::array<double, 4> radii() const {
    return {radius_ - half_depth_m, radius_ - half_door_m, radius_ + half_door_m,
            radius_ + half_depth_m};
  }
  /// Angles run counter-clockwise seen from above. Partition k is between rooms k - 1 (side -1) and
  /// k (side +1); side 0 is within the wall.
  glm::vec3 point(std::uint32_t partition, int side, double radius, double height) const {
    const double angle = 2.0 * half_angle() * (partition % rooms_);
    const double onward = side * half_wall_m;
    return {radius * std::cos(angle) - onward * std::sin(angle), height,
            -radius * std::sin(angle) - onward * std::cos(angle)};
  }

 private:
  std::uint32_t rooms_;
  double radius_;
};

using Quad = std::array<glm::vec3, 4>;

Quad turned_round(const Quad& quad) { return {quad[3], quad[2], quad[1], quad[0]}; }

/// Collects quads into a mesh whose vertices are shared.
class QuadMesh {
 public:
  void add(const Quad& quad) {
    std::array<std::uint32_t, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) v[i] = vertex(quad[i]);
    mesh.triangles.emplace_back(v[0], v[1], v[2]);
    mesh.triangles.emplace_back(v[0], v[2], v[3]);
  }
  Mesh mesh;

 private:
  std::uint32_t vertex(const glm::vec3& p) {
    const auto found = std::find(mesh.positions.begin(), mesh.positions.end(), p);
    if (found == mesh.positions.end()) {
      mesh.positions.push_back(p);
      return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
    return static_cast<std::uint32_t>(found - mesh.positions.begin());
  }
};

/// A piece of one side of partition k, counter-clockwise seen from room k - 1.
Quad partition_quad(const Ring& ring, std::uint32_t k, int side, double r0, double r1, double y0,
                    double y1) {
  return {ring.point(k, side, r0, y0), ring.point(k, side, r1, y0), ring.point(k, side, r1, y1),
          ring.point(k, side, r0, y1)};
}

/// A piece of floor between two radii, from one side of a partition to another, seen from above.
Quad floor_quad(const Ring& ring, std::uint32_t k0, int side0, std::uint32_t k1, int side1,
                double r0, double r1, double y) {
  return {ring.point(k0, side0, r0, y), ring.point(k0, side0, r1, y), ring.point(k1, side1, r1, y),
          ring.point(k1, side1, r0, y)};
}

/// An upright piece at a radius, seen from farther out.
Quad upright_quad(const Ring& ring, std::uint32_t k0, int side0, std::uint32_t k1, int side1,
                  double r, double y0, double y1) {
  return {ring.point(k0, side0, r, y0), ring.point(k1, side1, r, y0), ring.point(k1, side1, r, y1),
          ring.point(k0, side0, r, y1)};
}

/// The room's walls, floor and ceiling, and the passage through the wall to the next room.
Mesh room_mesh(const Ring& ring, std::uint32_t k) {
  const std::array<double, 4> radii = ring.radii();
  const std::array<double, 3> heights{0.0, door_height_m, room_height_m};
  QuadMesh room;
  room.mesh.name = std::string("room ").append(std::to_string(k));
  for (std::size_t i = 0; i < 3; ++i) {
    const double r0 = radii[i];
    const double r1 = radii[i + 1];
    for (std::size_t j = 0; j < 2; ++j) {
      if (i == 1 && j == 0) continue;  // the door
      room.add(turned_round(partition_quad(ring, k, 1, r0, r1, heights[j], heights[j + 1])));
      room.add(partition_quad(ring, k + 1, -1, r0, r1, heights[j], heights[j + 1]));
    }
    room.add(floor_quad(ring, k, 1, k + 1, -1, r0, r1, 0.0));
    room.add(turned_round(floor_quad(ring, k, 1, k + 1, -1, r0, r1, room_height_m)));
  }
  for (std::size_t j = 0; j < 2; ++j) {
    const double y0 = heights[j];
    const double y1 = heights[j + 1];
    room.add(upright_quad(ring, k, 1, k + 1, -1, radii[0], y0, y1));
    room.add(turned_round(upright_quad(ring, k, 1, k + 1, -1, radii[3], y0, y1)));
  }
  const std::uint32_t next = k + 1;
  room.add(floor_quad(ring, next, -1, next, 1, radii[1], radii[2], 0.0));
  room.add(turned_round(floor_quad(ring, next, -1, next, 1, radii[1], radii[2], door_height_m)));
  room.add(upright_quad(ring, next, -1, next, 1, radii[1], 0.0, door_height_m));
  room.add(turned_round(upright_quad(ring, next, -1, next, 1, radii[2], 0.0, door_height_m)));
  return room.mesh;
}

ConvexPolygon polygon_of(const Quad& quad) { return {quad.begin(), quad.end()}; }

/// The opening between rooms k and k + 1, counter-clockwise seen from k.
Quad door_quad(const Ring& ring, std::uint32_t k) {
  const std::array<double, 4> radii = ring.radii();
  return partition_quad(ring, k + 1, 0, radii[1], radii[2], 0.0, door_height_m);
}

/// The room itself, and its halves of the two passages.
Cell room_cell(const Ring& ring, std::uint32_t k) {
  const std::array<double, 4> radii = ring.radii();
  const Quad floor = floor_quad(ring, k, 1, k + 1, -1, radii[0], radii[3], 0.0);
  const Quad before = door_quad(ring, k + ring.rooms() - 1);
  Cell cell;
  cell.regions = {prism_region(polygon_of(floor), room_height_m),
                  prism_region(polygon_of(before), -half_wall_m),
                  prism_region(polygon_of(door_quad(ring, k)), half_wall_m)};
  for (const ConvexRegion& region : cell.regions) cell.bounds.extend(region.bounds);
  return cell;
}

/// A box on the floor, on either side of the straight way from door to door.
glm::dmat4x3 furniture(const Ring& ring, std::uint32_t k, Random& random) {
  const double middle = (2.0 * k + 1.0) * ring.half_angle();
  const glm::dvec3 outward(std::cos(middle), 0.0, -std::sin(middle));
  const glm::dvec3 along(-std::sin(middle), 0.0, -std::cos(middle));
  const double flatness = std::cos(ring.half_angle());
  const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
  const double aside = side * random.uniform(2.2, 3.5) * flatness;
  const double reach = 0.5 * (ring.radius() - half_depth_m) * std::sin(ring.half_angle());
  const double onward = random.uniform(-reach, reach);
  glm::dvec3 half(random.uniform(0.2, 0.6), random.uniform(0.2, 1.2), random.uniform(0.2, 0.6));
  glm::dvec3 center = outward * (ring.radius() * flatness + aside) + along * onward;
  center.y = half.y;
  return box_transform(center, half);
}

}  // namespace

Scene make_room_ring(const RoomRingParameters& parameters) {
  const Ring ring(parameters.rooms);
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  Random random(parameters.seed);
  for (std::uint32_t k = 0; k < parameters.rooms; ++k) {
    Mesh mesh = room_mesh(ring, k);
    scene.cells.push_back(room_cell(ring, k));
    scene.objects.push_back({static_cast<MeshId>(scene.meshes.size()), glm::dmat4x3(1.0), k});
    scene.meshes.push_back(std::move(mesh));
    for (std::uint32_t i = 0; i < parameters.boxes_per_room; ++i) {
      scene.objects.push_back({0, furniture(ring, k, random), k});
    }
  }
  for (std::uint32_t k = 0; k < parameters.rooms; ++k) {
    const std::uint32_t next = (k + 1) % parameters.rooms;
    const Quad door = door_quad(ring, k);
    scene.portals.push_back(make_portal(polygon_of(door), k, next));
    scene.portals.push_back(make_portal(polygon_of(turned_round(door)), next, k));
  }
  return scene;
}

}  // namespace vislab
