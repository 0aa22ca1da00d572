// Pictures of the images that hidden-surface algorithms painted, beside truth's.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/judge/truth.h"
#include "experiments/show/stored_scene.h"

namespace vislab {

/// What a method painted (ICuller::surface_image).
struct PaintedSurface {
  std::string name;
  std::vector<TriangleId> owners;
};

/// Writes a PNG: truth, and each of the images with its wrong pixels marked. Throws InputError if
/// the file cannot be written.
void write_surface_picture(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                           const std::vector<PaintedSurface>& surfaces, const std::string& title,
                           const std::filesystem::path& file);

/// The same of what a block's hidden-surface algorithms painted, negative controls left out, from
/// what the results hold: of the frame in which they have most pixels wrong, or else of the middle
/// one. Returns a caption. Throws InputError if something is missing, or if the scene is no longer
/// the one that was measured.
std::string write_stored_surfaces(const std::filesystem::path& results, StoredScenes& scenes,
                                  const BlockSummary& block, const std::filesystem::path& file);

}  // namespace vislab
