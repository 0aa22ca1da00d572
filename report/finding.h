// What a block says in one sentence: which method saves how much without an error.
#pragma once

#include "experiments/analysis/summary.h"
#include "report/template.h"

namespace vislab {

enum class FindingKind {
  saves,         // the best method without errors is faster than none, beyond the noise
  within_noise,  // it cannot be told from none
  loses,         // it is slower than none, beyond the noise
  none_clean,    // every method that was judged and timed against none makes errors
  no_method      // no method was both judged and timed against none
};

struct Finding {
  FindingKind kind = FindingKind::no_method;
  const CellSummary* best = nullptr;    // without errors; null for the last two kinds
  const CellSummary* oracle = nullptr;  // the fastest one timed against none, or null
  /// The fastest method with errors, if it is faster than `best` and than none; else null.
  const CellSummary* erring = nullptr;
};

/// True if the judge found nothing that the cell's guarantee forbids: no false pixel, the image (if
/// drawn) unchanged, and for a conservative method no lost sample of J either.
bool is_free_of_errors(const CellSummary& cell);

/// Pointers lead into `block`. Only methods count, not the anchors.
Finding find(const BlockSummary& block);

/// The finding as fields for templates/verdict.md. `scene` is its name as Markdown.
Fields finding_fields(const BlockSummary& block, const std::string& scene);

}  // namespace vislab
