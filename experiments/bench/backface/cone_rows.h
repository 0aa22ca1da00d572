// Cones in rows, for a loop that compilers turn into SIMD code.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace vislab {

struct ConeRows {
  std::array<std::vector<float>, 3> apex, axis;
  std::vector<float> cutoff;
};

/// Writes 1 for each cone that is culled, else 0.
void find_culled(const ConeRows& cones, const std::array<float, 3>& camera, std::uint8_t* culled);

}  // namespace vislab
