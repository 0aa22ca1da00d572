// What a block says in one sentence: which method saves how much without an error; or where nothing
// is drawn, which leaves the least over.
#pragma once

#include "experiments/analysis/summary.h"
#include "report/template.h"

namespace vislab {

enum class FindingKind {
  saves,         // the best method without errors is faster than none, beyond the noise
  within_noise,  // it cannot be told from none
  loses,         // it is slower than none, beyond the noise
  none_clean,    // every method that was judged and timed against none makes errors
  no_method,     // no method was both judged and timed against none
  not_drawn      // nothing is drawn, so nothing is said of savings
};

struct Finding {
  FindingKind kind = FindingKind::no_method;
  /// Without errors: the fastest, of those that are told to be faster than none if there are any;
  /// or where nothing is drawn, the one with the least over. Null if there is none.
  const CellSummary* best = nullptr;
  /// The fastest without false pixels that was timed against none, or null.
  const CellSummary* oracle = nullptr;
  /// The fastest method with errors, if it is faster than `best` and than none; where nothing is
  /// drawn, the one with the least over, if it has less than `best`; else null.
  const CellSummary* erring = nullptr;
};

/// Pixels that are wrong: those left out, or where none is, those whose image differs, also the one
/// that a method painted itself.
std::uint64_t wrong_pixels(const CellSummary& cell);

/// Pointers lead into `block`. Only methods count, not the anchors. One that is wrong on purpose is
/// never the best, even where its mistake does no harm.
Finding find(const BlockSummary& block);

/// The finding as fields for templates/verdict.md. `scene` is its name as Markdown.
Fields finding_fields(const BlockSummary& block, const std::string& scene);

}  // namespace vislab
