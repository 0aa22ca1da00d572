// What moves, appears and disappears along a path, frame by frame.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "common/scene/frame.h"
#include "common/scene/scene.h"

namespace vislab {

/// Every object goes round a vertical axis, counter-clockwise seen from above, at its own speed,
/// and spins about an own axis through the middle of its mesh's box.
struct RevolveMotion {
  glm::dvec3 center{0.0};  // a point of the axis, world
  double min_speed_m_s = 1.0, max_speed_m_s = 10.0;
  double max_spin_deg_s = 90.0;  // spins are uniform from 0 to this
};

/// Some objects go along straight lines, in directions of their own, and turn back where the middle
/// of their box meets the border: the scene's box as built, times `border` about its centre.
struct DriftMotion {
  double share = 1.0;  // of the objects, above 0; at least one goes
  double min_speed_m_s = 1.0, max_speed_m_s = 10.0;
  double border = 1.0;
};

/// In every frame but the first, `count` objects are hidden, and those that were hidden in the
/// frame before are shown again. Which ones is dealt from one shuffled order, round and round.
/// Twice `count` may not be more than there are objects.
struct ChurnMotion {
  std::uint32_t count = 1;
};

/// Some objects move away from the centre of the scene's box as built, each along its own ray, at a
/// constant speed. At the end they are at `factor` times half the box's longest side from it, in
/// the largest of the three coordinates: beyond 1 they have left the cube about the scene.
struct DepartMotion {
  double share = 1.0;  // of the objects, above 0; at least one goes
  double factor = 2.0;
};

/// One object goes straight at a constant velocity, and turns back whenever it is reach_m from
/// where it was built.
struct SlideMotion {
  ObjectId object = 0;
  glm::dvec3 velocity_m_s{1.0, 0.0, 0.0};
  double reach_m = 1e6;
};

/// One object is hidden and shown in turn, so often a second; it is shown at first.
struct ToggleMotion {
  ObjectId object = 0;
  double toggles_per_s = 1.0;
};

struct Motion {
  std::variant<RevolveMotion, DriftMotion, ChurnMotion, DepartMotion, SlideMotion, ToggleMotion>
      kind;
  double duration_s = 2.0;  // from the path's beginning (u = 0) to its end (u = 1)
  std::uint64_t seed = 1;
};

/// More movements than these in a path (100 bytes each) are refused.
inline constexpr std::size_t max_path_moves = 20'000'000;

/// The changes before each frame of a path whose frames are taken at `times`, ascending in [0, 1].
/// At time 0 all is as built. Positions are functions of time, not sums of steps: a path that is
/// sampled more finely goes through the same. Objects whose transform stays the same are left out.
/// What an object does depends on the seed and its id. Throws InputError if there are more than
/// max_path_moves, too few objects for a churn, or no such object to slide or toggle. O(frames *
/// movers).
std::vector<Changes> changes_of(const Motion& motion, const Scene& scene,
                                const std::vector<double>& times);

/// Box of everything that is shown or hidden along a path with these changes: the scene's own box
/// and the boxes of moved objects.
Aabb reach_of(const Scene& scene, const std::vector<Changes>& changes);

}  // namespace vislab
