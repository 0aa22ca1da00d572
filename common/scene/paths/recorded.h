// Recorded camera paths: JSON files with one pose for each frame.
#pragma once

#include <filesystem>
#include <vector>

#include "common/geometry/camera.h"

namespace vislab {

/// {"frames": [{"eye": [x, y, z], "target": [x, y, z], "up": [x, y, z]}, …]}; up may be left out.
/// At least one pose. Throws InputError, also for unknown keys.
std::vector<Pose> read_recorded_poses(const std::filesystem::path& file);

}  // namespace vislab
