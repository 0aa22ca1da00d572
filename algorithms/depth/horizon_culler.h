// The sweep of depth.horizon, from near to far, and of its wrong variants.
//
// Idea: nodes of a hierarchy and objects are looked at by the nearness of their nearest points.
// What
//   an object covers waits until its farthest point is nearer than what is looked at, and is joined
//   to the horizon then; so whatever the horizon covers is nearer than what is asked. A node or an
//   object whose rectangle is covered is hidden.
// Sources: Zachmann slides 44-46; Downs, Moeller and Sequin 2001.
#pragma once

#include <vector>

#include "algorithms/depth/convex_parts.h"
#include "algorithms/depth/horizon_columns.h"
#include "common/culler/culler.h"
#include "common/culler/stamps.h"
#include "common/spatial/bvh.h"
#include "common/spatial/followed_structure.h"

namespace vislab::depth_culling {

struct HorizonOptions {
  Ground ground = Ground::covered;
  /// What of an object is joined to the horizon: rectangles inside of its convex parts, or (wrong)
  /// the one around its box.
  enum class Cover { inside, around } cover = Cover::inside;
  /// Objects whose boxes cover fewer pixels join nothing.
  double occluder_px = 0.0;
  /// Wrong if not 0: distances are taken by up to this share too short or too long, each object's
  /// by another one that stays the same. Below 1.
  double distance_error = 0.0;
};

class HorizonCuller : public ICuller {
 public:
  HorizonCuller(CullerInfo info, const HorizonOptions& options);
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override;
  void reset(std::uint64_t seed) override;
  void update(const Frame& frame, const Changes& changes) override;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override;
  std::size_t bytes() const override;
  Counters counters() const override;

 private:
  /// A node or an object that is yet to be looked at.
  struct Waiting {
    BoxWindow place;
    std::uint32_t id = 0;
    bool node = false;
  };
  struct Occluder {
    BoxWindow place;
    ObjectId object = 0;
  };

  /// Lists shorter than this part of what is shown are looked at one by one, longer ones through
  /// the hierarchy: what it hides of them costs nothing by itself.
  static constexpr std::size_t short_list_part = 16;

  /// False if the list is short; else what it holds is noted.
  bool note_offered(const Candidates& candidates, const Frame& frame);
  void add_node(SpatialStructure::NodeIndex node, const Frame& frame);
  void add_object(ObjectId object, const Frame& frame);
  void look_at_waiting(const Frame& frame);
  void keep(ObjectId object, const Frame& frame, bool covers);
  /// Joins what covers nearer than this.
  void raise_horizon(float nearness);
  double error_factor(ObjectId object) const;

  CullerInfo info_;
  HorizonOptions options_;
  const Scene* scene_ = nullptr;
  std::vector<std::vector<ConvexPart>> parts_;  // by mesh
  FollowedStructure<Bvh> tree_;                 // of what is shown

  WindowTransform window_;
  HorizonColumns horizon_;
  std::uint64_t frame_ = ~std::uint64_t{0};
  std::vector<Waiting> waiting_;        // heap, nearest first
  std::vector<Occluder> occluders_;     // heap, by their farthest point, the nearest of them first
  std::vector<Occluder> frame_covers_;  // all that this frame's calls have kept
  std::vector<ObjectId> kept_;
  ObjectStamps offered_;     // of a long list
  bool walks_list_ = false;  // through the hierarchy
  std::uint64_t boxes_tested_ = 0, nodes_tested_ = 0, rectangles_joined_ = 0;
};

}  // namespace vislab::depth_culling
