#include "common/scene/generators/swarm.h"

#include <cmath>
#include <numbers>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/scene/orientation.h"

namespace vislab {

Scene make_swarm(const SwarmParameters& parameters) {
  const double radius = std::sqrt(parameters.area_m2 / (std::numbers::pi * parameters.count));
  const double half_edge = radius / std::sqrt(3.0);
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects.reserve(parameters.count);
  Random random(parameters.seed);
  const double reach = 0.5 * parameters.width_m;
  for (std::uint32_t i = 0; i < parameters.count; ++i) {
    const double x = random.uniform(-reach, reach);
    const double y = random.uniform(-reach, reach);
    const double z = random.uniform(-0.5, 0.5) * parameters.depth_m;
    const glm::dmat3 turn = random_rotation(random);
    scene.objects.push_back(
        {0,
         {half_edge * turn[0], half_edge * turn[1], half_edge * turn[2], glm::dvec3(x, y, z)},
         none_id});
  }
  return scene;
}

}  // namespace vislab
