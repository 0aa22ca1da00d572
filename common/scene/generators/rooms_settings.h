// The tables `generator` of buildings (rooms.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene/generators/occlusion_settings.h"
#include "common/scene/settings.h"

namespace vislab {

/// The kinds that read_rooms_scene knows, sorted.
std::vector<std::string> rooms_scene_kinds();

/// Reads the keys of one of these kinds. `house` and `room_grid` have the keys `columns` and
/// `rows`, `room_line` has `rooms`, and `house` has `storeys`; the others are named as the members
/// of RoomsParameters, but have other defaults in a house: doors 0.4, door_shift_m 0.8, variation
/// 0.2. Nothing for another kind. Throws InputError. `done()` is the caller's.
std::optional<SceneMaker> read_rooms_scene(const std::string& kind, const Settings& table);

}  // namespace vislab
