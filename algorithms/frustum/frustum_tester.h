// The box test that all frustum cullers with a scalar path share, with the accelerations of the
// literature as switches.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "algorithms/frustum/meta_volumes.h"
#include "algorithms/frustum/motion_coherence.h"
#include "common/culler/culler.h"
#include "common/geometry/frustum_side.h"

namespace vislab::frustum_culling {

/// Bit i is set if plane i of the frustum still has to be tested.
using PlaneMask = std::uint8_t;

/// What is skipped to save plane tests. Each can be switched alone; none makes the test less
/// conservative.
struct Switches {
  enum class Meta { off, sphere, box };

  bool masking = true;            // planes that the parent is inside of are not tested again
  bool plane_coherence = false;   // the plane that excluded the box last time goes first
  bool motion_coherence = false;  // rotations and translations away from that plane need no test
  bool octant = false;            // only the nearer plane of each opposite pair is tested
  Meta meta = Meta::off;          // a sphere or a box around the frustum is asked first

  /// All but masking are off: nothing is remembered and only planes are tested.
  bool plain() const {
    return !plane_coherence && !motion_coherence && !octant && meta == Meta::off;
  }
  /// With motion coherence the answer depends on the path: a box that reaches around behind the
  /// camera stays out although no single plane excludes it any more.
  Repeatability repeatability() const {
    return motion_coherence ? Repeatability::path : Repeatability::stateless;
  }
};

/// The declarations of the switches as query parameters of a culler, and their values. Without a
/// hierarchy there is nothing to mask.
std::vector<ParameterSpec> switch_parameters(bool hierarchy = true);
Switches read_switches(const ParameterValues& values);

/// n-/p-vertex tests of boxes against the planes of one frame's frustum.
///
/// Answers: an object is outside exactly if `surely_outside(plane, box)` holds for a plane of
/// frustum_of(camera). A node is outside only if that is so for every box inside it, and a plane is
/// masked only if it is so for none. Masking, plane coherence and the octant test do not change any
/// answer about objects; meta volumes and motion coherence find more of what is outside.
///
/// Guarantee: conservative under rounding with every switch.
/// Cost: at most 6 planes, one distance each for an object and two for a node. No memory, but 1
/// byte a slot for plane coherence and 32 for motion coherence. Limits: what is outside of the
/// frustum, but of none of its planes, is kept, unless meta volumes find it. Sources: Assarsson and
/// Moeller 2000; Kowalka 2016, 3.2.2; Zachmann slides 37-41.
class FrustumTester {
 public:
  explicit FrustumTester(const Switches& switches) : switches_(switches) {}

  const Switches& switches() const { return switches_; }

  /// Memory for coherence: boxes are known by slots below `slots` (a node or an object each). What
  /// is remembered of slots that were there before stays. No memory if nothing is to be remembered.
  void resize(std::size_t slots);
  /// Forgets the past (reset of a culler). O(slots).
  void forget();
  /// A slot whose box changed must be forgotten. O(1).
  void forget(std::uint32_t slot);
  /// Boxes changed, no matter which (nodes of a tree that was refitted). O(1).
  void forget_motion() { motion_.forget(); }
  std::size_t bytes() const { return last_plane_.capacity() + motion_.bytes(); }

  /// Once a frame (or a call of cull()). O(1).
  void start(const Frame& frame);
  const Frustum& frustum() const { return frustum_; }
  PlaneMask all_planes() const { return all_planes_; }

  /// A node. `mask`: the planes that are still to be tested; on return those that the box is not
  /// surely inside of (for the children), empty exactly if the answer is `inside`. With masking
  /// off, all planes are always tested. A box that is not valid is intersecting.
  Side side(const Aabb& box, std::uint32_t slot, PlaneMask& mask);

  /// A single object: the definition. It is not asked whether the object is inside, which saves
  /// half of the distances.
  bool outside(const Aabb& box, std::uint32_t slot, PlaneMask mask);

  /// n-/p-vertex tests of boxes against planes.
  std::uint64_t plane_tests() const { return plane_tests_; }
  /// Boxes decided without any plane test, by meta volumes or motion coherence.
  std::uint64_t skipped_tests() const { return skipped_tests_; }
  /// Appends the counters that belong to the switches in use.
  void append_counters(Counters& counters) const;

 private:
  /// A plane of this frame with the choice of the n- and p-vertex made.
  struct TestPlane {
    glm::dvec3 normal{0.0};
    double d = 0.0;
    double error = 0.0;                    // share of the margin that does not depend on the box
    std::array<std::uint8_t, 3> p{}, n{};  // where the vertices' coordinates stand in Corners
  };
  struct Corners;
  struct Octant;

  bool decided_early(const Aabb& box, std::uint32_t slot);
  Octant octant_of(const Corners& corners, PlaneMask mask, PlaneMask rest);
  void remember(std::uint32_t slot, std::size_t plane, const Aabb& box);
  template <typename Excluded>
  bool last_plane_excludes(std::uint32_t slot, PlaneMask& rest, Excluded&& excluded);
  Side side_switched(const Aabb& box, std::uint32_t slot, PlaneMask& mask);
  bool outside_switched(const Aabb& box, std::uint32_t slot, PlaneMask mask);

  Switches switches_;
  std::vector<std::uint8_t> last_plane_;  // by slot: the plane that excluded the box last
  MotionCoherence motion_;
  MetaVolumes meta_;
  Frustum frustum_;
  PlaneMask all_planes_ = 0;
  std::array<TestPlane, 6> planes_;
  /// By pair of opposite planes: distance to the second minus distance to the first.
  std::array<TestPlane, 3> middles_;
  double eye_to_near_m_ = 0.0;  // by perspective cameras only; else infinite
  std::uint64_t plane_tests_ = 0;
  std::uint64_t skipped_tests_ = 0;
  std::uint64_t octant_tests_ = 0;  // distances to middle planes, computed to save plane tests
};

}  // namespace vislab::frustum_culling
