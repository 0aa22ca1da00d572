// What counts as an error of a cell: one list for the question whether there is any (summary.h:
// is_free_of_errors) and for comparisons. Undisputed ones only.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/culler/culler.h"
#include "experiments/analysis/summary.h"

namespace vislab {

struct ErrorKind {
  const char* metric;  // as in `vislab list metrics`
  /// Also between the centres of pixels, where who promises only the image promises nothing.
  bool between_pixels;
};

inline constexpr std::array<ErrorKind, 6> error_kinds{{{"false_px", false},
                                                       {"image_px", false},
                                                       {"surface_px", false},
                                                       {"false_objects", true},
                                                       {"false_jittered", true},
                                                       {"region_misses", true}}};

/// One count for each of error_kinds.
using ErrorCounts = std::array<std::uint64_t, error_kinds.size()>;

/// 0 for what does not apply to the cell.
ErrorCounts error_counts(const CellSummary& cell);

/// Does what is lost between pixels count for methods with these promises? It does if one of them
/// is conservative; else not if one of them is image_exact.
bool counts_between_pixels(std::span<const Guarantee> promises);

}  // namespace vislab
