#include <algorithm>
#include <cmath>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

constexpr double pitch_m = 25.0;
constexpr double kept_free_m = 1.0;  // on both sides of the middle of a street

/// A house in the cube from -1 to 1: walls up to the middle, and a gable roof whose ridge runs
/// along x. Closed, 16 triangles.
Mesh gable_mesh() {
  Mesh mesh;
  mesh.name = "house with a gable roof";
  for (const float y : {-1.0F, 0.0F}) {
    for (const float z : {-1.0F, 1.0F}) {
      for (const float x : {-1.0F, 1.0F}) mesh.positions.emplace_back(x, y, z);
    }
  }
  mesh.positions.emplace_back(-1.0F, 1.0F, 0.0F);
  mesh.positions.emplace_back(1.0F, 1.0F, 0.0F);
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 7}, {2, 7, 6}, {1, 0, 4}, {1, 4, 5},
                    {0, 2, 6}, {0, 6, 4}, {3, 1, 5}, {3, 5, 7}, {4, 6, 8}, {7, 5, 9},
                    {6, 7, 9}, {6, 9, 8}, {5, 4, 8}, {5, 8, 9}};
  return mesh;
}

/// True if the interval center ± half keeps clear of the middle of every street along one axis.
bool clear_of_streets(double center, double half, std::uint32_t blocks) {
  const double from_edge = center / pitch_m + 0.5 * blocks;  // streets at whole numbers
  return std::abs(from_edge - std::round(from_edge)) * pitch_m >= kept_free_m + half;
}

void add_building(Scene& scene, double x, double z, double roof_share, Random& random) {
  const glm::dvec2 half(random.uniform(6.0, 10.0), random.uniform(6.0, 10.0));
  const bool tower = random.uniform() < 0.1;
  const double height = tower ? random.uniform(40.0, 80.0) : random.uniform(8.0, 30.0);
  const MeshId mesh = random.uniform() < roof_share ? 1 : 0;
  scene.objects.push_back(
      {mesh, box_transform({x, 0.5 * height, z}, {half.x, 0.5 * height, half.y}), none_id});
}

void add_street_box(Scene& scene, MeshId mesh, const CityParameters& city, Random& random) {
  while (true) {
    glm::dvec3 half;
    for (int axis = 0; axis < 3; ++axis) half[axis] = random.uniform(0.3, 2.0);
    const bool hovers = random.uniform() < 0.1;
    const double height = hovers ? random.uniform(5.0, 60.0) : half.y;
    // A position along one street, and one across it that stays before the nearest walls' reach.
    const bool along_z = random.uniform() < 0.5;
    const std::uint32_t streets = along_z ? city.blocks_x : city.blocks_z;
    const std::uint32_t across_blocks = along_z ? city.blocks_z : city.blocks_x;
    const auto street = static_cast<double>(random.below(streets + 1));
    const double middle = (street - 0.5 * streets) * pitch_m;
    const double aside = random.uniform(-6.5, 6.5);
    const double along = random.uniform(-0.5, 0.5) * across_blocks * pitch_m;
    const double x = along_z ? middle + aside : along;
    const double z = along_z ? along : middle + aside;
    if (!clear_of_streets(x, half.x, city.blocks_x)) continue;
    if (!clear_of_streets(z, half.z, city.blocks_z)) continue;
    scene.objects.push_back({mesh, box_transform({x, height, z}, half), none_id});
    return;
  }
}

/// Where it does not come through the walls of one of the buildings, which are the first objects.
void add_indoor_box(Scene& scene, MeshId mesh, std::uint32_t buildings, Random& random) {
  constexpr double wall_m = 0.1;
  glm::dvec3 half;
  for (int axis = 0; axis < 3; ++axis) half[axis] = random.uniform(0.3, 2.0);
  const glm::dmat4x3& building = scene.objects[random.below(buildings)].transform;
  const glm::dvec3 room(building[0].x, 0.5 * building[1].y, building[2].z);
  // Below half the height, where a house with a gable roof is still a box.
  glm::dvec3 center = building[3] - glm::dvec3(0.0, room.y, 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = room[axis] - half[axis] - wall_m;
    half[axis] = std::min(half[axis], room[axis] - 2.0 * wall_m);
    center[axis] += random.uniform(-1.0, 1.0) * std::max(reach, 0.0);
  }
  scene.objects.push_back({mesh, box_transform(center, half), none_id});
}

void add_bridge(Scene& scene, MeshId mesh, const CityParameters& city, std::uint32_t number) {
  constexpr double building_height_m = 20.0;
  constexpr glm::dvec3 half_deck(0.0, 0.75, 2.4);
  const double first = std::floor(0.5 * city.blocks_z) - (city.bridges - 1.0);
  const double street = first + 2.0 * number - 0.5 * city.blocks_z;
  const glm::dvec3 center(0.0, city.bridge_clearance * building_height_m + half_deck.y,
                          street * pitch_m);
  const glm::dvec3 half(0.5 * city.blocks_x * pitch_m, half_deck.y, half_deck.z);
  scene.objects.push_back({mesh, box_transform(center, half), none_id});
}

}  // namespace

Scene make_city(const CityParameters& parameters) {
  Scene scene;
  const bool facades = parameters.min_triangles > 12;
  scene.meshes.push_back(facades ? facade_mesh(parameters.min_triangles) : cube_mesh());
  if (parameters.roof_share > 0.0) scene.meshes.push_back(gable_mesh());
  // Boxes and bridges stay light.
  MeshId box = 0;
  if (facades && parameters.street_boxes + parameters.indoor_boxes + parameters.bridges > 0) {
    box = static_cast<MeshId>(scene.meshes.size());
    scene.meshes.push_back(cube_mesh());
  }
  Random random(parameters.seed);
  for (std::uint32_t j = 0; j < parameters.blocks_z; ++j) {
    for (std::uint32_t i = 0; i < parameters.blocks_x; ++i) {
      add_building(scene, (i + 0.5 - 0.5 * parameters.blocks_x) * pitch_m,
                   (j + 0.5 - 0.5 * parameters.blocks_z) * pitch_m, parameters.roof_share, random);
    }
  }
  for (std::uint32_t i = 0; i < parameters.street_boxes; ++i) {
    add_street_box(scene, box, parameters, random);
  }
  const std::uint32_t buildings = parameters.blocks_x * parameters.blocks_z;
  for (std::uint32_t i = 0; i < parameters.indoor_boxes; ++i) {
    add_indoor_box(scene, box, buildings, random);
  }
  for (std::uint32_t i = 0; i < parameters.bridges; ++i) add_bridge(scene, box, parameters, i);
  return scene;
}

}  // namespace vislab
