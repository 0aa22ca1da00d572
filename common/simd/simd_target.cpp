#include "common/simd/simd_target.h"

#include <hwy/highway.h>

#include <stdexcept>

namespace vislab {

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
      return;
    }
  }
  throw std::logic_error("no instruction set of this processor is called " + target);
}

SimdTargetScope::~SimdTargetScope() { hwy::SetSupportedTargetsForTest(0); }

}  // namespace vislab
