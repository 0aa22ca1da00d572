// The tables `generator` of scenes that are made for occlusion and for hidden surfaces.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/scene.h"
#include "common/scene/settings.h"

namespace vislab {

/// Makes a scene, which is not finished yet; may be called again.
using SceneMaker = std::function<Scene()>;

/// The kinds that read_occlusion_scene knows, sorted.
std::vector<std::string> occlusion_scene_kinds();

/// Reads the keys of one of these kinds: the members of its parameters (occlusion.h, surfaces.h).
/// Nothing for another kind. Throws InputError. `done()` is the caller's.
std::optional<SceneMaker> read_occlusion_scene(const std::string& kind, const Settings& table);

}  // namespace vislab
