// How large a model has to be: the figures of a size sweep, and its knees.
//
// The knee is the smallest model whose efficiency is at least 95 % of the best one's, with no more
// wrong pixels than that has. Smaller is what holds fewer bytes after build(), by more than 1 %; of
// models that hold the same, the one whose value stands first in the sweep. The common knee of
// several scenes is chosen in the same way by the geometric mean of the efficiencies, the sum of
// the wrong pixels and the sum of the bytes, of the values that were measured on every scene.
//
// Times differ from run to run, and with them which model is just within 5 %. So a model may be the
// knee if the interval of its efficiency reaches 95 % of the best, unless a smaller one has all of
// its interval there. `knee` is the smallest that may be; a default that may be is not refuted.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/analysis/summary.h"
#include "experiments/matrix/size_sweep.h"

namespace vislab {

/// At least this share of the best efficiency at the knee.
constexpr double knee_efficiency = 0.95;

/// One value of the dial on one scene, or on all scenes together.
struct SizePoint {
  std::string gap;  // why there are no figures: "not run", or the failure; empty if there are
  std::uint64_t bytes = 0;
  double build_ms = 0.0;
  double cost = 0.0;  // in the unit of SizeCost
  /// As SizeCost says, with the interval that at least three rounds give; else all three are equal.
  Estimate efficiency = Estimate::none();
  double relative = 0.0;           // efficiency.value / the best one's; NaN if not measured
  std::uint64_t wrong_pixels = 0;  // false_px + image_px; of conservative methods also lost samples
  double over = 0.0;
  double recall = 0.0;

  bool was_measured() const { return gap.empty(); }
};

/// A method's curve on one scene, or the common one.
struct SizeCurve {
  std::string scene, path;        // empty for the common one
  std::vector<SizePoint> points;  // one for each value of the dial
  std::optional<std::size_t> best, knee;
  std::vector<std::size_t> may_be_knee;  // ascending; knee is one of them
  /// Were all values measured in the same rounds? Else times that are paired with nothing (all but
  /// SizeCost::frame_ms) may differ by what else the machine did.
  bool same_rounds = true;

  std::size_t measured() const;
};

struct SizeVerdict {
  SizeMethod method;
  std::vector<SizeCurve> scenes;  // as the sweep's blocks
  SizeCurve common;               // bytes, build_ms: sums; over, recall: means; cost: NaN

  /// Are there at least two values on any of the scenes? One alone has nothing to be the knee of.
  bool was_measured() const;
  /// May the default be the common knee, as far as the intervals tell?
  bool default_is_knee() const;
};

struct SizeResult {
  SizeSweep sweep;
  std::vector<SizeVerdict> verdicts;  // one for each of the sweep's methods
  /// What the measured cells say of "cpu", "compiler", "revision" (with "+" if files were changed
  /// since), "date", "rounds" and "threads": each value once, ascending, with commas between them;
  /// empty where they say nothing.
  std::map<std::string, std::string> provenance;

  bool was_measured() const;
  /// Every value on every scene.
  bool is_complete() const;
};

/// The cell of a canonical chain on a block (by index) of the sweep, and its block; null pointers
/// if there is none.
struct SizeCell {
  const BlockSummary* block = nullptr;
  const CellSummary* cell = nullptr;
};
using SizeCellOf = std::function<SizeCell(std::size_t block, const std::string& chain)>;

SizeResult find_knees(const SizeSweep& sweep, const SizeCellOf& cell_of);

}  // namespace vislab
