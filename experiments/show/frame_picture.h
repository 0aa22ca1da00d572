// Pictures of a frame: what a culler kept and left out, against truth.
#pragma once

#include <filesystem>
#include <string>

#include "common/judge/metrics.h"
#include "common/scene/library.h"
#include "experiments/analysis/summary.h"
#include "experiments/show/stored_scene.h"

namespace vislab {

/// Writes a PNG with two views: from the eye, and from outside with the frozen frustum. `counted`
/// is by objects for object cullers, by triangles for triangle cullers. Throws InputError if the
/// file cannot be written.
void write_frame_picture(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                         const VisibleSet& kept, const Verdict& verdict, Granularity granularity,
                         const std::string& title, const std::filesystem::path& file);

/// Pictures of measured cells, from what the results hold.
class StoredPictures {
 public:
  /// `scenes` outlive this.
  StoredPictures(std::filesystem::path results, StoredScenes& scenes);

  /// Draws the frame of a cell that tells most: the one with the most false pixels, or else the one
  /// with the greatest product of triangles seen and triangles culled. Returns a caption that names
  /// the frame. Throws InputError if the scene is no longer the one that was measured.
  std::string write(const BlockSummary& block, const CellSummary& cell,
                    const std::filesystem::path& file);

 private:
  std::filesystem::path results_;
  StoredScenes* scenes_;
};

}  // namespace vislab
