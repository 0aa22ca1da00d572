// Rotation and translation coherence: which boxes stay outside of the frustum because of how the
// camera moved since they were tested.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/frustum.h"

namespace vislab::frustum_culling {

/// Idea: a box that was found outside of a side plane stays outside of the frustum
///   - while the camera only rotates away from that plane, about its own up (left and right plane)
///     or its own right (bottom and top), by less than 180 degrees - fov in all: every direction
///     behind the plane is then behind it still or behind the plane on the other side;
///   - while the camera only translates and the box's distance to the plane, which changes by
///     -n.t, stays negative.
///   Everything else (another lens, both at once, a rotation about another axis) forgets all boxes.
/// Guarantee: no point of a box that is said to be outside is in the frustum. It may be that no
///   single plane excludes the box any more. Only boxes that were outside by a comfortable margin
///   are remembered, so that rounding, and camera axes that are orthonormal only to rounding, do
///   not count.
/// Cost: 32 bytes a box. O(1) a frame and a box.
/// Limits: useless for cameras that rotate and translate at once. A moved box has to be forgotten.
/// Source: Assarsson and Moeller 2000; Kowalka 2016, 3.2.2, whose premise "less than 180 degrees"
/// is
///   wrong.
class MotionCoherence {
 public:
  /// How far a rotation may go: `sound` is 180 degrees - fov; `half_turn` is what the thesis says,
  /// 180 degrees, for the negative control.
  enum class Premise { sound, half_turn };

  explicit MotionCoherence(Premise premise = Premise::sound) : premise_(premise) {}

  /// Room for boxes with slots below `slots`; what is known of the others is kept.
  void resize(std::size_t slots);
  /// Forgets all boxes, or one. O(1).
  void forget();
  void forget(std::uint32_t slot) { memory_[slot].tested_at = 0; }

  /// Once a frame, or oftener: where the camera is now. `frustum` is that of `camera`.
  void start(const Camera& camera, const Frustum& frustum);

  /// The box of this slot is outside of the frustum, for what is known of it.
  bool still_outside(std::uint32_t slot) const;

  /// The box of this slot is valid and was found outside of plane `plane` just now; `distance` is
  /// that of its p-vertex.
  void remember(std::uint32_t slot, int plane, double distance, const Aabb& box);

  std::size_t bytes() const { return memory_.capacity() * sizeof(Memory); }

 private:
  struct Memory {
    double translated = 0.0;      // outside while this is below the plane's shift
    double angle = 0.0;           // how far the camera was turned when the box was tested
    std::uint64_t tested_at = 0;  // 0: nothing is known
    std::uint8_t plane = 0;
  };
  /// A rotation about one axis of the camera, gone on with since the frame `since`.
  struct Rotation {
    std::uint64_t since = 0;
    Pose reference;      // at that frame
    double angle = 0.0;  // since then, radians; counter-clockwise about the axis
    double limit = 0.0;  // what may be turned away from a plane in all, radians
  };

  void restart_translation(const Camera& camera);
  void restart(Rotation& rotation, const Camera& camera);
  bool continues_yaw(const Pose& now);
  bool continues_pitch(const Pose& now);

  Premise premise_;
  std::vector<Memory> memory_;
  std::uint64_t now_ = 0;  // counts calls of start()
  bool started_ = false;
  Camera camera_;  // of the last start()
  Frustum frustum_;
  Rotation yaw_, pitch_;
  std::uint64_t translating_since_ = 0;
  glm::dvec3 translation_reference_{0.0};  // the eye at that frame
  double travel_ = 0.0;                    // farthest from it since then
  std::array<double, 6> shift_{};          // n.t since then, by plane
};

}  // namespace vislab::frustum_culling
