#include "experiments/analysis/errors.h"

#include <algorithm>

namespace vislab {

ErrorCounts error_counts(const CellSummary& cell) {
  ErrorCounts counts{};
  for (std::size_t i = 0; i < error_kinds.size(); ++i) {
    const double count = cell.metric(error_kinds[i].metric);
    if (count > 0.0) counts[i] = static_cast<std::uint64_t>(count);  // NaN: it does not apply
  }
  return counts;
}

bool counts_between_pixels(std::span<const Guarantee> promises) {
  const auto any = [&](Guarantee guarantee) {
    return std::ranges::find(promises, guarantee) != promises.end();
  };
  return any(Guarantee::conservative) || !any(Guarantee::image_exact);
}

}  // namespace vislab
