// What the stored cells say: metrics per cell, paired comparisons, blocks as the report shows them.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiments/analysis/statistics.h"
#include "experiments/results/store.h"

namespace vislab {

/// Statistics over all frames; each frame counts with the median of its rounds.
struct TimeSummary {
  Estimate median;              // of the frames; the interval is that of the rounds
  double p95 = 0.0, p99 = 0.0;  // over all samples of all rounds
  double worst = 0.0;
  /// Standard deviation of all samples but the first of each round, when nothing is known yet of
  /// the path; of a single frame NaN.
  Estimate deviation;

  bool measured() const { return median.measured(); }
};

struct CellSummary {
  std::string id;
  std::string culler;     // short name; the A/A control is "none (again)"
  std::string canonical;  // chain with all parameters
  bool anchor = false;    // none, oracle and the A/A control
  int replicate = 0;
  ResultCell::Status status = ResultCell::Status::done;
  std::string reason;
  Guarantee guarantee = Guarantee::conservative;
  Repeatability repeatability = Repeatability::stateless;
  Granularity granularity = Granularity::object;
  Culls culls = Culls::hidden;
  int rounds = 0;
  std::set<std::string> sessions;  // the runs of the block that measured it: rounds pair within one
  std::string machine;             // id of the one that measured it
  std::size_t device_model = 0;    // place in BlockSummary::device_models, if that has any

  // Accuracy, sums over all frames unless it says otherwise.
  bool judged = false;       // false: the values below mean nothing
  std::uint64_t pixels = 0;  // samples of C judged: the n of "0 of n"
  std::uint64_t false_px = 0, max_false_px = 0, false_objects = 0, false_triangles = 0;
  std::uint64_t false_jittered = 0, jittered = 0;
  std::uint64_t excused_px = 0;   // disputed samples that were lost
  std::uint64_t disputed_px = 0;  // the error floor of the cell's frames, whatever was culled
  bool drawn = false;
  std::uint64_t image_px = 0, disputed_image_px = 0;
  bool paints = false;  // an image of its own: a hidden-surface algorithm
  std::uint64_t surface_px = 0, disputed_surface_px = 0;
  /// The frame with the most wrong pixels (the first of them), and how many: of the image that it
  /// paints, else of truth.
  std::size_t worst_frame = 0;
  std::uint64_t worst_frame_px = 0;
  // Ratios of sums over all frames; NaN where nothing is visible, or for recall nothing is hidden.
  double over = 0.0, over_objects = 0.0, under = 0.0;
  /// Triangles culled / those that a perfect method of the kind (CullerInfo::culls) would cull.
  double recall = 0.0;
  /// Of methods with a set for each cell, from all over the cells; the others have none.
  std::optional<RegionVerdict> regions;
  double flicker = 0.0;  // toggles / changes from one frame to the next: frames - 1
  std::uint64_t pop_px_frames = 0, latency_frames = 0;
  double submitted_triangles = 0.0, visible_triangles = 0.0, kept_objects = 0.0;  // per frame
  double draws = 0.0, pieces = 0.0;  // per frame, as CellFrame has them

  // Times; NaN if the cell was not timed. Where nothing is drawn, frame_ms and draw_ms say nothing
  // of the method's worth, and what is made of them (against_none, efficiency) is NaN.
  TimeSummary update_us, cull_us, draw_ms, frame_ms;
  double build_ms = 0.0;
  /// Test cost (update_us + cull_us) + what is submitted at calibrated costs: triangles, draws and
  /// further pieces of meshes. Methods that use the device: against_none × that of none, for what
  /// they save or wait for there is not in what they submit. NaN without calibrated costs, and on
  /// modelled devices, whose costs are their own.
  double modelled_frame_ms = 0.0;
  bool asks_device = false;
  bool calibrated = false;  // measured with a table of costs beside it; not so in old results
  std::uint64_t bytes = 0;
  /// frame_ms of this cell / frame_ms of none, paired by frame and round; NaN without such pairs.
  Estimate against_none;
  /// frame_ms of the oracle of the same level / frame_ms of this cell, paired.
  Estimate efficiency;
  std::map<std::string, double> counters;  // per frame

  /// False pixels; of a method that paints an image of its own, the wrong ones of that.
  std::uint64_t wrong_px() const { return paints ? surface_px : false_px; }

  /// The value under the metric's name as in `vislab list metrics`; NaN if it does not apply.
  double metric(const std::string& name) const;
};

/// True if the judge found no false pixel, the image (if drawn) unchanged, no lost sample of J and
/// no false object, no miss from a cell. An image_exact method promises only the pixels, so what it
/// loses between them is no error.
bool is_free_of_errors(const CellSummary& cell);

struct BlockSummary {
  std::string scene, scene_description, path;
  std::string scene_hash, path_hash;
  Viewport viewport;
  std::string device;
  int threads = 0;
  std::uint64_t seed = 0;
  int frames = 0;
  std::uint64_t objects = 0, triangles = 0;
  double moving_objects = 0.0;  // a frame
  /// False on the device "none": there are no images, and times hold no drawing to be saved.
  bool drawn = true;
  /// The dials of a modelled device, fitted ones included; there frame_ms and draw_ms are the
  /// device's own clock. More than one if cells were measured on fits that differ, in the cells'
  /// order; empty for other devices.
  std::vector<GpuModel> device_models;
  /// Truth against the unculled image, over all frames.
  std::uint64_t floor_pixels = 0, floor_disputed_px = 0, floor_undisputed_px = 0;
  /// none against its A/A control: how far from 1 the interval reaches is the noise of ratios. Not
  /// measured if there is no control.
  Estimate noise;
  std::vector<CellSummary> cells;              // none, the oracles, then by name
  std::map<std::string, std::string> context;  // of the first cell
  /// Facts of the context that differ between cells: all values, by name, ascending.
  std::map<std::string, std::vector<std::string>> mixed_context;
  std::vector<std::string> machines;  // ids of all machines that measured cells here
  /// By machine: what drawing and testing cost there, the median over its cells' tables.
  std::map<std::string, CostTable> costs;
};

/// Were all cells measured on one machine? Times of several have no common order, and are neither
/// charted nor compared.
bool is_of_one_machine(const BlockSummary& block);

/// From where to where ratios lie that may be noise: 1, and what none gives against itself. Without
/// a control (`noise` was not measured) any ratio may be noise: from 0 to infinity.
Estimate noise_band(const Estimate& noise);

/// What a share of the time of drawing everything says beyond the block's noise.
enum class AgainstNone { faster, alike, slower };
AgainstNone told_against_none(const BlockSummary& block, const Estimate& ratio);

/// Is `a` to be preferred for its share of the time of drawing everything? What is told to be
/// faster than that goes before what may be, and of two alike the one with the lesser share.
bool is_sooner(const BlockSummary& block, const Estimate& a, const Estimate& b);

/// A cell and what the present judge makes of it (empty: nothing yet).
struct JudgedCell {
  ResultCell cell;
  std::optional<CellVerdicts> verdicts;
};

/// The blocks that the cells belong to, by scene and path. Cells without verdicts are summarised
/// without accuracy (`judged` is false). Cells that no longer count (of methods mended since) are
/// the caller's to leave out.
std::vector<BlockSummary> summarise(const std::vector<JudgedCell>& cells);

}  // namespace vislab
