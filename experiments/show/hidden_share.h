// How much of what lies in the frustum is hidden: what occlusion culling by objects may save.
#pragma once

#include <filesystem>

#include "common/judge/truth.h"
#include "experiments/analysis/summary.h"
#include "experiments/show/stored_scene.h"

namespace vislab {

/// Triangles of the shown objects of which some part is in the frustum, and of those among them of
/// which truth sees nothing.
struct HiddenTriangles {
  std::uint64_t in_frustum = 0;
  std::uint64_t hidden = 0;

  /// NaN where nothing is in the frustum.
  double share() const;
};

/// O(triangles).
HiddenTriangles hidden_triangles(const Scene& scene, const Frame& frame, const FrameTruth& truth);

/// The share over all frames of a block (a ratio of sums), by the truth that the results hold.
/// `scenes` are those of the same results. Throws InputError if something is missing, or if the
/// scene is no longer the one that was measured.
double stored_hidden_share(const std::filesystem::path& results, StoredScenes& scenes,
                           const BlockSummary& block);

}  // namespace vislab
