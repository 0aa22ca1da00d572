// Which parameters that look like dials of a model's size have a size sweep, and why others have
// none.
//
//   [[without]]
//   parameter = "leaf_size"
//   cullers = ["frustum.bvh"]      one reason for all; cullers that a build lacks do not count
//   because = "…"                  why there is no sweep
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/matrix/size_sweep.h"

namespace vislab {

/// A parameter of a culler without a sweep.
struct UnsweptDial {
  std::string culler, parameter, because;
};

struct SizeCoverage {
  std::size_t with_sweep = 0;
  std::vector<UnsweptDial> without;  // by culler, then as the culler declares them

  /// "25 sizes of models have a sweep; without: leaf_size of frustum.bvh (…), …"
  std::string text() const;
};

/// Is a parameter named like the size of a model? By its name alone, and only if changing it needs
/// a new build().
bool is_size_dial(const ParameterSpec& parameter);

/// Of all registered cullers but wrong variants, which nobody tunes, and the example. Throws
/// InputError if the file is wrong, or if a dial has both a sweep and a reason, or neither.
SizeCoverage size_coverage(const std::vector<SizeSweep>& sweeps, const Registry& registry,
                           const std::filesystem::path& file);

}  // namespace vislab
