// The lab's "test mode" as a picture: what a culler kept and left out in one frame, seen from the
// eye and from outside, where the view frustum stays frozen.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/render/png.h"
#include "common/scene/frame.h"

namespace vislab {

enum class TriangleClass : std::uint8_t {
  kept_visible,
  kept_invisible,
  culled_rightly,
  culled_wrongly,  // visible, but left out
};
inline constexpr std::size_t triangle_class_count = 4;

struct PictureInput {
  const Scene* scene = nullptr;
  const Frame* frame = nullptr;
  /// By TriangleId, scene->triangle_count() of them. A culler of whole objects gives all triangles
  /// of an object the same class.
  std::span<const TriangleClass> classes;
  std::string title;                                         // scene, culler, frame
  std::array<std::uint64_t, triangle_class_count> counts{};  // for the legend
  std::string counted = "objects";                           // what the counts count
  /// How many of those culled wrongly the judge excuses, all their lost samples being disputed.
  std::uint64_t excused = 0;
  /// Pixels that the culler spoilt; (0, 0) is the lower left one. If there are any, the place where
  /// most of them are is framed and shown eight times enlarged.
  std::vector<glm::ivec2> wrong_pixels;
};

/// Colours differ in hue for every kind of colour vision and in lightness for print. Left: the
/// whole scene from the frame's camera, at the frame's resolution, coloured by class. Right: from
/// outside, back faces left away so that rooms are looked into, things rightly culled in a dim
/// tone. Hidden objects are not drawn. Throws std::logic_error if the input does not fit together.
/// O(triangles) time; memory for 65,536 triangles and the pictures.
Image render_picture(const PictureInput& input);

}  // namespace vislab
