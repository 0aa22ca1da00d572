// Runs one block: truth, timed rounds over all its cells, verdicts.
#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "common/render/gpu_model.h"
#include "common/scene/library.h"
#include "experiments/matrix/matrix.h"
#include "experiments/run/progress.h"

namespace vislab {

struct RunSettings {
  DataFolders folders;
  std::filesystem::path repository;  // for the revision in the context
  std::filesystem::path results;
  std::string run;     // a name for this run that no other has
  std::string filter;  // only chains (short or canonical) that contain it; "" = all
  /// Measure again what was not measured by this run; with a filter, only what it names.
  bool force = false;
  bool retry_failed = false;       // try failed cells again
  std::set<std::string> given_up;  // ids of cells that this run does not try again
  // Measured by this run before, by the number of threads that Mesa draws with.
  std::map<int, CostTable> costs;
  std::map<int, GpuModel> device_fits;
};

struct BlockOutcome {
  std::vector<std::string> cells;  // ids of all cells of the block
  int measured = 0;                // that got new rounds
  int present = 0;                 // that were done before
  int failed = 0;                  // that failed now or before
  /// Messages on cells that failed when they were measured again, and have the result from before.
  std::vector<std::string> failed_but_kept;
  bool stopped = false;
};

/// Tells a supervisor what runs, so that a crash or a hang can be put down to a cell.
struct CellWatch {
  std::function<void(const std::string& cell_id, double timeout_s)> begin;
  std::function<void()> end;
  /// The block has measured what drawing and testing cost with its number of threads.
  std::function<void(const CostTable& costs)> calibrated;
  /// The block has fitted a modelled device to OSMesa.
  std::function<void(const GpuModel& model)> fitted;
};

/// Cells that are done are left alone; the others get the rounds that are missing, interleaved with
/// the block's anchors in shuffled order. They are saved after each whole round: a round counts
/// only together with its anchors. A cell that is done and measured again by force stays as it is
/// until all rounds of the new one are there; if that one fails, or is stopped, it stays for good.
/// The file of a cell that is damaged counts as none and is replaced. What drawing and testing cost
/// is measured before the first round, unless the settings have it; so are the dials of a modelled
/// device that are fitted, unless a cell of the block is done: the others then get its dials, for
/// they are compared with it. Cells on a modelled device repeat whatever their methods declare:
/// their times are the device's own, and a round that gives others is a failure. A cell that fails
/// is stored with its reason. `stop` ends the run after the present pass, or the rays of the
/// present frame. Throws InputError for scenes, paths and results that are wrong.
BlockOutcome run_block(const Block& block, const RunSettings& settings, const Registry& registry,
                       Progress& progress, const CellWatch& watch,
                       const volatile std::sig_atomic_t& stop);

}  // namespace vislab
