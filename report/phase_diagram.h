// Who is fastest on a modelled graphics processor, by the latency of its answers and by how much of
// what lies in the frustum is hidden.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// A block's fastest method.
struct PhaseCell {
  std::string winner, next;
  double lead = 1.0;                   // times as fast as the next best
  std::optional<double> over_frustum;  // times as fast as the best by the frustum alone, if any
  bool decided = false;                // the lead is at least 1 %
};

struct PhaseRow {
  std::string scene, path;
  double hidden_share = 0.0;                         // measured
  std::vector<std::optional<PhaseCell>> by_latency;  // none: not measured
};

/// Why a method that asks the device or culls by the frustum took no part in some cells.
struct PhaseAbsence {
  std::string culler, reason;
  std::size_t cells = 0;
};

struct PhaseDiagram {
  std::string title;                        // what the scenes have in common, and the device
  std::vector<double> latencies_us;         // ascending
  std::vector<PhaseRow> rows;               // by ascending share
  std::vector<const BlockSummary*> blocks;  // of which it speaks
  std::vector<std::string> winners;         // those that win anywhere, the most frequent first
  std::vector<PhaseAbsence> absences;       // by culler; not of methods that promise less
};

/// Who may win in a block: methods that are right, judged and timed, and that ask the device or
/// cull by the frustum alone. A modelled device's clock does not hold the processor's own work, so
/// that methods which do theirs there would win for nothing.
std::vector<const CellSummary*> phase_contestants(const BlockSummary& block);

/// Diagrams of blocks on modelled devices that differ in latency, scene and path only, with at
/// least two latencies and two rows each. Scenes belong together if their names differ only in
/// words (between underscores) that are numbers. Blocks that differ in anything else (resolution,
/// frames, threads, seed, dials of the device) stand in diagrams of their own, and blocks whose
/// cells were measured on several fits of the device in none. Where `hidden_share` throws
/// InputError, the scene is left out.
std::vector<PhaseDiagram> phase_diagrams(
    const std::vector<BlockSummary>& blocks,
    const std::function<double(const BlockSummary& block)>& hidden_share);

/// gnuplot commands that draw it into `file` (SVG, 680 units wide).
std::string phase_script(const PhaseDiagram& diagram, const std::filesystem::path& file);

/// A letter for the winner of that index: "A".
std::string phase_letter(std::size_t winner);

}  // namespace vislab
