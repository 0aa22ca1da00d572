// The loop that an engine programmer would write by hand for AVX2: the yardstick of the SIMD
// kernels. In a file of its own, because it alone is compiled for AVX2.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vislab {

/// Does this processor have what the loop needs, and was it built?
bool bare_loop_runs();

/// Boxes as six arrays of floats (min x, y, z, max x, y, z) against six planes (x, y, z, d;
/// inward). Writes one bit a box to `kept`: 0 if the p-vertex is behind a plane, without any
/// margin. `count` is a multiple of 64.
void bare_loop(const float (*planes)[4], const float* const* rows, std::size_t count,
               std::uint64_t* kept);

}  // namespace vislab
