#include "algorithms/frustum/object_tester.h"

#include <bit>

#include "common/geometry/bounding_spheres.h"
#include "common/scene/used_positions.h"

namespace vislab::frustum_culling {
namespace {

using Test = ObjectTestOptions::Test;
using SphereKind = ObjectTestOptions::SphereKind;

bool has_spheres(const ObjectTestOptions& options) {
  return options.test == Test::sphere || options.test == Test::dual;
}

bool has_boxes(const ObjectTestOptions& options) {
  return options.test == Test::obb || options.test == Test::dual;
}

bool has_exact(const ObjectTestOptions& options) {
  return options.test == Test::exact || options.refine;
}

}  // namespace

std::vector<ParameterSpec> object_test_parameters() {
  const auto build = ParameterSpec::Stage::build;
  return {
      ParameterSpec::choice(
          "test", "vertex", {"vertex", "corners", "sphere", "obb", "dual", "exact"}, build,
          "how an object is tested: its box by the p-vertex of each plane, or by all corners; a "
          "sphere; an oriented box; the sphere and, where it intersects, the oriented box; or the "
          "box by all separating axes, which alone keeps nothing that is outside"),
      ParameterSpec::choice("sphere", "box", {"box", "farthest", "ritter"}, build,
                            "which sphere for test=sphere and test=dual: around the world box, "
                            "around the mesh through "
                            "its farthest vertex, or Ritter's; looser ones keep more")};
}

ParameterSpec object_intersecting_parameter() {
  return ParameterSpec::choice("intersecting", "keep", {"keep", "refine"},
                               ParameterSpec::Stage::query,
                               "volumes that are neither inside nor outside of the planes are "
                               "kept, or their boxes are asked "
                               "again by all separating axes");
}

ObjectTestOptions read_object_test(const ParameterValues& values, bool refinable) {
  ObjectTestOptions options;
  const std::string& test = values.choice("test");
  if (test == "corners") options.test = Test::corners;
  if (test == "sphere") options.test = Test::sphere;
  if (test == "obb") options.test = Test::obb;
  if (test == "dual") options.test = Test::dual;
  if (test == "exact") options.test = Test::exact;
  const std::string& sphere = values.choice("sphere");
  if (sphere == "farthest") options.sphere = SphereKind::farthest;
  if (sphere == "ritter") options.sphere = SphereKind::ritter;
  options.refine = refinable && values.choice("intersecting") == "refine";
  return options;
}

void ObjectTester::build(const Scene& scene) {
  scene_ = &scene;
  mesh_spheres_.clear();
  mesh_boxes_.clear();
  const bool mesh_spheres = has_spheres(options_) && options_.sphere != SphereKind::box;
  if (mesh_spheres || has_boxes(options_)) {
    for (const Mesh& mesh : scene.meshes) {
      const std::vector<glm::vec3> points = used_positions(mesh);
      if (mesh_spheres) {
        mesh_spheres_.push_back(options_.sphere == SphereKind::ritter
                                    ? ritter_sphere(points)
                                    : farthest_point_sphere(points));
      }
      if (has_boxes(options_)) mesh_boxes_.push_back(covariance_box(points));
    }
  }
  if (has_spheres(options_)) spheres_.resize(scene.object_count());
  if (has_boxes(options_)) boxes_.resize(scene.object_count());
  reset();
}

void ObjectTester::reset() {
  if (spheres_.empty() && boxes_.empty()) return;
  for (ObjectId object = 0; object < scene_->object_count(); ++object) {
    const glm::dmat4x3& transform = scene_->objects[object].transform;
    place(object, transform, transformed(scene_->mesh_of(object).bounds, transform));
  }
}

void ObjectTester::update(const Frame& frame, const Changes& changes) {
  if (spheres_.empty() && boxes_.empty()) return;
  for (const ObjectId object : changes.moved) {
    place(object, frame.objects.transforms[object], frame.objects.bounds[object]);
  }
}

void ObjectTester::place(ObjectId object, const glm::dmat4x3& transform, const Aabb& box) {
  const MeshId mesh = scene_->objects[object].mesh;
  if (!spheres_.empty()) {
    spheres_[object] = options_.sphere == SphereKind::box
                           ? circumscribed(box)
                           : transformed(mesh_spheres_[mesh], transform);
  }
  if (!boxes_.empty()) boxes_[object] = transformed(mesh_boxes_[mesh], transform);
}

void ObjectTester::start(const Frame& frame) {
  frustum_ = frustum_of(frame.camera);
  if (has_exact(options_)) exact_.emplace(frame.camera);
}

template <typename SideOfPlane>
Side ObjectTester::side_of_planes(PlaneMask mask, SideOfPlane&& side_of_plane) {
  Side side = Side::inside;
  for (PlaneMask rest = mask; rest != 0; rest &= rest - 1U) {
    ++plane_tests_;
    const auto i = static_cast<std::size_t>(std::countr_zero(rest));
    const Side of_plane = side_of_plane(frustum_.planes[i]);
    if (of_plane == Side::outside) return Side::outside;
    if (of_plane == Side::intersecting) side = Side::intersecting;
  }
  return side;
}

Side ObjectTester::side_of_sphere(ObjectId object, PlaneMask mask) {
  const Sphere& sphere = spheres_[object];
  return side_of_planes(mask, [&](const Plane& plane) { return side_of(plane, sphere); });
}

Side ObjectTester::side_of_oriented(ObjectId object, PlaneMask mask) {
  const OrientedBox& box = boxes_[object];
  return side_of_planes(mask, [&](const Plane& plane) { return side_of(plane, box); });
}

Side ObjectTester::side_by_volume(ObjectId object, const Aabb& box, FrustumTester& tester,
                                  std::uint32_t slot, PlaneMask mask) {
  switch (options_.test) {
    case Test::vertex:
      return tester.outside(box, slot, mask) ? Side::outside : Side::intersecting;
    case Test::corners:
      return side_of_planes(mask, [&](const Plane& plane) { return side_by_corners(plane, box); });
    case Test::sphere:
      return side_of_sphere(object, mask);
    case Test::obb:
      return side_of_oriented(object, mask);
    case Test::dual: {
      const Side side = side_of_sphere(object, mask);
      return side == Side::intersecting ? side_of_oriented(object, mask) : side;
    }
    case Test::exact:
      return exact_->side(box, &axes_tested_);
  }
  return Side::intersecting;
}

bool ObjectTester::keeps_by_volume(ObjectId object, const Aabb& box, FrustumTester& tester,
                                   std::uint32_t slot, PlaneMask mask) {
  if (!box.valid()) return true;
  if (!tester.switches().masking) mask = tester.all_planes();
  const Side side = side_by_volume(object, box, tester, slot, mask);
  if (side != Side::intersecting) return side == Side::inside;
  if (!options_.refine || options_.test == Test::exact) return true;
  return exact_->side(box, &axes_tested_) != Side::outside;
}

std::size_t ObjectTester::bytes() const {
  return mesh_spheres_.capacity() * sizeof(Sphere) + mesh_boxes_.capacity() * sizeof(OrientedBox) +
         spheres_.capacity() * sizeof(Sphere) + boxes_.capacity() * sizeof(OrientedBox);
}

void ObjectTester::append_counters(const FrustumTester& tester, Counters& counters) const {
  const std::size_t first = counters.size();
  tester.append_counters(counters);
  counters[first].second += plane_tests_;
  if (has_exact(options_)) counters.emplace_back("axes_tested", axes_tested_);
}

}  // namespace vislab::frustum_culling
