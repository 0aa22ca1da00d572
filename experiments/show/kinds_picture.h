// The five kinds of culling in one frame of a measured block.
#pragma once

#include <filesystem>
#include <memory>
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

/// Says of each triangle which kind leaves it out: the first of these that does. It lies outside a
/// plane of the frustum; a walk through cells and portals does not reach it, of any conservative
/// method that walks; it faces away, on a solid mesh; truth does not see it; or its object is no
/// larger in the image than the least threshold, of 4, 16, 64 and 256 pixels, at which anything
/// visible is: by the first approximate method, by name, that has a threshold in pixels.
class KindFinder {
 public:
  /// Builds the cullers that it asks. Scene and registry outlive it.
  KindFinder(const Scene& scene, const Registry& cullers);

  /// To be called for every frame of a path, in their order.
  void update(const Frame& frame, const Changes& changes);
  FrameKinds find(const Frame& frame, const FrameTruth& truth);

 private:
  struct DetailCuller {
    double threshold_px = 0.0;
    std::unique_ptr<ICuller> culler;
  };

  VisibleSet kept_by(ICuller& culler, const Frame& frame) const;
  bool keeps_object(const VisibleSet& kept, ObjectId object) const;
  void add_detail(const Frame& frame, FrameKinds& found);

  const Scene* scene_;
  std::vector<std::unique_ptr<ICuller>> walkers_;  // none for a scene without cells
  std::vector<DetailCuller> detail_;               // by ascending threshold
};

struct KindsPicture {
  std::string place;       // scene, path and frame
  std::size_t kinds = 0;   // how many of the five are in it
  double detail_px = 0.0;  // as FrameKinds has it
};

/// Of some frames of the block's path the one that shows most kinds, of these one with the least
/// threshold of detail culling, and of these the one in which the rarest kind leaves out most.
/// Written to `file` (PNG). Throws InputError if scene or truth are no longer there.
KindsPicture write_stored_kinds(const std::filesystem::path& results, const Registry& cullers,
                                StoredScenes& scenes, const BlockSummary& block,
                                const std::filesystem::path& file);

}  // namespace vislab
