#include "common/scene/generators/rooms_settings.h"

#include <algorithm>
#include <limits>

#include "common/scene/error.h"
#include "common/scene/generators/rooms.h"

namespace vislab {
namespace {

std::uint32_t whole(const Settings& table, const std::string& key, std::int64_t low,
                    std::int64_t high, std::uint32_t fallback) {
  return static_cast<std::uint32_t>(table.whole(key, low, high, fallback));
}

Windows windows_of(const Settings& table) {
  const std::string windows = table.text("windows", "none");
  if (windows == "none") return Windows::none;
  if (windows == "nothing") return Windows::nothing;
  if (windows == "outside") return Windows::outside;
  throw InputError(table.where() + ": " +
                   unknown_name("kind of windows", windows, {"none", "nothing", "outside"}).what());
}

}  // namespace

std::vector<std::string> rooms_scene_kinds() { return {"house", "room_grid", "room_line"}; }

std::optional<SceneMaker> read_rooms_scene(const std::string& kind, const Settings& table) {
  if (!std::ranges::binary_search(rooms_scene_kinds(), kind)) return std::nullopt;
  RoomsParameters rooms;
  if (kind == "room_line") {
    rooms.rows = whole(table, "rooms", 1, 1000, rooms.rows);
  } else {
    rooms.columns = whole(table, "columns", 1, 100, kind == "house" ? 5 : 8);
    rooms.rows = whole(table, "rows", 1, 100, kind == "house" ? 4 : 8);
  }
  if (kind == "house") {
    rooms.storeys = whole(table, "storeys", 1, 50, 5);
    rooms.doors = 0.4;
    rooms.door_shift_m = 0.8;
    rooms.variation = 0.2;
  }
  rooms.width_m = table.number("width_m", 2.0, 100.0, rooms.width_m);
  rooms.depth_m = table.number("depth_m", 2.0, 100.0, rooms.depth_m);
  rooms.height_m = table.number("height_m", 2.0, 100.0, rooms.height_m);
  rooms.variation = table.number("variation", 0.0, 0.5, rooms.variation);
  rooms.wall_m = table.number("wall_m", 0.01, 1.0, rooms.wall_m);
  rooms.portals = whole(table, "portals", 0, 8, rooms.portals);
  rooms.door_width_m = table.number("door_width_m", 0.1, 100.0, rooms.door_width_m);
  rooms.door_height_m = table.number("door_height_m", 0.1, 100.0, rooms.door_height_m);
  rooms.door_roll_deg = table.number("door_roll_deg", 0.0, 45.0, rooms.door_roll_deg);
  rooms.door_shift_m = table.number("door_shift_m", 0.0, 100.0, rooms.door_shift_m);
  rooms.doors = table.number("doors", 0.0, 1.0, rooms.doors);
  rooms.open = table.number("open", 0.0, 1.0, rooms.open);
  rooms.crack_m = table.number("crack_m", 0.0, 10.0, rooms.crack_m);
  rooms.crack_portal = table.flag("crack_portal", rooms.crack_portal);
  rooms.overlap_m = table.number("overlap_m", 0.0, 1.0, rooms.overlap_m);
  rooms.windows = windows_of(table);
  rooms.boxes_per_room = whole(table, "boxes_per_room", 0, 20, rooms.boxes_per_room);
  rooms.box_triangles = whole(table, "box_triangles", 12, 1'000'000, rooms.box_triangles);
  rooms.small_things_per_room =
      whole(table, "small_things_per_room", 0, 100, rooms.small_things_per_room);
  rooms.seed = static_cast<std::uint64_t>(
      table.whole("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  return [rooms] { return make_rooms(rooms); };
}

}  // namespace vislab
