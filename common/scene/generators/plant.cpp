#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"
#include "common/scene/orientation.h"

namespace vislab {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;

/// Closes a tube by fans over its first and last ring of `segments` vertices.
void add_caps(Mesh& mesh, std::uint32_t segments) {
  const auto last = static_cast<std::uint32_t>(mesh.positions.size()) - segments;
  for (std::uint32_t i = 1; i + 1 < segments; ++i) {
    mesh.triangles.emplace_back(0, i, i + 1);
    mesh.triangles.emplace_back(last, last + i + 1, last + i);
  }
}

/// Rings run clockwise about the way from the first to the last.
void add_rings(Mesh& mesh, std::uint32_t segments) {
  const auto rings = static_cast<std::uint32_t>(mesh.positions.size()) / segments;
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    const std::uint32_t below = ring * segments;
    const std::uint32_t above = below + segments;
    for (std::uint32_t i = 0; i < segments; ++i) {
      const std::uint32_t next = (i + 1) % segments;
      mesh.triangles.emplace_back(below + i, above + i, above + next);
      mesh.triangles.emplace_back(below + i, above + next, below + next);
    }
  }
}

}  // namespace

Mesh pipe_mesh(std::uint32_t segments, std::uint32_t pieces) {
  Mesh mesh;
  mesh.name = "pipe";
  for (std::uint32_t ring = 0; ring <= pieces; ++ring) {
    const double y = 2.0 * ring / pieces - 1.0;
    for (std::uint32_t i = 0; i < segments; ++i) {
      const double angle = tau * i / segments;
      mesh.positions.emplace_back(std::cos(angle), y, std::sin(angle));
    }
  }
  add_rings(mesh, segments);
  add_caps(mesh, segments);
  return mesh;
}

Mesh coil_mesh(std::uint32_t segments, double turns, double pipe_radius_m) {
  Mesh mesh;
  mesh.name = "coil";
  const auto steps = static_cast<std::uint32_t>(std::lround(4.0 * segments * turns));
  const double rise = 2.0 / (tau * turns);  // for each radian
  for (std::uint32_t step = 0; step <= steps; ++step) {
    const double angle = tau * turns * step / steps;
    const glm::dvec3 outward(std::cos(angle), 0.0, std::sin(angle));
    const glm::dvec3 onward = glm::normalize(glm::dvec3(-std::sin(angle), rise, std::cos(angle)));
    const glm::dvec3 middle = outward + glm::dvec3(0.0, rise * angle - 1.0, 0.0);
    const glm::dvec3 aside = glm::cross(outward, onward);
    for (std::uint32_t i = 0; i < segments; ++i) {
      const double around = tau * i / segments;
      mesh.positions.emplace_back(
          middle + pipe_radius_m * (outward * std::cos(around) + aside * std::sin(around)));
    }
  }
  add_rings(mesh, segments);
  add_caps(mesh, segments);
  return mesh;
}

namespace {

constexpr double half_bay_m = 4.0;
constexpr double aisle_m = 3.0;
constexpr double wall_height_m = 6.0;
constexpr double half_wall_m = 0.1;
constexpr double header_height_m = 6.6;
enum PlantMesh : MeshId { cube, pipe, coil };

/// Fills one bay after the other. Every bay takes the same random numbers whatever the occlusion.
class Plant {
 public:
  Plant(const PlantParameters& parameters, Scene& scene) : parameters_(parameters), scene_(scene) {}

  void add_bay(const glm::dvec3& middle, Random random) {
    middle_ = middle;
    const glm::dvec3 half(random.uniform(1.2, 2.2), random.uniform(1.2, 2.2),
                          random.uniform(1.2, 2.2));
    const glm::dvec3 place(random.uniform(-0.3, 0.3), half.y, random.uniform(-0.3, 0.3));
    add_machine(place, half, random);
    add_around(random);
    if (random.uniform() < parameters_.occlusion) add_box(place, half);
    for (const double side : {-1.0, 1.0}) {
      const bool walled = random.uniform() < parameters_.occlusion;
      const bool door = random.uniform() < 0.2;
      const double door_x = random.uniform(-2.5, 2.5);
      if (walled) add_aisle_wall(side * (half_bay_m - half_wall_m), door, door_x);
    }
    if (random.uniform() < parameters_.occlusion) {
      const double half_z = half_bay_m - 2.0 * half_wall_m;
      add_box({half_bay_m - half_wall_m, 0.5 * wall_height_m, 0.0},
              {half_wall_m, 0.5 * wall_height_m, half_z});
    }
  }

 private:
  void add_box(const glm::dvec3& center, const glm::dvec3& half) {
    scene_.objects.push_back({cube, box_transform(middle_ + center, half), none_id});
  }

  /// A straight pipe along an axis.
  void add_pipe(const glm::dvec3& center, int axis, double half_length, double radius) {
    glm::dmat4x3 transform(0.0);
    transform[0][(axis + 2) % 3] = radius;
    transform[1][axis] = half_length;
    transform[2][(axis + 1) % 3] = radius;
    transform[3] = middle_ + center;
    scene_.objects.push_back({pipe, transform, none_id});
  }

