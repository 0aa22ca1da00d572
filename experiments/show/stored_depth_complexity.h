// The depth complexity of what a block was measured on.
#pragma once

#include <filesystem>

#include "experiments/analysis/summary.h"
#include "experiments/show/depth_complexity_picture.h"
#include "experiments/show/stored_scene.h"

namespace vislab {

/// Of the frame after a third of the block's path, by all three definitions. Counted once and kept
/// in the results (`depths/`, by the block's first cell and the judge's sources): some scenes take
/// seconds. If `picture` is not empty, it is counted anew for a heat map of the rays, which is
/// written to it (PNG). `scenes` are those of the same results; threads may call at the same time.
/// Throws InputError if the block has no cell, or if scene or path have to be loaded and are no
/// longer those that were measured.
DepthComplexityTable stored_depth_complexity(const std::filesystem::path& results,
                                             StoredScenes& scenes, const BlockSummary& block,
                                             const std::filesystem::path& picture);

}  // namespace vislab
