// The five kinds of culling in one frame of a measured block.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "common/judge/truth.h"
#include "common/render/kinds_picture.h"
#include "experiments/show/stored_scene.h"

namespace vislab {

struct FrameKinds {
  std::vector<CullingKind> kinds;                          // by TriangleId
  std::array<std::uint64_t, culling_kind_count> counts{};  // triangles shown
  double detail_px = 0.0;  // the threshold at which detail culling left anything out; 0: it did not
};

/// Of each triangle, the first of these that leaves it out: it lies outside a plane of the frustum;
/// the walk through cells and portals does not reach it; it faces away, on a solid mesh; truth does
/// not see it; and the object is no larger in the image than the least threshold, of 4, 16, 64 …
/// pixels up to a hundredth of the image, at which anything visible is.
FrameKinds kinds_of_frame(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                          const Registry& cullers);

struct KindsPicture {
  std::string place;       // scene, path and frame
  std::size_t kinds = 0;   // how many of the five are in it
  double detail_px = 0.0;  // as FrameKinds has it
};

/// Of some frames of the block's path the one that shows most kinds, and of these the one in which
/// the rarest leaves out most. Written to `file` (PNG). Throws InputError if scene or truth are no
/// longer there.
KindsPicture write_stored_kinds(const std::filesystem::path& results, const Registry& cullers,
                                StoredScenes& scenes, const BlockSummary& block,
                                const std::filesystem::path& file);

}  // namespace vislab
