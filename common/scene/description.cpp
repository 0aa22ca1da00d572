#include "common/scene/description.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "common/scene/error.h"
#include "common/scene/generators/occlusion_settings.h"
#include "common/scene/generators/rooms_settings.h"
#include "common/scene/settings.h"

namespace vislab {
namespace {

constexpr double huge = 1e6;  // metres; keeps generated worlds within float's good range

FileSource read_file_source(const Settings& table) {
  return {table.text("package", ""), table.text("file")};
}

/// Keys of a mesh, which may stand beside others in the same table.
MeshSource read_mesh_keys(const Settings& table) {
  MeshSource mesh;
  mesh.source = read_file_source(table);
  mesh.simplify_triangles =
      static_cast<std::uint32_t>(table.whole("simplify_triangles", 0, 100'000'000, 0));
  return mesh;
}

/// Is z up, not y?
bool read_z_up(const Settings& table) {
  const std::string up = table.text("up", "y");
  if (up != "y" && up != "z") {
    throw InputError(table.where() + ": `up` is wrong; it must be \"y\" or \"z\"");
  }
  return up == "z";
}

ModelSource read_model(const Settings& table) {
  const ModelSource model{read_mesh_keys(table), read_z_up(table)};
  table.done();
  return model;
}

ModelSource read_joined_model(const Settings& table) {
  ModelSource model{read_mesh_keys(table), read_z_up(table)};
  if (table.has("largest_m")) model.largest_m = table.number("largest_m", 1e-3, huge);
  table.done();
  return model;
}

QuakeCellLimits read_quake_cells(const Settings& table) {
  QuakeCellLimits limits;
  const std::string cells = table.text("cells", "leaves");
  if (cells == "none") {
    limits.cells = QuakeCellLimits::Cells::none;
  } else if (cells == "rooms") {
    limits.cells = QuakeCellLimits::Cells::rooms;
    limits.smallest_m3 = table.number("smallest_m3", 0.0, 1e9, limits.smallest_m3);
  } else if (cells != "leaves") {
    throw InputError(table.where() + ": " +
                     unknown_name("kind of cells", cells, {"leaves", "none", "rooms"}).what());
  }
  return limits;
}

QuakeSource read_quake(const Settings& table) {
  const QuakeSource quake{read_file_source(table), read_quake_cells(table)};
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

RibbedSphereSource read_ribbed_sphere(const Settings& table) {
  RibbedSphereSource sphere;
  sphere.meridians =
      static_cast<std::uint32_t>(table.whole("meridians", 3, 10'000, sphere.meridians));
  sphere.parallels =
      static_cast<std::uint32_t>(table.whole("parallels", 1, 10'000, sphere.parallels));
  sphere.ribs = static_cast<std::uint32_t>(table.whole("ribs", 0, 1000, sphere.ribs));
  return sphere;
}

BumpySphereParameters read_bumpy_sphere(const Settings& table) {
  BumpySphereParameters sphere;
  sphere.subdivisions =
      static_cast<std::uint32_t>(table.whole("subdivisions", 1, 1000, sphere.subdivisions));
  const std::string bumps = table.text("bumps", "none");
  if (bumps == "low") {
    sphere.bumps = Bumps::low;
  } else if (bumps == "high") {
    sphere.bumps = Bumps::high;
  } else if (bumps != "none") {
    throw InputError(table.where() + ": " +
                     unknown_name("kind of bumps", bumps, {"none", "low", "high"}).what());
  }
  sphere.hole = table.number("hole", 0.0, 0.9, sphere.hole);
  sphere.mesh_offset = table.point("mesh_offset", sphere.mesh_offset);
  if (glm::length(sphere.mesh_offset) > 1e6) {
    throw InputError(table.where() + ": `mesh_offset` is wrong; it must be at most 1e6 m long");
  }
  return sphere;
}

/// Keys of a mesh, a file's or a made one's, which may stand beside others in the same table.
ShapeSource read_shape_keys(const Settings& table) {
  if (!table.has("shape")) return read_mesh_keys(table);
  const std::string shape = table.text("shape");
  if (shape == "bumpy_sphere") return read_bumpy_sphere(table);
  if (shape == "ribbed_sphere") return read_ribbed_sphere(table);
  throw InputError(table.where() + ": " +
                   unknown_name("shape", shape, {"bumpy_sphere", "ribbed_sphere"}).what());
}

ShapeSource read_shape(const Settings& table) {
  ShapeSource shape = read_shape_keys(table);
  table.done();
  return shape;
}

HaresSource read_hares(const Settings& table) {
  HaresSource hares;
  hares.parameters.count = count_of(table, "count", 1, 100'000);
  hares.parameters.size_m = table.number("size_m", 1e-3, huge, hares.parameters.size_m);
  hares.parameters.spacing_m = table.number("spacing_m", 1e-3, huge, hares.parameters.spacing_m);
  hares.mesh = read_shape(table.table("mesh"));
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

/// The keys of fields of boxes and of meshes. `edge_m` gives all boxes one edge length.
BoxFieldParameters read_field(const Settings& table) {
  BoxFieldParameters field;
  field.count = count_of(table, "count", 1, 10'000'000);
  field.extent_m = table.number("extent_m", 1e-3, huge, field.extent_m);
  if (table.has("edge_m")) {
    field.min_half_size_m = 0.5 * table.number("edge_m", 2e-6, huge);
    field.max_half_size_m = field.min_half_size_m;
  } else {
    field.min_half_size_m = table.number("min_half_size_m", 1e-6, huge, field.min_half_size_m);
    field.max_half_size_m = table.number("max_half_size_m", field.min_half_size_m, huge,
                                         std::max(field.min_half_size_m, field.max_half_size_m));
  }
  field.clear_radius_m = table.number("clear_radius_m", 0.0, 0.5 * field.extent_m,
                                      std::min(field.clear_radius_m, 0.5 * field.extent_m));
  field.rotated = table.flag("rotated", false);
  field.mirrored = table.number("mirrored", 0.0, 1.0, field.mirrored);
  field.shear = table.number("shear", 0.0, 1000.0, field.shear);
  field.seed = seed_of(table);
  return field;
}

/// Boxes that reach around the origin from everywhere could never be placed clear of it.
void require_room(const Settings& table, const BoxFieldParameters& field, glm::dvec3 shape) {
  shape.x += field.shear * shape.y;
  const double reach_m = field.max_half_size_m * glm::length(shape) + field.clear_radius_m;
  if (field.clear_radius_m > 0.0 && reach_m > field.extent_m) {
    throw InputError(table.where() + ": half a box's diagonal and `clear_radius_m` are " +
                     std::to_string(reach_m) + " m together; `extent_m` must be at least that");
  }
}

BoxFieldParameters read_box_field(const Settings& table) {
  BoxFieldParameters field = read_field(table);
  field.elongation = table.number("elongation", 1.0, 1000.0, field.elongation);
  field.thickness = table.number("thickness", 0.0, 1.0, field.thickness);
  field.subdivisions =
      static_cast<std::uint32_t>(table.whole("subdivisions", 1, 200, field.subdivisions));
  field.density_ratio = table.number("density_ratio", 1.0, 1e6, field.density_ratio);
  require_room(table, field, {field.elongation, field.thickness, 1.0 / field.elongation});
  return field;
}

MeshFieldSource read_mesh_field(const Settings& table) {
  MeshFieldSource field;
  field.parameters = read_field(table);
  field.mesh = read_shape(table.table("mesh"));
  require_room(table, field.parameters, glm::dvec3(1.0));
  return field;
}

GrazingSlabsParameters read_grazing_slabs(const Settings& table) {
  GrazingSlabsParameters slabs;
  slabs.count = static_cast<std::uint32_t>(table.whole("count", 1, 1'000'000, slabs.count));
  slabs.tilt_rad = table.number("tilt_rad", 0.0, 1.5, slabs.tilt_rad);
  slabs.distance_m = table.number("distance_m", 1e-3, huge, slabs.distance_m);
  slabs.half_width_m = table.number("half_width_m", 1e-3, huge, slabs.half_width_m);
  slabs.thickness_m = table.number("thickness_m", 1e-6, huge, slabs.thickness_m);
  slabs.subdivisions =
      static_cast<std::uint32_t>(table.whole("subdivisions", 1, 200, slabs.subdivisions));
  slabs.seed = seed_of(table);
  return slabs;
}

HousesParameters read_houses(const Settings& table) {
  HousesParameters houses;
  houses.count = static_cast<std::uint32_t>(table.whole("count", 1, 10'000, houses.count));
  houses.min_triangles = count_of(table, "min_triangles", 1, 100'000);
  houses.max_triangles = count_of(table, "max_triangles",
                                  std::max<std::int64_t>(houses.min_triangles + 1, 8), 100'000);
  houses.min_triangles = std::max(houses.min_triangles, 8U);  // no closed house has fewer
  houses.seed = seed_of(table);
  return houses;
}

PlacedMesh read_placed(const Settings& table) {
  PlacedMesh placed;
  placed.mesh = read_shape_keys(table);
  placed.z_up = read_z_up(table);
  placed.at = table.point("at");
  placed.size_m = table.number("size_m", 1e-6, huge);
  placed.shear = table.point("shear", placed.shear);
  placed.scale = table.point("scale", placed.scale);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(placed.scale[axis]) >= 1e-6 && std::abs(placed.scale[axis]) <= huge)) {
      throw InputError(table.where() + ": `scale` is wrong; its factors must be from 1e-6 to 1e6 " +
                       "or from -1e6 to -1e-6");
    }
    if (std::abs(placed.shear[axis]) > 1000.0) {
      throw InputError(table.where() +
                       ": `shear` is wrong; its factors must be from -1000 to 1000");
    }
  }
  placed.heading_rad = table.number("heading_deg", -360.0, 360.0, 0.0) * std::numbers::pi / 180.0;
  table.done();
  return placed;
}

CityParameters read_city(const Settings& table) {
  CityParameters city;
  city.blocks_x = count_of(table, "blocks_x", 1, 2000);
  city.blocks_z = count_of(table, "blocks_z", 1, 2000);
  city.roof_share = table.number("roof_share", 0.0, 1.0, city.roof_share);
  city.street_boxes =
      static_cast<std::uint32_t>(table.whole("street_boxes", 0, 10'000'000, city.street_boxes));
  city.indoor_boxes =
      static_cast<std::uint32_t>(table.whole("indoor_boxes", 0, 10'000'000, city.indoor_boxes));
  city.bridges =
      static_cast<std::uint32_t>(table.whole("bridges", 0, (city.blocks_z + 1) / 2, city.bridges));
  city.bridge_clearance = table.number("bridge_clearance", 0.0, 10.0, city.bridge_clearance);
  city.min_triangles =
      static_cast<std::uint32_t>(table.whole("min_triangles", 12, 1'000'000, city.min_triangles));
  city.seed = seed_of(table);
  return city;
}

RoomRingParameters read_room_ring(const Settings& table) {
  RoomRingParameters ring;
  ring.rooms = count_of(table, "rooms", 3, 10'000);
  ring.boxes_per_room =
      static_cast<std::uint32_t>(table.whole("boxes_per_room", 0, 100, ring.boxes_per_room));
  ring.seed = seed_of(table);
  return ring;
}

void read_generator(const Settings& table, SceneDescription& scene) {
  const std::string kind = table.text("kind");
  if (kind == "asteroid_belt") {
    scene.source = read_asteroid_belt(table);
  } else if (kind == "box_field") {
    scene.source = read_box_field(table);
  } else if (kind == "bumpy_sphere") {
    scene.source = read_bumpy_sphere(table);
  } else if (kind == "city") {
    scene.source = read_city(table);
  } else if (kind == "grazing_slabs") {
    scene.source = read_grazing_slabs(table);
  } else if (kind == "hares") {
    scene.source = read_hares(table);
  } else if (kind == "houses") {
    scene.source = read_houses(table);
  } else if (kind == "mesh_field") {
    scene.source = read_mesh_field(table);
  } else if (kind == "room_ring") {
    scene.source = read_room_ring(table);
  } else if (std::optional<SceneMaker> maker = read_occlusion_scene(kind, table)) {
    scene.source = std::move(*maker);
  } else if (std::optional<SceneMaker> rooms = read_rooms_scene(kind, table)) {
    scene.source = std::move(*rooms);
  } else {
    std::vector<std::string> known = occlusion_scene_kinds();
    const std::vector<std::string> rooms_kinds = rooms_scene_kinds();
    known.insert(known.end(), rooms_kinds.begin(), rooms_kinds.end());
    known.insert(known.end(), {"asteroid_belt", "box_field", "bumpy_sphere", "city",
                               "grazing_slabs", "hares", "houses", "mesh_field", "room_ring"});
    std::sort(known.begin(), known.end());
    throw InputError(table.where() + ": " + unknown_name("generator", kind, known).what());
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
  scene.offset = settings.point("offset", glm::dvec3(0.0));
  const bool mesh = settings.has("mesh");
  const bool meshes = settings.has("meshes");
  const bool quake = settings.has("quake3");
  const bool objects = settings.has("objects");
  const bool generator = settings.has("generator");
  if (mesh || meshes || objects) scene.cells = read_cells(settings);
  settings.done();
  if (int{mesh} + int{meshes} + int{quake} + int{objects} + int{generator} != 1) {
    throw InputError(settings.where() +
                     ": a scene needs exactly one of the tables mesh, meshes, quake3, objects " +
                     "and generator");
  }
  if (mesh) scene.source = read_model(settings.table("mesh"));
  if (meshes) {
    std::vector<ModelSource> models;
    for (const Settings& table : settings.tables("meshes")) {
      models.push_back(read_joined_model(table));
    }
    scene.source = std::move(models);
  }
  if (quake) scene.source = read_quake(settings.table("quake3"));
  if (objects) {
    std::vector<PlacedMesh> placed;
    for (const Settings& table : settings.tables("objects")) placed.push_back(read_placed(table));
    scene.source = std::move(placed);
  }
  if (generator) read_generator(settings.table("generator"), scene);
  return scene;
}

}  // namespace vislab
