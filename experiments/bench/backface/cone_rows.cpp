// Compiled for AVX2 on x86, whatever the rest is compiled for.
#include "experiments/bench/backface/cone_rows.h"

#include <cmath>

namespace vislab {

void find_culled(const ConeRows& cones, const std::array<float, 3>& camera, std::uint8_t* culled) {
  const float* apex_x = cones.apex[0].data();
  const float* apex_y = cones.apex[1].data();
  const float* apex_z = cones.apex[2].data();
  const float* axis_x = cones.axis[0].data();
  const float* axis_y = cones.axis[1].data();
  const float* axis_z = cones.axis[2].data();
  const float* cutoff = cones.cutoff.data();
  const std::size_t count = cones.cutoff.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float x = apex_x[i] - camera[0];
    const float y = apex_y[i] - camera[1];
    const float z = apex_z[i] - camera[2];
    const float along = x * axis_x[i] + y * axis_y[i] + z * axis_z[i];
    culled[i] = along >= cutoff[i] * std::sqrt(x * x + y * y + z * z) ? 1 : 0;
  }
}

}  // namespace vislab
