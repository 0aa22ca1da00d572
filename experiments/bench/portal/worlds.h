// The worlds of the cases, loaded once.
#pragma once

#include <string>

#include "common/culler/registry.h"
#include "common/scene/path.h"
#include "common/scene/scene.h"

namespace vislab {

inline constexpr const char* portal_worlds[] = {"oa_dm2", "czest3ctf"};
inline constexpr Viewport portal_viewport{512, 512};

struct PortalWorld {
  Scene scene;
  Path walk;  // between places that players reach
};

/// Throws InputError if the world's package has not been fetched.
const PortalWorld& portal_world(const std::string& name);

/// Built for the scene of a world.
std::unique_ptr<ICuller> built_culler(const std::string& spec, const Scene& scene, int threads);

}  // namespace vislab
