// Rooms in a line, whose walls have convex holes, as scenes with cells and portals. Test-only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/scene/convex_region.h"
#include "common/scene/generators/generators.h"
#include "common/scene/scene.h"

namespace vislab {

struct RoomLine {
  std::uint32_t rooms = 4;
  std::uint32_t holes = 1;  // in each wall between two rooms, side by side
  double roll_deg = 0.0;    // of the holes, square, about the line of rooms
  double half_hole_m = 0.5;
  double overlap_m = 0.0;  // of the cells of neighbours

  static constexpr double length_m = 4.0;
  static constexpr double height_m = 3.0;
  static constexpr double half_width_m = 4.0;

  /// The middle of a room, at the height of the holes' middles.
  static glm::dvec3 middle(std::uint32_t room) { return {(room + 0.5) * length_m, 1.5, 0.0}; }
  /// The middle of a hole of the wall after `room`.
  glm::dvec3 hole_middle(std::uint32_t room, std::uint32_t hole) const {
    const double strip = 2.0 * half_width_m / holes;
    return {(room + 1) * length_m, 1.5, -half_width_m + (hole + 0.5) * strip};
  }
  /// Corners, counter-clockwise seen from the room before it.
  std::array<glm::dvec3, 4> hole(std::uint32_t room, std::uint32_t hole) const {
    std::array<glm::dvec3, 4> corners;
    const double half = std::min(half_hole_m, 0.6 * half_width_m / holes);
    for (int i = 0; i < 4; ++i) {
      const double angle = (45.0 + 90.0 * i + roll_deg) * std::numbers::pi / 180.0;
      corners[i] = hole_middle(room, hole) +
                   std::numbers::sqrt2 * half * glm::dvec3(0.0, std::sin(angle), std::cos(angle));
    }
    return corners;
  }
};

namespace rooms_of_tests {

using vislab::box_region;

inline void add_quad(Mesh& mesh, const std::array<glm::dvec3, 4>& quad) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const glm::dvec3& p : quad) mesh.positions.emplace_back(p);
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

inline Mesh wall(const RoomLine& line, std::uint32_t room) {
  Mesh mesh;
  mesh.name = "wall";
  const double x = (room + 1) * RoomLine::length_m;
  const double strip = 2.0 * RoomLine::half_width_m / line.holes;
  for (std::uint32_t i = 0; i < line.holes; ++i) {
    const double z = -RoomLine::half_width_m + i * strip;
    const std::array<glm::dvec3, 4> hole = line.hole(room, i);
    std::array<glm::dvec3, 4> around;
    for (std::size_t k = 0; k < 4; ++k) {
      // The strip's corner that lies in the direction of the hole's unrolled corner.
      const glm::dvec3 from =
          RoomLine{line.rooms, line.holes, 0.0, 0.1}.hole(room, i)[k] - line.hole_middle(room, i);
      around[k] = {x, from.y < 0.0 ? 0.0 : RoomLine::height_m, from.z < 0.0 ? z : z + strip};
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t next = (k + 1) % 4;
      add_quad(mesh, {around[next], hole[next], hole[k], around[k]});
    }
  }
  return mesh;
}

/// Floor, ceiling and side walls, and the ends of the line.
inline Mesh shell(const RoomLine& line, std::uint32_t room) {
  Mesh mesh;
  mesh.name = "shell";
  const double x0 = room * RoomLine::length_m;
  const double x1 = x0 + RoomLine::length_m;
  const double w = RoomLine::half_width_m;
  const double h = RoomLine::height_m;
  add_quad(mesh, {{{x0, 0, -w}, {x0, 0, w}, {x1, 0, w}, {x1, 0, -w}}});
  add_quad(mesh, {{{x0, h, -w}, {x1, h, -w}, {x1, h, w}, {x0, h, w}}});
  add_quad(mesh, {{{x0, 0, -w}, {x1, 0, -w}, {x1, h, -w}, {x0, h, -w}}});
  add_quad(mesh, {{{x0, 0, w}, {x0, h, w}, {x1, h, w}, {x1, 0, w}}});
  for (const double x : {x0, x1}) {
    if ((x == x0 && room > 0) || (x == x1 && room + 1 < line.rooms)) continue;
    add_quad(mesh, {{{x, 0, -w}, {x, h, -w}, {x, h, w}, {x, 0, w}}});
  }
  return mesh;
}

}  // namespace rooms_of_tests

/// A shell, a few boxes and the wall to the next one for each room.
inline Scene make_room_line(const RoomLine& line) {
  using namespace rooms_of_tests;
  Scene scene;
  scene.name = "rooms";
  scene.meshes.push_back(cube_mesh());
  const auto add = [&](MeshId mesh, const glm::dmat4x3& transform, std::vector<CellId> cells) {
    const auto object = static_cast<ObjectId>(scene.objects.size());
    scene.objects.push_back({mesh, transform, cells.front()});
    for (const CellId cell : cells) scene.cells[cell].objects.push_back(object);
  };
  const auto add_mesh = [&](Mesh mesh) {
    scene.meshes.push_back(std::move(mesh));
    return static_cast<MeshId>(scene.meshes.size() - 1);
  };
  scene.cells.resize(line.rooms);
  for (CellId room = 0; room < line.rooms; ++room) {
    const double before = room > 0 ? line.overlap_m : 0.0;
    const double after = room + 1 < line.rooms ? line.overlap_m : 0.0;
    Cell& cell = scene.cells[room];
    cell.regions = {box_region(
        {room * RoomLine::length_m - before, 0.0, -RoomLine::half_width_m},
        {(room + 1) * RoomLine::length_m + after, RoomLine::height_m, RoomLine::half_width_m})};
    cell.bounds = cell.regions.front().bounds;
  }
  for (CellId room = 0; room < line.rooms; ++room) {
    add(add_mesh(shell(line, room)), glm::dmat4x3(1.0), {room});
    const glm::dvec3 middle = RoomLine::middle(room);
    for (int i = 0; i < 4; ++i) {
      const glm::dvec3 aside(-1.2 + 0.8 * i, -1.3 + 0.7 * i, i % 2 == 0 ? 2.6 : -2.4);
      add(0, box_transform(middle + aside, {0.2, 0.2, 0.3}), {room});
    }
    if (room + 1 == line.rooms) continue;
    add(add_mesh(wall(line, room)), glm::dmat4x3(1.0), {room, room + 1});
    for (std::uint32_t i = 0; i < line.holes; ++i) {
      const std::array<glm::dvec3, 4> hole = line.hole(room, i);
      scene.portals.push_back(make_portal({hole.begin(), hole.end()}, room, room + 1));
      scene.portals.push_back(make_portal({hole.rbegin(), hole.rend()}, room + 1, room));
    }
  }
  scene.finish();
  return scene;
}

}  // namespace vislab
