#include "experiments/bench/frustum/bare_loop.h"

#if defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>

namespace vislab {

bool bare_loop_runs() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
}

void bare_loop(const float (*planes)[4], const float* const* rows, std::size_t count,
               std::uint64_t* kept) {
  const float* x[6];
  const float* y[6];
  const float* z[6];
  for (int i = 0; i < 6; ++i) {
    x[i] = rows[planes[i][0] >= 0.0F ? 3 : 0];
    y[i] = rows[planes[i][1] >= 0.0F ? 4 : 1];
    z[i] = rows[planes[i][2] >= 0.0F ? 5 : 2];
  }
  for (std::size_t box = 0; box < count; box += 64) {
    std::uint64_t word = 0;
    for (std::size_t lane = 0; lane < 64; lane += 8) {
      __m256 signs = _mm256_setzero_ps();
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) {
        __m256 value = _mm256_set1_ps(planes[i][3]);
        value = _mm256_fmadd_ps(_mm256_set1_ps(planes[i][2]), _mm256_loadu_ps(z[i] + box + lane),
                                value);
        value = _mm256_fmadd_ps(_mm256_set1_ps(planes[i][1]), _mm256_loadu_ps(y[i] + box + lane),
                                value);
        value = _mm256_fmadd_ps(_mm256_set1_ps(planes[i][0]), _mm256_loadu_ps(x[i] + box + lane),
                                value);
        signs = _mm256_or_ps(signs, value);
      }
      const auto outside = static_cast<unsigned>(_mm256_movemask_ps(signs));
      word |= static_cast<std::uint64_t>(~outside & 0xFFU) << lane;
    }
    kept[box / 64] = word;
  }
}

}  // namespace vislab

#else

namespace vislab {

bool bare_loop_runs() { return false; }
void bare_loop(const float (*)[4], const float* const*, std::size_t, std::uint64_t*) {}

}  // namespace vislab

#endif
