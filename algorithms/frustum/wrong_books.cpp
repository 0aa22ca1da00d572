// Right tests of boxes on wrong books: memory that outlives its premise, bounds that are not those
// of the objects, lists that lose them.

#include <algorithm>

#include "algorithms/frustum/motion_coherence.h"
#include "algorithms/frustum/wrong_rules.h"
#include "common/culler/stamps.h"

namespace vislab::frustum_culling {
namespace {

bool excluded(const Frustum& frustum, const Aabb& box) {
  return std::ranges::any_of(frustum.span(),
                             [&](const Plane& plane) { return surely_outside(plane, box); });
}

class HalfTurn : public WrongRule {
 public:
  void build(const Scene& scene) override { motion_.resize(scene.object_count()); }
  void reset() override { motion_.forget(); }
  void update(const Frame&, const Changes& changes) override {
    for (const ObjectId object : changes.moved) motion_.forget(object);
  }
  void start(const Frame& frame) override {
    frustum_ = frustum_of(frame.camera);
    motion_.start(frame.camera, frustum_);
  }
  bool culls(ObjectId object, const Frame& frame) override {
    if (motion_.still_outside(object)) return true;
    const Aabb& box = frame.objects.bounds[object];
    for (int i = 0; i < frustum_.plane_count; ++i) {
      const Plane& plane = frustum_.planes[static_cast<std::size_t>(i)];
      if (!surely_outside(plane, box)) continue;
      motion_.remember(object, i, plane.signed_distance(p_vertex(plane, box)), box);
      return true;
    }
    return false;
  }

 private:
  MotionCoherence motion_{MotionCoherence::Premise::half_turn};
  Frustum frustum_;
};

class FixedRoot : public WrongRule {
 public:
  void build(const Scene& scene) override { root_ = scene.bounds(); }
  void start(const Frame& frame) override {
    frustum_ = frustum_of(frame.camera);
    root_outside_ = excluded(frustum_, root_);
  }
  bool culls(ObjectId object, const Frame& frame) override {
    return root_outside_ || excluded(frustum_, frame.objects.bounds[object]);
  }

 private:
  Aabb root_;
  Frustum frustum_;
  bool root_outside_ = false;
};

class StaleBounds : public WrongRule {
 public:
  void build(const Scene& scene) override {
    bounds_.clear();
    for (const Object& object : scene.objects) {
      bounds_.push_back(transformed(scene.meshes[object.mesh].bounds, object.transform));
    }
  }
  void start(const Frame& frame) override { frustum_ = frustum_of(frame.camera); }
  bool culls(ObjectId object, const Frame&) override { return excluded(frustum_, bounds_[object]); }

 private:
  std::vector<Aabb> bounds_;  // as built
  Frustum frustum_;
};

/// Parents are boxes around up to eight neighbours, made smaller about their middles.
class SmallParents : public WrongRule {
 public:
  explicit SmallParents(double too_small) : share_(std::max(0.0, 1.0 - too_small)) {}

  void build(const Scene& scene) override {
    std::vector<glm::dvec3> centers;
    std::vector<ObjectId> order;
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      const glm::dmat4x3& transform = scene.objects[object].transform;
      centers.push_back(transformed(scene.mesh_of(object).bounds, transform).center());
      order.push_back(object);
    }
    parent_of_.resize(order.size());
    parents_ = 0;
    split(order, centers);
    boxes_.resize(parents_);
    sides_.resize(parents_);
  }

  void start(const Frame& frame) override {
    frustum_ = frustum_of(frame.camera);
    std::ranges::fill(boxes_, Aabb{});
    for (ObjectId object = 0; object < parent_of_.size(); ++object) {
      boxes_[parent_of_[object]].extend(frame.objects.bounds[object]);
    }
    for (std::size_t i = 0; i < parents_; ++i) {
      const glm::dvec3 center = boxes_[i].center();
      const glm::dvec3 half = boxes_[i].half_size() * share_;
      const Aabb small{glm::vec3(center - half), glm::vec3(center + half)};
      const bool inside = std::ranges::all_of(
          frustum_.span(), [&](const Plane& plane) { return surely_inside(plane, small); });
      sides_[i] = excluded(frustum_, small) ? Side::outside
                  : inside                  ? Side::inside
                                            : Side::intersecting;
    }
  }

  bool culls(ObjectId object, const Frame& frame) override {
    const Side side = sides_[parent_of_[object]];
    if (side != Side::intersecting) return side == Side::outside;
    return excluded(frustum_, frame.objects.bounds[object]);
  }

 private:
  enum class Side : std::uint8_t { outside, intersecting, inside };

  void split(std::span<ObjectId> objects, const std::vector<glm::dvec3>& centers) {
    if (objects.size() <= 8) {
      for (const ObjectId object : objects) parent_of_[object] = parents_;
      ++parents_;
      return;
    }
    glm::dvec3 low = centers[objects.front()];
    glm::dvec3 high = low;
    for (const ObjectId object : objects) {
      low = glm::min(low, centers[object]);
      high = glm::max(high, centers[object]);
    }
    const glm::dvec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    std::ranges::sort(objects, [&](ObjectId a, ObjectId b) {
      return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
    });
    split(objects.first(objects.size() / 2), centers);
    split(objects.subspan(objects.size() / 2), centers);
  }

  double share_;
  std::vector<std::uint32_t> parent_of_;  // by object
  std::uint32_t parents_ = 0;
  std::vector<Aabb> boxes_;
  std::vector<Side> sides_;
  Frustum frustum_;
};

/// A list in which the last object takes the place of one that is removed, but is not told so.
class DropsOnRemove : public WrongRule {
 public:
  void build(const Scene& scene) override {
    listed_.resize(scene.object_count());
    place_.resize(scene.object_count());
    list_.reserve(2 * scene.object_count());
    reset();
  }
  void reset() override {
    list_.resize(place_.size());
    for (ObjectId object = 0; object < place_.size(); ++object) {
      list_[object] = object;
      place_[object] = object;
    }
  }
  void update(const Frame&, const Changes& changes) override {
    for (const ObjectId object : changes.hidden) {
      const std::uint32_t place = place_[object];
      if (place >= list_.size()) continue;
      list_[place] = list_.back();
      list_.pop_back();
    }
    for (const ObjectId object : changes.shown) {
      place_[object] = static_cast<std::uint32_t>(list_.size());
      list_.push_back(object);
    }
  }
  void start(const Frame& frame) override {
    frustum_ = frustum_of(frame.camera);
    listed_.clear();
    for (const ObjectId object : list_) listed_.insert(object);
  }
  bool culls(ObjectId object, const Frame& frame) override {
    return !listed_.contains(object) || excluded(frustum_, frame.objects.bounds[object]);
  }

 private:
  std::vector<ObjectId> list_;
  std::vector<std::uint32_t> place_;  // by object: where it was put
  ObjectStamps listed_;
  Frustum frustum_;
};

}  // namespace

std::unique_ptr<WrongRule> half_turn(double) { return std::make_unique<HalfTurn>(); }
std::unique_ptr<WrongRule> fixed_root(double) { return std::make_unique<FixedRoot>(); }
std::unique_ptr<WrongRule> stale_bounds(double) { return std::make_unique<StaleBounds>(); }
std::unique_ptr<WrongRule> small_parents(double amount) {
  return std::make_unique<SmallParents>(amount);
}
std::unique_ptr<WrongRule> drops_on_remove(double) { return std::make_unique<DropsOnRemove>(); }

}  // namespace vislab::frustum_culling
