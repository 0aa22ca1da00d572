// What the methods of one family do on a block, each held to what it was added to: a chain's last
// stage to the same chain without it, so that no family is credited with what another one saves.
#pragma once

#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/summary.h"

namespace vislab {

/// Of a stage by its name; without a registry what stands before the dot.
std::string family_of_stage(const std::string& name, const Registry* cullers);

/// The family of the chain's last stage: what stands before it only prepares.
std::string family_of(const CellSummary& cell, const Registry* cullers);

/// The finished and judged cell of the same chain without its last stage; null for a single method,
/// and if the block has no such cell.
const CellSummary* without_last_stage(const BlockSummary& block, const CellSummary& cell);

/// Pointers lead into the block.
struct FamilyMethod {
  const CellSummary* cell = nullptr;
  const CellSummary* before = nullptr;  // what it is held to; null: none
  /// frame_ms ÷ that of `before` (or of none); NaN where nothing is drawn, and of a chain whose
  /// beginning was not measured, for what its last stage adds is not known. Both are paired with
  /// none; of a chain the interval is the widest that theirs allow.
  Estimate ratio;
  /// Triangles submitted ÷ those of `before` (or of the scene); NaN of such a chain.
  double kept = 0.0;

  /// The name of what it is held to: "none" or a chain.
  std::string against() const { return before == nullptr ? "none" : before->culler; }
};

struct FamilyOn {
  /// Finished and judged, no anchors; nor methods that go from cell to cell whose viewer never was
  /// in any, for they had nothing to work on.
  std::vector<FamilyMethod> methods;
  /// Without errors and not wrong on purpose: its last stage takes the least share of the time, of
  /// those told to save any if there are such, or where nothing is drawn, leaves the least share of
  /// the triangles. Null: there is none.
  const FamilyMethod* best = nullptr;
  const CellSummary* worst = nullptr;       // with the most false pixels; null: all have none
  const CellSummary* most_wrong = nullptr;  // as `worst`, by wrong_pixels()
  std::size_t erring = 0;

  FamilyOn() = default;
  FamilyOn(FamilyOn&&) = default;  // `best` leads into `methods`, which moves as a whole
  FamilyOn& operator=(FamilyOn&&) = default;
};

FamilyOn family_on(const BlockSummary& block, const std::string& family, const Registry* cullers);

/// Does the method's last stage save time on the drawn block, beyond the noise?
bool saves_time(const BlockSummary& block, const FamilyMethod& method);

}  // namespace vislab
