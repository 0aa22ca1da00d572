#include "common/scene/description.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "common/scene/error.h"
#include "common/scene/settings.h"

namespace vislab {
namespace {

constexpr double huge = 1e6;  // metres; keeps generated worlds within float's good range

FileSource read_file_source(const Settings& table) {
  return {table.text("package", ""), table.text("file")};
}

MeshSource read_mesh(const Settings& table) {
  MeshSource mesh;
  mesh.source = read_file_source(table);
  mesh.simplify_triangles =
      static_cast<std::uint32_t>(table.whole("simplify_triangles", 0, 100'000'000, 0));
  table.done();
  return mesh;
}

QuakeSource read_quake(const Settings& table) {
  const QuakeSource quake{read_file_source(table)};
  table.done();
  return quake;
}

std::uint32_t count_of(const Settings& table, const std::string& key, std::int64_t low,
                       std::int64_t high) {
  return static_cast<std::uint32_t>(table.whole(key, low, high));
}

std::uint64_t seed_of(const Settings& table) {
  return static_cast<std::uint64_t>(
      table.whole("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
}

HaresSource read_hares(const Settings& table) {
  HaresSource hares;
  hares.parameters.count = count_of(table, "count", 1, 100'000);
  hares.parameters.size_m = table.number("size_m", 1e-3, huge, hares.parameters.size_m);
  hares.parameters.spacing_m = table.number("spacing_m", 1e-3, huge, hares.parameters.spacing_m);
  hares.mesh = read_mesh(table.table("mesh"));
  return hares;
}

AsteroidBeltParameters read_asteroid_belt(const Settings& table) {
  AsteroidBeltParameters belt;
  belt.count = count_of(table, "count", 1, 1'000'000);
  belt.detail = static_cast<std::uint32_t>(table.whole("detail", 4, 512, belt.detail));
  if (!std::has_single_bit(belt.detail)) {
    throw InputError(table.where() +
                     ": `detail` is wrong; it must be a power of two from 4 to 512");
  }
  belt.shapes = static_cast<std::uint32_t>(table.whole("shapes", 1, 10'000, belt.shapes));
  belt.radius_m = table.number("radius_m", 1e-3, huge, belt.radius_m);
  belt.width_m =
      table.number("width_m", 0.0, 1.99 * belt.radius_m, std::min(belt.width_m, belt.radius_m));
  belt.thickness_m = table.number("thickness_m", 0.0, huge, belt.thickness_m);
  belt.height_m = table.number("height_m", -huge, huge, belt.height_m);
  belt.min_size_m = table.number("min_size_m", 1e-3, huge, belt.min_size_m);
  belt.max_size_m =
      table.number("max_size_m", belt.min_size_m, huge, std::max(belt.min_size_m, belt.max_size_m));
  belt.relief = table.number("relief", 0.0, 0.9, belt.relief);
  belt.beacon_height_m = table.number("beacon_height_m", 0.0, huge, belt.beacon_height_m);
  belt.seed = seed_of(table);
  return belt;
}

BoxFieldParameters read_box_field(const Settings& table) {
  BoxFieldParameters field;
  field.count = count_of(table, "count", 1, 10'000'000);
  field.extent_m = table.number("extent_m", 1e-3, huge, field.extent_m);
  field.min_half_size_m = table.number("min_half_size_m", 1e-6, huge, field.min_half_size_m);
  field.max_half_size_m =
      table.number("max_half_size_m", field.min_half_size_m, huge, field.max_half_size_m);
  field.clear_radius_m =
      table.number("clear_radius_m", 0.0, 0.5 * field.extent_m, field.clear_radius_m);
  field.seed = seed_of(table);
  return field;
}

CityParameters read_city(const Settings& table) {
  CityParameters city;
  city.blocks_x = count_of(table, "blocks_x", 1, 2000);
  city.blocks_z = count_of(table, "blocks_z", 1, 2000);
  city.roof_share = table.number("roof_share", 0.0, 1.0, city.roof_share);
  city.street_boxes =
      static_cast<std::uint32_t>(table.whole("street_boxes", 0, 10'000'000, city.street_boxes));
  city.seed = seed_of(table);
  return city;
}

RoomRingParameters read_room_ring(const Settings& table) {
  RoomRingParameters ring;
  ring.rooms = count_of(table, "rooms", 4, 10'000);
  ring.boxes_per_room =
      static_cast<std::uint32_t>(table.whole("boxes_per_room", 0, 100, ring.boxes_per_room));
  ring.seed = seed_of(table);
  return ring;
}

void read_generator(const Settings& table, SceneDescription& scene) {
  const std::string kind = table.text("kind");
  if (kind == "asteroid_belt") {
    scene.source = read_asteroid_belt(table);
  } else if (kind == "hares") {
    scene.source = read_hares(table);
  } else if (kind == "box_field") {
    scene.source = read_box_field(table);
  } else if (kind == "city") {
    scene.source = read_city(table);
  } else if (kind == "room_ring") {
    scene.source = read_room_ring(table);
  } else {
    throw InputError(table.where() + ": " +
                     unknown_name("generator", kind,
                                  {"asteroid_belt", "box_field", "city", "hares", "room_ring"})
                         .what());
  }
  table.done();
}

}  // namespace

SceneDescription read_scene_description(const std::filesystem::path& file) {
  const Settings settings = Settings::from_file(file);
  SceneDescription scene;
  scene.name = file.stem().string();
  scene.folder = file.parent_path();
  scene.description = settings.text("description", "");
  scene.default_path = settings.text("default_path", "");
  const bool mesh = settings.has("mesh");
  const bool quake = settings.has("quake3");
  const bool generator = settings.has("generator");
  settings.done();
  if (int{mesh} + int{quake} + int{generator} != 1) {
    throw InputError(settings.where() +
                     ": a scene needs exactly one of the tables mesh, quake3 and generator");
  }
  if (mesh) scene.source = read_mesh(settings.table("mesh"));
  if (quake) scene.source = read_quake(settings.table("quake3"));
  if (generator) read_generator(settings.table("generator"), scene);
  return scene;
}

}  // namespace vislab
