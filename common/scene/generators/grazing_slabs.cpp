#include <cmath>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/scene/orientation.h"

namespace vislab {

Scene make_grazing_slabs(const GrazingSlabsParameters& parameters) {
  const glm::dvec3 half_size(parameters.half_width_m, 0.5 * parameters.thickness_m,
                             parameters.half_width_m);
  Scene scene;
  scene.meshes.push_back(box_mesh(half_size, parameters.subdivisions, 1.0));
  const double upper_y = static_cast<float>(half_size.y);  // as the mesh has it
  Random random(parameters.seed);
  for (std::uint32_t i = 0; i < parameters.count; ++i) {
    const glm::dmat3 frame = random_rotation(random);
    const double side = i % 2 == 0 ? 1.0 : -1.0;  // the upper face turns to the origin
    const double sine = side * std::sin(parameters.tilt_rad);
    const double cosine = std::cos(parameters.tilt_rad);
    // From the origin the face's middle is seen along frame[0].
    const glm::dvec3 up = frame[1] * cosine - frame[0] * sine;
    const glm::dvec3 along = frame[0] * cosine + frame[1] * sine;
    const glm::dvec3 middle = frame[0] * parameters.distance_m;
    scene.objects.push_back({0, glm::dmat4x3(along, up, frame[2], middle - up * upper_y), none_id});
  }
  return scene;
}

}  // namespace vislab
