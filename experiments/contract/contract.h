// The contract that every culler keeps, checked from outside. `vislab check` and the contract tests
// run it over any registered culler or chain.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/contract/witness.h"

namespace vislab {

/// One rule of the contract.
struct ContractResult {
  std::string check;  // the rule in words
  bool passed = false;
  std::string message;  // what was wrong first, and where; empty if the rule is kept
};

/// Checks a culler or chain on the small scenes (small_scenes.h):
/// - its info is complete, and its parameters have meanings and valid defaults;
/// - parameters that are unknown or out of range are refused;
/// - it says what it needs: without a device or truth it refuses if it declares that need, and only
///   then;
/// - it emits a subset of what it is offered, each triangle once, whether it is offered everything,
///   runs of objects, ranges of triangles (if that is its granularity) or batches;
/// - its answers come again as its repeatability declares, with one thread and with two;
/// - its guarantee holds, by ray casts (conservative) or on the image (image_exact);
/// - its sets of cells, if it has any, come again and hold what rays from all over the cells hit;
/// - it allocates nothing when a path is walked a second time.
/// `witness`, if it is not null, becomes the first wrong pixel: of the answer that breaks the
/// guarantee, or, of methods that promise nothing (approximate, erroneous), of the first answer
/// that leaves out something visible; none if there is no such answer. Throws InputError if `spec`
/// is not a culler. Takes about a second.
std::vector<ContractResult> check_contract(const Registry& registry, const std::string& spec,
                                           std::optional<Witness>* witness = nullptr);

}  // namespace vislab