  /// What is within the casing, of this half size and about `place`, or would be.
  void add_machine(const glm::dvec3& place, const glm::dvec3& half, Random& random) {
    constexpr double radius = 0.06;
    const glm::dvec3 frame = half - 0.1;
    for (const double x : {-1.0, 1.0}) {
      if (!parameters_.small_parts) break;
      for (const double z : {-1.0, 1.0}) {
        add_pipe(place + glm::dvec3(x * frame.x, 0.0, z * frame.z), 1, frame.y, radius);
      }
      add_pipe(place + glm::dvec3(x * frame.x, frame.y, 0.0), 2, frame.z, 0.9 * radius);
      add_pipe(place + glm::dvec3(0.0, frame.y, x * frame.z), 0, frame.x, 0.9 * radius);
    }
    const glm::dvec3 wound = half * glm::dvec3(0.6, 0.5, 0.6);
    scene_.objects.push_back(
        {coil, box_transform(middle_ + place + glm::dvec3(0.0, 0.2 * half.y, 0.0), wound),
         none_id});
    for (int i = 0; i < 6; ++i) {
      glm::dvec3 part;
      glm::dvec3 aside;
      for (int axis = 0; axis < 3; ++axis) part[axis] = random.uniform(0.05, 0.25);
      for (int axis = 0; axis < 3; ++axis) aside[axis] = random.uniform(-1.0, 1.0);
      if (parameters_.small_parts) add_box(place + aside * (half - part - 0.05), part);
    }
  }

  /// Pipes above, and barrels and crates in the corners.
  void add_around(Random& random) {
    for (const double z : {-1.0, 1.0}) {
      const double radius = random.uniform(0.08, 0.25);
      const double low = 4.6;
      const double x = random.uniform(-1.0, 1.0);
      add_pipe({0.0, header_height_m, z}, 0, half_bay_m, radius);
      add_pipe({x, 0.5 * (low + header_height_m), z}, 1, 0.5 * (header_height_m - low),
               0.7 * radius);
    }
    for (int i = 0; i < 6; ++i) {
      const glm::dvec3 corner((i & 1) != 0 ? 3.0 : -3.0, 0.0, (i & 2) != 0 ? 3.0 : -3.0);
      const glm::dvec3 at =
          corner + glm::dvec3(random.uniform(-0.4, 0.4), 0.0, random.uniform(-0.4, 0.4));
      const double size = random.uniform(0.15, 0.4);
      if (!parameters_.small_parts) continue;
      if (i % 3 == 0) {
        add_box(at + glm::dvec3(0.0, size, 0.0), glm::dvec3(size));
      } else {
        add_pipe(at + glm::dvec3(0.0, 1.5 * size, 0.0), 1, 1.5 * size, size);
      }
    }
  }

  /// A wall along x; a door of 1.2 m by 2.2 m leaves it in three pieces.
  void add_aisle_wall(double z, bool door, double door_x) {
    constexpr double half_door_m = 0.6;
    constexpr double door_height_m = 2.2;
    const double half_height = 0.5 * wall_height_m;
    if (!door) {
      add_box({0.0, half_height, z}, {half_bay_m, half_height, half_wall_m});
      return;
    }
    const double left = 0.5 * (door_x - half_door_m + half_bay_m);
    const double right = 0.5 * (half_bay_m - door_x - half_door_m);
    add_box({left - half_bay_m, half_height, z}, {left, half_height, half_wall_m});
    add_box({half_bay_m - right, half_height, z}, {right, half_height, half_wall_m});
    add_box({door_x, 0.5 * (wall_height_m + door_height_m), z},
            {half_door_m, 0.5 * (wall_height_m - door_height_m), half_wall_m});
  }

  const PlantParameters& parameters_;
  Scene& scene_;
  glm::dvec3 middle_{0.0};
};

}  // namespace

Scene make_plant(const PlantParameters& parameters) {
  constexpr double coil_turns = 3.0;
  constexpr double coil_pipe = 0.15;
  Scene scene;
  // The least numbers with which all meshes have as many triangles as they should.
  const std::uint32_t pipe_pieces =
      std::max(1U, (parameters.min_triangles + 3) / (2 * parameters.segments));
  auto coil_segments = static_cast<std::uint32_t>(
      std::ceil(std::sqrt(parameters.min_triangles / (8.0 * coil_turns))));
  coil_segments = std::max(coil_segments, parameters.segments);
  scene.meshes = {dense_cube_mesh(parameters.min_triangles),
                  pipe_mesh(parameters.segments, pipe_pieces),
                  coil_mesh(coil_segments, coil_turns, coil_pipe)};
  Plant plant(parameters, scene);
  Random random(parameters.seed);
  for (std::uint32_t j = 0; j < parameters.bays_z; ++j) {
    const double z = (j + 0.5 - 0.5 * parameters.bays_z) * (2.0 * half_bay_m + aisle_m);
    for (std::uint32_t i = 0; i < parameters.bays_x; ++i) {
      const double x = (i + 0.5 - 0.5 * parameters.bays_x) * 2.0 * half_bay_m;
      plant.add_bay({x, 0.0, z}, Random(random.bits()));
    }
  }
  return scene;
}

}  // namespace vislab
