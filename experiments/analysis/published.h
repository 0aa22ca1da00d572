// Figures that the sources print, beside which the lab sets its own: TOML files of facts.
//
//   title = "Thesis, tables 5.2 to 5.9"
//   source = "Kowalka 2016"
//   note = "…"                     what is known to be odd about the figures
//   tolerance = 1.5                of rows in frames a second: by which factor ours may be off
//   [stand_ins]                    what our scenes stand for, by name
//   hares_546 = "…"
//   [[row]]
//   what = "mixed scene, camera moving"
//   table = "5.2"
//   without_fps = 58.92            frames a second without culling (or of what `against` stands
//   with_fps = 66.21               for), and with; or instead of both
//   published = "1.4, at most 3"   the claim as the source words it
//   accept = [1.0, 3.0]            and what of ours confirms it; may be inf
//   metric = "frame_ms"            what stands for it here. frame_ms, cull_us: how many times as
//                                  fast as `against`; culled: share of all triangles;
//                                  decision_share: of frame_ms, what goes into update and cull; or
//                                  any metric or counter of a cell
//   scene = "mixed"                of this scene, path ("" or left out: any path)
//   path = "mixed_moving"
//   device = "modelled[…]"         only there; left out: any real device
//   culler = "frustum.two_step"    and method
//   against = "none"               what it is compared with. Left out: none for times; all other
//                                  metrics stand for themselves, and are divided by that of
//                                  `against` if there is one
//   against_scene = "hares_14"     where that stands, if elsewhere; left out: on the same scene
//   against_path = "hares_walk"    and the same path. Not for times, which can be set beside each
//                                  other only within the same rounds
//   cannot_be_told = "…"           instead of accept, metric, scene, path, device, culler and
//                                  against: why nothing here can stand beside the figure. With
//                                  frames a second, scene, path and culler may stay: ours is shown
//                                  beside theirs, and gets no verdict
//
// The rule: a claim is confirmed where the whole interval of our figure lies in `accept`, not
// confirmed where all of it lies outside, and cannot be told where it does both; nor where it lies
// below and our scene cannot show more, because not even the oracle, which draws nothing but what
// is visible, gets as far as `accept`. Intervals of wall times are first widened by what none gives
// against itself in that block (noise_band), for so much two of the same may differ.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/summary.h"

namespace vislab {

struct PublishedRow {
  std::string what, table;
  double without_fps = 0.0, with_fps = 0.0;
  std::string scene, path;
  std::string culler, against;                        // canonical
  std::string short_culler = {}, short_against = {};  // the same as tables show them
  std::string published = {};                         // instead of frames a second
  enum class Metric { frame_ms, cull_us, culled, decision_share, named } metric = Metric::frame_ms;
  std::string cannot_be_told = {};  // if not empty, there is no verdict; no `scene`: nor a figure
  std::string metric_name = {};     // of Metric::named, as CellSummary::metric has it
  std::string device = {};          // as parse_device writes it; "": any real one
  std::string against_scene = {},
              against_path = {};  // where `against` stands; "": in the same place
  std::string stand_in = {};      // what the scene stands for; "" if that needs no words
  /// Our figures from `low` to `high` confirm the claim.
  struct {
    double low = 0.0, high = std::numeric_limits<double>::infinity();
  } accept = {};
  /// Is our figure a quotient of two methods'? (Else it is the metric itself.)
  bool compares = true;

  bool compares_places() const { return !against_scene.empty() || !against_path.empty(); }

  bool is_share() const {
    return !compares && (metric == Metric::culled || metric == Metric::decision_share);
  }

  /// How many times as many frames a second as without; not with `published`.
  double ratio() const { return with_fps / without_fps; }
};

struct PublishedFigures {
  std::string title, source, note;
  std::vector<PublishedRow> rows;
};

/// All files of the folder, by name; empty if there is no such folder. Throws InputError that names
/// file, line or key, and what would be right.
std::vector<PublishedFigures> load_published(const std::filesystem::path& folder,
                                             const Registry& registry);

/// The block and the cell that stand for a row; null where they were not measured.
struct OwnFigure {
  const BlockSummary* block = nullptr;
  const CellSummary* cell = nullptr;
  /// The block of `against`, if that is another one.
  const BlockSummary* other = nullptr;
  /// Our figure (see the head of this file). frame_ms against none is paired by frame and round;
  /// other quotients of times are those of two such ratios, or of the medians of cull_us, and the
  /// errors of both add up; so do those of deviations and of shares of the time. Whatever else is
  /// no time has no interval. NaN for 0 against 0.
  Estimate ratio = Estimate::none();
  /// The same figure of the best oracle in the block, the most that any method could reach there;
  /// of frame times and of shares of all triangles only, else NaN.
  double reach = std::numeric_limits<double>::quiet_NaN();

  /// Is ours below what would confirm the claim, and so is all that the scene could show?
  bool is_out_of_reach(const PublishedRow& row) const {
    return ratio.high < row.accept.low && reach < row.accept.low;
  }
};

/// Of several blocks of the row's scene and path the one with the most frames, then with the most
/// pixels, then the first.
OwnFigure own_figure(const PublishedRow& row, const std::vector<BlockSummary>& blocks);

enum class ClaimVerdict { confirmed, not_confirmed, cannot_be_told, not_run };

/// "confirmed", "not confirmed", "cannot be told", "not run".
std::string to_string(ClaimVerdict verdict);

/// By the rule at the head of this file; `own` is the row's.
ClaimVerdict verdict_of(const PublishedRow& row, const OwnFigure& own);

/// Would the verdict be another if times had no noise?
bool noise_decides(const PublishedRow& row, const OwnFigure& own);

}  // namespace vislab
