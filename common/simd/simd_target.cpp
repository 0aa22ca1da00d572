#include "common/simd/simd_target.h"

#include <hwy/highway.h>

#include <stdexcept>

namespace vislab {
namespace {

/// How many scopes live: as Highway's own setting, one for the whole program.
int scopes = 0;

bool has_byte_permutations() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vbmi");
#else
  return false;
#endif
}

}  // namespace

std::string simd_target() { return simd_targets().front(); }

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  // The lowest bit is the best instruction set.
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    names.emplace_back(hwy::TargetName(target));
  }
  return names;
}

SimdTargetScope::SimdTargetScope(const std::string& target) {
  for (const std::int64_t known : hwy::SupportedAndGeneratedTargets()) {
    if (target == hwy::TargetName(known)) {
      hwy::SetSupportedTargetsForTest(known);
      ++scopes;
      return;
    }
  }
  throw std::logic_error("no instruction set of this processor is called " + target);
}

SimdTargetScope::~SimdTargetScope() {
  hwy::SetSupportedTargetsForTest(0);
  --scopes;
}

bool simd_byte_permutations() {
  static const bool present = has_byte_permutations();
  return present && scopes == 0;
}

}  // namespace vislab
