// Cones in rows, tested with the widest vectors of the instruction set that the lab's own kernels
// run with.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace vislab {

struct ConeRows {
  /// The length of each row is a multiple of this.
  static constexpr std::size_t multiple = 16;

  std::array<std::vector<float>, 3> apex, axis;
  std::vector<float> cutoff;
};

/// Writes a bit for each cone, 1 if it is culled from an eye at `camera`. `culled` has room for
/// these and 8 bytes more, which may be written as well. Fastest, not repeatable: products and sums
/// are rounded as the instruction set has it.
void find_culled(const ConeRows& cones, const std::array<float, 3>& camera, std::uint8_t* culled);

}  // namespace vislab
