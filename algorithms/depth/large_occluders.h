// The few large things of a scene, which hide most of the rest: drawn into a depth buffer before
// anything else is asked about.
//
// Idea: where a city's buildings are thousands and what stands in and between them are a hundred
//   times as many, a walk that meets both near first opens the inside of a building before it has
//   come to the building itself. So objects whose boxes are many times as large as the scene's
//   median, with few triangles, are kept in a list; near first, those that are not hidden by what
//   was drawn before are drawn. The walk then drops whole houses at one question.
// Guarantee: none needed: what is drawn is shown, and offered; it is asked about again like
//   everything else, and nothing hides itself.
// Cost: O(large objects) a frame, at most 4,096; update O(changes).
// Limits: a scene of things of one size has none.
// Sources: Zachmann slides 42, 47 (few objects hide many); Hasselgren et al. 2016 (occluders
// first).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "algorithms/depth/draw_order.h"
#include "algorithms/depth/occluders.h"
#include "common/raster/depth_raster.h"
#include "common/scene/frame.h"

namespace vislab::depth_culling {

class LargeOccluders {
 public:
  /// Chooses. The scene outlives this; all is shown, where it was built.
  void build(const Scene& scene);
  /// Back to the scene as built.
  void reset();
  /// Follows what moves, comes and goes.
  void update(const Frame& frame, const Changes& changes);

  /// Draws large objects that are shown and for which offered(object), in the order of the keys,
  /// as the budget allows, unless they are hidden by those before; calls drawn(object) for each
  /// that was drawn.
  template <typename Offered, typename Drawn>
  void draw(const Frame& frame, const OccluderMeshes& meshes, const DrawKeys& keys,
            OccluderBudget& budget, DepthRaster& raster, Offered&& offered, Drawn&& drawn) {
    by_key_.clear();
    for (std::uint32_t slot = 0; slot < objects_.size(); ++slot) {
      const Aabb& box = frame.objects.bounds[objects_[slot]];
      if (shown_[slot] != 0 && offered(objects_[slot])) by_key_.add(keys.of(box, slot), slot);
    }
    by_key_.sort();
    order_.clear();
    for (const ObjectOrder::Place& place : by_key_.places()) {
      const std::uint32_t slot = place.object;
      const double px = about_pixels(frame, frame.objects.bounds[objects_[slot]]);
      draws_[slot] = meshes.of(objects_[slot], frame);
      if (budget.take(px, draws_[slot].count)) order_.push_back(slot);
    }
    raster.draw_visible(draws_, boxes_, order_, hidden_);
    for (const std::uint32_t slot : order_) {
      if (hidden_[slot] == 0) drawn(objects_[slot]);
    }
  }

  std::size_t bytes() const;

 private:
  static double about_pixels(const Frame& frame, const Aabb& box);
  void place(std::size_t slot, const Aabb& box);
  std::size_t slot_of(ObjectId object) const;

  const Scene* scene_ = nullptr;
  std::vector<ObjectId> objects_;  // ascending
  std::vector<std::uint8_t> shown_;
  std::vector<BoxColumns> boxes_;
  bool changed_ = false;  // since the scene was as built

  // Of one call of draw().
  ObjectOrder by_key_;
  std::vector<std::uint32_t> order_;
  std::vector<RasterDraw> draws_;
  std::vector<std::uint8_t> hidden_;
};

}  // namespace vislab::depth_culling
