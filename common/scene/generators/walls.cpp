// Walls with slits and holes, layers of slats, and a wall for paths to move.
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"

namespace vislab {
namespace {

/// A lattice of cubes of 0.25 m half size in the plane z, from the ground up and centred at x = 0.
void add_targets(Scene& scene, std::uint32_t columns, std::uint32_t rows, double width_m,
                 double height_m, double z) {
  constexpr glm::dvec3 half(0.25);
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const glm::dvec3 center(((i + 0.5) / columns - 0.5) * width_m, (j + 0.5) / rows * height_m,
                              z);
      scene.objects.push_back({0, box_transform(center, half), none_id});
    }
  }
}

}  // namespace

Scene make_slit_wall(const SlitWallParameters& parameters) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  const double pitch = parameters.width_m / (parameters.slits + 1.0);
  double left = -0.5 * parameters.width_m;
  double gap = parameters.gap_m;
  for (std::uint32_t i = 0; i <= parameters.slits; ++i) {
    const bool last = i == parameters.slits;
    const double middle = -0.5 * parameters.width_m + (i + 1.0) * pitch;
    const double right = last ? 0.5 * parameters.width_m : middle - 0.5 * gap;
    const glm::dvec3 half(0.5 * (right - left), 0.5 * parameters.height_m,
                          0.5 * parameters.thickness_m);
    scene.objects.push_back({0, box_transform({0.5 * (left + right), half.y, 0.0}, half), none_id});
    left = middle + 0.5 * gap;
    gap *= parameters.ratio;
  }
  add_targets(scene, parameters.columns, parameters.rows, parameters.width_m, parameters.height_m,
              -parameters.target_distance_m);
  return scene;
}

namespace {

/// Cells with a hole in the middle of each share their corners, so that nothing is seen between
/// them; a cell without a hole is one quad.
Mesh lattice_mesh(const LatticeWallParameters& parameters) {
  const std::uint32_t columns = parameters.cells_x + 1;
  const double width = parameters.width_m / parameters.cells_x;
  const double height = parameters.height_m / parameters.cells_y;
  const double hole = std::sqrt(1.0 - parameters.coverage);
  Mesh mesh;
  mesh.name = "lattice";
  for (std::uint32_t j = 0; j <= parameters.cells_y; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      mesh.positions.emplace_back(i * width - 0.5 * parameters.width_m, j * height, 0.0);
    }
  }
  for (std::uint32_t j = 0; j < parameters.cells_y; ++j) {
    for (std::uint32_t i = 0; i < parameters.cells_x; ++i) {
      const std::uint32_t corner = j * columns + i;
      const std::uint32_t outer[] = {corner, corner + 1, corner + columns + 1, corner + columns};
      if (hole == 0.0) {
        mesh.triangles.emplace_back(outer[0], outer[1], outer[2]);
        mesh.triangles.emplace_back(outer[0], outer[2], outer[3]);
        continue;
      }
      const auto inner = static_cast<std::uint32_t>(mesh.positions.size());
      const glm::dvec3 middle((i + 0.5) * width - 0.5 * parameters.width_m, (j + 0.5) * height,
                              0.0);
      for (const glm::dvec2 side : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        mesh.positions.emplace_back(middle +
                                    0.5 * hole * glm::dvec3(side.x * width, side.y * height, 0.0));
      }
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t next = (k + 1) % 4;
        mesh.triangles.emplace_back(outer[k], outer[next], inner + next);
        mesh.triangles.emplace_back(outer[k], inner + next, inner + k);
      }
    }
  }
  return mesh;
}

}  // namespace

Scene make_lattice_wall(const LatticeWallParameters& parameters) {
  Scene scene;
  scene.meshes = {cube_mesh(), lattice_mesh(parameters)};
  scene.objects.push_back({1, glm::dmat4x3(1.0), none_id});
  add_targets(scene, parameters.columns, parameters.rows, parameters.width_m, parameters.height_m,
              -parameters.target_distance_m);
  return scene;
}

Scene make_layered_tiles(const LayeredTilesParameters& parameters) {
  constexpr double nearest_m = 10.0;
  constexpr double farthest_m = 30.0;
  constexpr double thickness_m = 0.05;
  constexpr double slope = 0.8;  // half of what the slats cover, across and up, at 1 m distance
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  const double layers = parameters.layers;
  const double unit = 2.0 * slope / (layers * parameters.slats);  // a slat at 1 m distance
  for (std::uint32_t layer = 0; layer < parameters.layers; ++layer) {
    const double share = layers > 1.0 ? layer / (layers - 1.0) : 0.0;
    const double distance = nearest_m + (farthest_m - nearest_m) * share;
    for (std::uint32_t i = 0; i < parameters.slats; ++i) {
      const double middle = (i * layers + layer + 0.5) * unit - slope;
      const glm::dvec3 half(0.5 * unit * (1.0 + 2.0 * parameters.overlap) * distance,
                            slope * distance, 0.5 * thickness_m);
      scene.objects.push_back(
          {0, box_transform({middle * distance, 0.0, -distance - half.z}, half), none_id});
    }
  }
  if (parameters.order == DrawOrder::far_first) {
    std::reverse(scene.objects.begin(), scene.objects.end());
  } else if (parameters.order == DrawOrder::shuffled) {
    Random random(parameters.seed);
    for (std::size_t i = scene.objects.size(); i > 1; --i) {
      std::swap(scene.objects[i - 1], scene.objects[random.below(i)]);
    }
  }
  // Within the slats' cover, whose half is 32 m there.
  const std::size_t first = scene.objects.size();
  add_targets(scene, parameters.columns, parameters.rows, 56.0, 56.0, -40.0);
  for (std::size_t i = first; i < scene.objects.size(); ++i)
    scene.objects[i].transform[3].y -= 28.0;
  return scene;
}

Scene make_moving_wall(const MovingWallParameters& parameters) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  scene.objects.push_back({0,
                           box_transform({0.0, 0.5 * parameters.height_m, 0.0},
                                         {0.5 * parameters.width_m, 0.5 * parameters.height_m,
                                          0.5 * parameters.thickness_m}),
                           none_id});
  Random random(parameters.seed);
  for (std::uint32_t i = 0; i < parameters.targets; ++i) {
    const glm::dvec3 half(random.uniform(0.25, 0.5));
    const double x = random.uniform(-30.0, 30.0);
    const double y = random.uniform(half.y, 10.0);
    const double z = random.uniform(-45.0, -5.0);
    scene.objects.push_back({0, box_transform({x, y, z}, half), none_id});
  }
  return scene;
}

Scene make_open_field(const OpenFieldParameters& parameters) {
  Scene scene;
  scene.meshes.push_back(dense_cube_mesh(parameters.min_triangles));
  const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(parameters.count)));
  const std::uint32_t rows = (parameters.count + columns - 1) / columns;
  Random random(parameters.seed);
  for (std::uint32_t i = 0; i < parameters.count; ++i) {
    glm::dvec3 half;
    for (int axis = 0; axis < 3; ++axis) {
      half[axis] = parameters.half_size_m * random.uniform(0.7, 1.0);
    }
    const double aside = parameters.half_size_m;
    const double x =
        (i % columns + 0.5 - 0.5 * columns) * parameters.spacing_m + random.uniform(-aside, aside);
    const double z =
        (i / columns + 0.5 - 0.5 * rows) * parameters.spacing_m + random.uniform(-aside, aside);
    scene.objects.push_back({0, box_transform({x, half.y, z}, half), none_id});
  }
  return scene;
}

}  // namespace vislab
