// Which instruction set the SIMD kernels run with. Highway chooses the best one at run time;
// kernels of all layers are written once (HWY_EXPORT, HWY_DYNAMIC_DISPATCH) and compiled for each.
#pragma once

#include <string>
#include <vector>

namespace vislab {

/// Name of the instruction set in use now: "AVX2", "SSE4", …
std::string simd_target();

/// Names of those that this processor supports and the kernels are compiled for, best first.
std::vector<std::string> simd_targets();

/// May kernels use the byte permutations of AVX-512 (VBMI), which are no instruction set of
/// Highway's own here? Only if the processor has them and no SimdTargetScope lives. O(1).
bool simd_byte_permutations();

/// While it lives, all kernels run with one instruction set. For tests and benchmarks: not
/// for use while another thread runs a kernel, and not nested.
class SimdTargetScope {
 public:
  /// Throws std::logic_error for a name that simd_targets() does not have.
  explicit SimdTargetScope(const std::string& target);
  ~SimdTargetScope();
  SimdTargetScope(const SimdTargetScope&) = delete;
  SimdTargetScope& operator=(const SimdTargetScope&) = delete;
};

}  // namespace vislab
