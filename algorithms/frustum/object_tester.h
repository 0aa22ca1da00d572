// The tests of single objects by their bounding volumes, as a parameter of every frustum culler.
#pragma once

#include <optional>
#include <vector>

#include "algorithms/frustum/frustum_tester.h"

namespace vislab::frustum_culling {

struct ObjectTestOptions {
  enum class Test { vertex, corners, sphere, obb, dual, exact };
  enum class SphereKind { box, farthest, ritter };

  Test test = Test::vertex;
  SphereKind sphere = SphereKind::box;  // for Test::sphere and Test::dual
  bool refine = false;                  // what intersects is asked again by the exact test
};

/// The declarations of `test` and `sphere`, and of `intersecting` for cullers without a hierarchy
/// (trees say by a parameter of that name what becomes of objects in intersecting nodes).
std::vector<ParameterSpec> object_test_parameters();
ParameterSpec object_intersecting_parameter();
/// `refine` is only read where `refinable`.
ObjectTestOptions read_object_test(const ParameterValues& values, bool refinable);

/// Bounding volumes of all objects in the world, and their test against the frustum.
///
/// Tests: `vertex` is FrustumTester::outside (the world box by its p-vertices; the switches apply
/// to it alone), `corners` looks at all eight corners, `sphere` at a sphere around the box, through
/// the farthest vertex of the mesh, or Ritter's, `obb` at Gottschalk's box, `dual` at the sphere
/// first and at that box only if the sphere intersects (Chang 2008), `exact` at the separating axes
/// of frustum and world box. Guarantee: conservative. Objects whose world box is not valid are
/// kept. Cost: at most 6 planes and 27 axes an object. Memory: 16 bytes an object for spheres, 96
/// for oriented boxes; none for the others.
class ObjectTester {
 public:
  explicit ObjectTester(const ObjectTestOptions& options) : options_(options) {}

  /// Volumes of the scene as built. The scene outlives the tester.
  void build(const Scene& scene);
  /// Back to the scene as built. O(objects) if there are volumes.
  void reset();
  /// Follows moved objects. O(moved).
  void update(const Frame& frame, const Changes& changes);
  /// Once a frame (or a call of cull()), after FrustumTester::start().
  void start(const Frame& frame);

  /// Is the object to be kept? `slot` and `mask` are as in FrustumTester: only planes of the mask
  /// are looked at.
  bool keeps(ObjectId object, const Frame& frame, FrustumTester& tester, std::uint32_t slot,
             PlaneMask mask) {
    const Aabb& box = frame.objects.bounds[object];
    if (options_.test == ObjectTestOptions::Test::vertex && !options_.refine) {
      return !tester.outside(box, slot, mask);
    }
    return keeps_by_volume(object, box, tester, slot, mask);
  }

  /// Planes that volumes were compared with (those of `vertex` are counted by the FrustumTester).
  std::uint64_t plane_tests() const { return plane_tests_; }
  /// Planes and axes that the exact test looked at.
  std::uint64_t axes_tested() const { return axes_tested_; }
  std::size_t bytes() const;
  /// Appends FrustumTester's and its own counters; plane_tests is the sum.
  void append_counters(const FrustumTester& tester, Counters& counters) const;

 private:
  bool keeps_by_volume(ObjectId object, const Aabb& box, FrustumTester& tester, std::uint32_t slot,
                       PlaneMask mask);
  Side side_by_volume(ObjectId object, const Aabb& box, FrustumTester& tester, std::uint32_t slot,
                      PlaneMask mask);
  template <typename SideOfPlane>
  Side side_of_planes(PlaneMask mask, SideOfPlane&& side_of_plane);
  Side side_of_sphere(ObjectId object, PlaneMask mask);
  Side side_of_oriented(ObjectId object, PlaneMask mask);
  void place(ObjectId object, const glm::dmat4x3& transform, const Aabb& box);

  ObjectTestOptions options_;
  const Scene* scene_ = nullptr;
  std::vector<Sphere> mesh_spheres_;     // by mesh, its frame
  std::vector<OrientedBox> mesh_boxes_;  // by mesh, its frame
  std::vector<Sphere> spheres_;          // by object, world frame, as it lies now
  std::vector<OrientedBox> boxes_;       // the same
  Frustum frustum_;
  std::optional<ExactFrustum> exact_;
  std::uint64_t plane_tests_ = 0;
  std::uint64_t axes_tested_ = 0;
};

}  // namespace vislab::frustum_culling
