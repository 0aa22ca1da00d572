// The box test that all frustum cullers with a scalar path share, with the accelerations of the
// literature as switches.
#pragma once

#include <cstdint>
#include <vector>

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
  bool octant = false;            // small volumes: only the three outer planes of their octant
  Meta meta = Meta::off;          // a sphere or a box around the frustum is asked first
};

/// The declarations of the switches as query parameters of a culler, and their values.
std::vector<ParameterSpec> switch_parameters();
Switches read_switches(const ParameterValues& values);

class FrustumTester {
 public:
  explicit FrustumTester(const Switches& switches) : switches_(switches) {}

  /// Memory for coherence: boxes are known by slots below `slots` (a node or an object each).
  void resize(std::size_t slots);
  /// Forgets the past (reset of a culler). A slot whose box changed must be forgotten too.
  void forget();
  void forget(std::uint32_t slot);

  /// Once a frame.
  void start(const Frame& frame);
  const Frustum& frustum() const;
  PlaneMask all_planes() const;

  /// n-/p-vertex test. `mask`: the planes that are still to be tested; on return those that the box
  /// is not surely inside of (for the children). With masking off, all planes are always tested.
  Side side(const Aabb& box, std::uint32_t slot, PlaneMask& mask);

  std::uint64_t plane_tests() const;
  std::uint64_t skipped_tests() const;  // boxes decided without any plane test

 private:
  Switches switches_;
  // The author of frustum_tester.cpp completes this.
};

}  // namespace vislab::frustum_culling
