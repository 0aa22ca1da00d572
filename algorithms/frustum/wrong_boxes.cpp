// Wrong tests of a box against the right frustum.

#include "algorithms/frustum/wrong_rules.h"
#include "common/geometry/frustum.h"

namespace vislab::frustum_culling {
namespace {

using WrongTest = bool (*)(const Frustum& frustum, const Aabb& box);

class WrongBoxTest : public WrongRule {
 public:
  explicit WrongBoxTest(WrongTest outside) : outside_(outside) {}
  void start(const Frame& frame) override { frustum_ = frustum_of(frame.camera); }
  bool culls(ObjectId object, const Frame& frame) override {
    return outside_(frustum_, frame.objects.bounds[object]);
  }

 private:
  WrongTest outside_;
  Frustum frustum_;
};

int corners_inside(const Frustum& frustum, const Aabb& box) {
  int inside = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1U) != 0 ? box.max.x : box.min.x,
                       (corner & 2U) != 0 ? box.max.y : box.min.y,
                       (corner & 4U) != 0 ? box.max.z : box.min.z);
    bool in_all = true;
    for (const Plane& plane : frustum.span()) in_all &= plane.signed_distance(p) >= 0.0;
    inside += in_all ? 1 : 0;
  }
  return inside;
}

bool outside_of_all(const Frustum& frustum, const Aabb& box) {
  for (const Plane& plane : frustum.span()) {
    if (!surely_outside(plane, box)) return false;
  }
  return true;
}

bool outside_by_n_vertex(const Frustum& frustum, const Aabb& box) {
  for (const Plane& plane : frustum.span()) {
    if (plane.signed_distance(n_vertex(plane, box)) < 0.0) return true;
  }
  return false;
}

/// A test of oriented boxes whose axes are made by dividing edges by their lengths. A flat box has
/// an edge without a length, and 0 / 0 is not a number.
class NormalisedAxes : public WrongRule {
 public:
  void build(const Scene& scene) override { scene_ = &scene; }
  void start(const Frame& frame) override { frustum_ = frustum_of(frame.camera); }
  bool culls(ObjectId object, const Frame& frame) override {
    const Aabb& box = scene_->mesh_of(object).bounds;
    const glm::dmat4x3& transform = frame.objects.transforms[object];
    const glm::dvec3 center = transform * glm::dvec4(box.center(), 1.0);
    const glm::dvec3 half = box.half_size();
    for (const Plane& plane : frustum_.span()) {
      double reach = 0.0;
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3 edge = transform[i] * half[i];
        const double length = glm::length(edge);
        reach += std::abs(glm::dot(plane.normal, edge / length)) * length;
      }
      const bool kept = plane.signed_distance(center) + reach >= 0.0;
      if (!kept) return true;
    }
    return false;
  }

 private:
  const Scene* scene_ = nullptr;
  Frustum frustum_;
};

}  // namespace

std::unique_ptr<WrongRule> behind_all_planes(double) {
  return std::make_unique<WrongBoxTest>(outside_of_all);
}

std::unique_ptr<WrongRule> all_corners_inside(double) {
  return std::make_unique<WrongBoxTest>(
      [](const Frustum& frustum, const Aabb& box) { return corners_inside(frustum, box) < 8; });
}

std::unique_ptr<WrongRule> any_corner_inside(double) {
  return std::make_unique<WrongBoxTest>(
      [](const Frustum& frustum, const Aabb& box) { return corners_inside(frustum, box) == 0; });
}

std::unique_ptr<WrongRule> outward_vertex(double) {
  return std::make_unique<WrongBoxTest>(outside_by_n_vertex);
}

std::unique_ptr<WrongRule> nan_outside(double) { return std::make_unique<NormalisedAxes>(); }

}  // namespace vislab::frustum_culling
