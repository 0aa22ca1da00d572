#include <algorithm>
#include <utility>

#include "common/scene/generators/generators.h"

namespace vislab {

Scene make_hares(Mesh hare, const HaresParameters& parameters) {
  const Aabb box = bounds_of(hare.positions);
  const glm::dvec3 half = box.half_size();
  const double scale = 0.5 * parameters.size_m / std::max({half.x, half.y, half.z});
  Scene scene;
  scene.meshes.push_back(std::move(hare));
  for (std::uint32_t i = 0; i < parameters.count; ++i) {
    const auto axis = static_cast<int>(i % 6 / 2);
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    glm::dvec3 position(0.0);
    position[axis] = sign * parameters.spacing_m * (i / 6 + 1);
    scene.objects.push_back(
        {0, box_transform(position - box.center() * scale, glm::dvec3(scale)), none_id});
  }
  return scene;
}

}  // namespace vislab
