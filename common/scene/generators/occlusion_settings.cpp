#include "common/scene/generators/occlusion_settings.h"

#include <array>
#include <limits>
#include <utility>

#include "common/scene/error.h"
#include "common/scene/generators/occlusion.h"
#include "common/scene/generators/surfaces.h"
#include "common/scene/generators/swarm.h"

namespace vislab {
namespace {

constexpr double longest_m = 1e5;
constexpr std::int64_t most_triangles = 1'000'000;  // of one mesh

std::uint32_t whole(const Settings& table, const std::string& key, std::int64_t low,
                    std::int64_t high, std::uint32_t fallback) {
  return static_cast<std::uint32_t>(table.whole(key, low, high, fallback));
}

double length(const Settings& table, const std::string& key, double low, double fallback) {
  return table.number(key, low, longest_m, fallback);
}

std::uint64_t seed_of(const Settings& table) {
  return static_cast<std::uint64_t>(
      table.whole("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
}

SceneMaker slit_wall(const Settings& table) {
  SlitWallParameters wall;
  wall.slits = whole(table, "slits", 1, 1000, wall.slits);
  wall.width_m = length(table, "width_m", 0.1, wall.width_m);
  wall.gap_m = table.number("gap_m", 0.0, 0.9 * wall.width_m / (wall.slits + 1.0), wall.gap_m);
  wall.ratio = table.number("ratio", 0.01, 1.0, wall.ratio);
  wall.height_m = length(table, "height_m", 0.1, wall.height_m);
  wall.thickness_m = length(table, "thickness_m", 1e-3, wall.thickness_m);
  wall.target_distance_m = length(table, "target_distance_m", 0.0, wall.target_distance_m);
  wall.columns = whole(table, "columns", 0, 1000, wall.columns);
  wall.rows = whole(table, "rows", 0, 1000, wall.rows);
  return [wall] { return make_slit_wall(wall); };
}

SceneMaker lattice_wall(const Settings& table) {
  LatticeWallParameters wall;
  wall.coverage = table.number("coverage", 0.01, 1.0, wall.coverage);
  wall.cells_x = whole(table, "cells_x", 1, 1000, wall.cells_x);
  wall.cells_y = whole(table, "cells_y", 1, 1000, wall.cells_y);
  wall.width_m = length(table, "width_m", 0.1, wall.width_m);
  wall.height_m = length(table, "height_m", 0.1, wall.height_m);
  wall.target_distance_m = length(table, "target_distance_m", 0.0, wall.target_distance_m);
  wall.columns = whole(table, "columns", 0, 1000, wall.columns);
  wall.rows = whole(table, "rows", 0, 1000, wall.rows);
  return [wall] { return make_lattice_wall(wall); };
}

DrawOrder order_of(const Settings& table) {
  const std::string order = table.text("order", "near_first");
  if (order == "near_first") return DrawOrder::near_first;
  if (order == "far_first") return DrawOrder::far_first;
  if (order == "shuffled") return DrawOrder::shuffled;
  throw InputError(table.where() + ": " +
                   unknown_name("order", order, {"far_first", "near_first", "shuffled"}).what());
}

SceneMaker layered_tiles(const Settings& table) {
  LayeredTilesParameters tiles;
  tiles.layers = whole(table, "layers", 1, 100, tiles.layers);
  tiles.order = order_of(table);
  tiles.slats = whole(table, "slats", 1, 10'000, tiles.slats);
  tiles.overlap = table.number("overlap", 0.0, 1.0, tiles.overlap);
  tiles.columns = whole(table, "columns", 0, 1000, tiles.columns);
  tiles.rows = whole(table, "rows", 0, 1000, tiles.rows);
  tiles.seed = seed_of(table);
  return [tiles] { return make_layered_tiles(tiles); };
}

SceneMaker moving_wall(const Settings& table) {
  MovingWallParameters wall;
  wall.width_m = length(table, "width_m", 0.1, wall.width_m);
  wall.height_m = length(table, "height_m", 0.1, wall.height_m);
  wall.thickness_m = length(table, "thickness_m", 1e-3, wall.thickness_m);
  wall.targets = whole(table, "targets", 0, 10'000'000, wall.targets);
  wall.seed = seed_of(table);
  return [wall] { return make_moving_wall(wall); };
}

SceneMaker open_field(const Settings& table) {
  OpenFieldParameters field;
  field.count = whole(table, "count", 1, 10'000'000, field.count);
  field.half_size_m = length(table, "half_size_m", 1e-3, field.half_size_m);
  field.spacing_m = length(table, "spacing_m", 8.0 * field.half_size_m, 10.0 * field.half_size_m);
  field.min_triangles = whole(table, "min_triangles", 12, most_triangles, field.min_triangles);
  field.seed = seed_of(table);
  return [field] { return make_open_field(field); };
}

SceneMaker screened_ring(const Settings& table) {
  ScreenedRingParameters ring;
  ring.hidden = table.number("hidden", 0.0, 1.0, ring.hidden);
  ring.sectors = whole(table, "sectors", 8, 1000, ring.sectors);
  ring.objects = whole(table, "objects", 1, 100'000, ring.objects);
  ring.min_triangles = whole(table, "min_triangles", 12, most_triangles, ring.min_triangles);
  ring.all_triangles =
      whole(table, "all_triangles", 0, most_triangles * ring.sectors, ring.all_triangles);
  ring.seed = seed_of(table);
  return [ring] { return make_screened_ring(ring); };
}

SceneMaker covered_bars(const Settings& table) {
  CoveredBarsParameters bars;
  bars.angle_deg = table.number("angle_deg", 0.0, 90.0, bars.angle_deg);
  bars.columns = whole(table, "columns", 1, 1000, bars.columns);
  bars.rows = whole(table, "rows", 1, 1000, bars.rows);
  bars.min_triangles = whole(table, "min_triangles", 12, most_triangles, bars.min_triangles);
  return [bars] { return make_covered_bars(bars); };
}

SceneMaker plant(const Settings& table) {
  PlantParameters plant;
  plant.occlusion = table.number("occlusion", 0.0, 1.0, plant.occlusion);
  plant.bays_x = whole(table, "bays_x", 1, 1000, plant.bays_x);
  plant.bays_z = whole(table, "bays_z", 1, 1000, plant.bays_z);
  plant.segments = whole(table, "segments", 3, 200, plant.segments);
  plant.min_triangles = whole(table, "min_triangles", 12, most_triangles, plant.min_triangles);
  plant.small_parts = table.flag("small_parts", plant.small_parts);
  plant.seed = seed_of(table);
  return [plant] { return make_plant(plant); };
}

SceneMaker crossing_quads(const Settings& table) {
  CrossingQuadsParameters quads;
  quads.penetration = table.number("penetration", 0.0, 1.0, quads.penetration);
  quads.pairs = whole(table, "pairs", 1, 10'000, quads.pairs);
  return [quads] { return make_crossing_quads(quads); };
}

SceneMaker cyclic_bars(const Settings& table) {
  CyclicBarsParameters bars;
  bars.tilt_deg = table.number("tilt_deg", 0.0, 45.0, bars.tilt_deg);
  bars.layer_m = table.number("layer_m", 0.0, 1.0, bars.layer_m);
  return [bars] { return make_cyclic_bars(bars); };
}

SceneMaker tilted_polygons(const Settings& table) {
  TiltedPolygonsParameters polygons;
  polygons.count = whole(table, "count", 1, 1'000'000, polygons.count);
  polygons.corners = whole(table, "corners", 3, 100, polygons.corners);
  polygons.size_m = length(table, "size_m", 1e-3, polygons.size_m);
  polygons.extent_m = length(table, "extent_m", 0.0, polygons.extent_m);
  polygons.seed = seed_of(table);
  return [polygons] { return make_tilted_polygons(polygons); };
}

SceneMaker coplanar_pair(const Settings& table) {
  CoplanarPairParameters pair;
  pair.tilt_rad = table.number("tilt_rad", 0.0, 1.5, pair.tilt_rad);
  pair.pairs = whole(table, "pairs", 1, 10'000, pair.pairs);
  pair.seed = seed_of(table);
  return [pair] { return make_coplanar_pair(pair); };
}

SceneMaker scanline_fence(const Settings& table) {
  ScanlineFenceParameters fence;
  fence.polygons = whole(table, "polygons", 1, 100'000, fence.polygons);
  fence.overlap = table.number("overlap", 0.01, 1000.0, fence.overlap);
  fence.width_m = length(table, "width_m", 1e-3, fence.width_m);
  fence.height_m = length(table, "height_m", 1e-3, fence.height_m);
  fence.depth_m = length(table, "depth_m", 0.0, fence.depth_m);
  fence.seed = seed_of(table);
  return [fence] { return make_scanline_fence(fence); };
}

SceneMaker touching_spans(const Settings& table) {
  TouchingSpansParameters spans;
  spans.depth_difference_m = table.number("depth_difference_m", 0.0, 1.0, spans.depth_difference_m);
  spans.pairs = whole(table, "pairs", 1, 10'000, spans.pairs);
  return [spans] { return make_touching_spans(spans); };
}

SceneMaker swarm(const Settings& table) {
  SwarmParameters things;
  things.count = whole(table, "count", 1, 10'000'000, things.count);
  things.area_m2 = length(table, "area_m2", 1e-9, things.area_m2);
  things.width_m = length(table, "width_m", 0.0, things.width_m);
  things.depth_m = length(table, "depth_m", 0.0, things.depth_m);
  things.seed = seed_of(table);
  return [things] { return make_swarm(things); };
}

using Reader = SceneMaker (*)(const Settings&);

constexpr std::array<std::pair<const char*, Reader>, 15> readers{{
    {"coplanar_pair", coplanar_pair},
    {"covered_bars", covered_bars},
    {"crossing_quads", crossing_quads},
    {"cyclic_bars", cyclic_bars},
    {"lattice_wall", lattice_wall},
    {"layered_tiles", layered_tiles},
    {"moving_wall", moving_wall},
    {"open_field", open_field},
    {"plant", plant},
    {"scanline_fence", scanline_fence},
    {"screened_ring", screened_ring},
    {"slit_wall", slit_wall},
    {"swarm", swarm},
    {"tilted_polygons", tilted_polygons},
    {"touching_spans", touching_spans},
}};

}  // namespace

std::vector<std::string> occlusion_scene_kinds() {
  std::vector<std::string> kinds;
  for (const auto& [kind, reader] : readers) kinds.emplace_back(kind);
  return kinds;
}

std::optional<SceneMaker> read_occlusion_scene(const std::string& kind, const Settings& table) {
  for (const auto& [known, reader] : readers) {
    if (kind == known) return reader(table);
  }
  return std::nullopt;
}

}  // namespace vislab
