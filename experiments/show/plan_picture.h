// Plans of cells and portals: what a culler reached, kept and left out in a frame.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "common/judge/metrics.h"
#include "experiments/show/stored_scene.h"

namespace vislab {

/// The cells that a culler reached in its last cull(), as far as it tells (cell_walker.h); else
/// those that hold an object of `kept`, ascending.
struct ReachedCells {
  std::vector<CellId> cells;
  std::string means;  // what they are, for a legend
};
ReachedCells reached_cells(const ICuller& culler, const Scene& scene, const VisibleSet& kept);

/// Writes a PNG (common/render/cell_plan.h). Throws InputError if the scene has no cells or the
/// file cannot be written.
void write_plan_picture(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                        const VisibleSet& kept, const Verdict& verdict, const ReachedCells& reached,
                        const std::string& title, const std::filesystem::path& file);

/// The same of a measured cell, from what the results hold: of the frame in which most false pixels
/// were found, or else that in which most triangles were kept, for there the view goes farthest.
/// The culler is run once more, for what it reached. Returns a caption that names the frame. Throws
/// InputError if something is missing, if the scene is no longer the one that was measured, or has
/// no cells.
std::string write_stored_plan(const std::filesystem::path& results, const Registry& cullers,
                              StoredScenes& scenes, const BlockSummary& block,
                              const CellSummary& cell, const std::filesystem::path& file);

}  // namespace vislab
