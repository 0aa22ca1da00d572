#include "algorithms/occlusion/node_walk.h"

#include <algorithm>

#include "algorithms/occlusion/box_queries.h"

namespace vislab::occlusion_culling {

double NodeWalk::nearness(NodeIndex node) const {
  return occlusion_culling::nearness(frame_->camera, hierarchy_.node(node).box);
}

void NodeWalk::build(const Scene& scene) {
  scene_ = &scene;
  hierarchy_.build(scene);
  offered_.resize(scene.object_count());
  kept_.reserve(scene.object_count());
  heap_.reserve(hierarchy_.node_count());
}

void NodeWalk::start(const Frame& frame, const Candidates& candidates, Order order) {
  order_ = order;
  frame_ = &frame;
  frustum_ = frustum_of(frame.camera);
  kept_.clear();
  handed_over_ = 0;
  heap_.clear();
  take(candidates);
  for (const ObjectId object : hierarchy_.unplaced()) {
    if (offered(object)) kept_.push_back(object);
  }
  push(SpatialStructure::root, (1U << static_cast<unsigned>(frustum_.plane_count)) - 1);
}

void NodeWalk::take(const Candidates& candidates) {
  everything_ = candidates.form() == Candidates::Form::everything;
  if (everything_) return;
  if (offered_below_.size() < hierarchy_.node_count() || ++call_ == 0) {
    offered_below_.assign(hierarchy_.node_count(), 0);
    call_ = 1;
  }
  offered_.clear();
  for (const std::span<const ObjectId> run : candidates.object_runs()) {
    for (const ObjectId object : run) {
      offered_.insert(object);
      NodeIndex node = hierarchy_.unit_of(object);
      while (node != QueryHierarchy::nowhere && offered_below_[node] != call_) {
        offered_below_[node] = call_;
        node = hierarchy_.parent(node);
      }
    }
  }
}

void NodeWalk::push(NodeIndex node, std::uint32_t planes) {
  if (hierarchy_.objects(node).empty() || (!everything_ && offered_below_[node] != call_)) return;
  const bool sorted = order_ == Order::near_first;
  heap_.push_back({sorted ? nearness(node) : 0.0, {node, planes}});
  if (sorted) std::ranges::push_heap(heap_, later);
}

bool NodeWalk::next(Visit& visit) {
  while (!heap_.empty()) {
    if (order_ == Order::near_first) std::ranges::pop_heap(heap_, later);
    visit = heap_.back().visit;
    heap_.pop_back();
    ++nodes_visited_;
    if (!outside(hierarchy_.node(visit.node).box, visit.planes)) return true;
  }
  return false;
}

void NodeWalk::open(const Visit& visit) {
  const SpatialNode& node = hierarchy_.node(visit.node);
  for (std::uint32_t i = 0; i < node.child_count; ++i) push(node.first_child + i, visit.planes);
}

std::uint64_t NodeWalk::draw(const Visit& visit) {
  const std::span<const ObjectId> objects = hierarchy_.objects(visit.node);
  if (everything_ && (visit.planes == 0 || objects.size() == 1)) {
    kept_.insert(kept_.end(), objects.begin(), objects.end());
    return hierarchy_.triangles(visit.node);
  }
  std::uint64_t triangles = 0;
  for (const ObjectId object : objects) {
    std::uint32_t planes = visit.planes;
    if (!offered(object) || outside(frame_->objects.bounds[object], planes)) continue;
    kept_.push_back(object);
    triangles += scene_->triangle_count(object);
  }
  return triangles;
}

bool NodeWalk::hand_over(DrawSink& out) {
  if (handed_over_ == kept_.size()) return false;
  out.objects(std::span<const ObjectId>(kept_).subspan(handed_over_));
  handed_over_ = kept_.size();
  return true;
}

bool NodeWalk::outside(const Aabb& box, std::uint32_t& planes) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(frustum_.plane_count); ++i) {
    const std::uint32_t bit = 1U << i;
    if ((planes & bit) == 0) continue;
    if (surely_outside(frustum_.planes[i], box)) return true;
    if (surely_inside(frustum_.planes[i], box)) planes &= ~bit;
  }
  return false;
}

std::size_t NodeWalk::bytes() const {
  return hierarchy_.bytes() + heap_.capacity() * sizeof(Item) + offered_.bytes() +
         kept_.capacity() * sizeof(ObjectId) + offered_below_.capacity() * sizeof(std::uint32_t);
}

}  // namespace vislab::occlusion_culling
