// A frame from outside, every triangle in the colour of the kind of culling that leaves it out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "common/render/png.h"
#include "common/scene/frame.h"

namespace vislab {

/// Why a triangle need not be drawn: the five kinds of culling. A triangle that several leave out
/// is counted for the first of them.
enum class CullingKind : std::uint8_t {
  drawn,
  view_frustum,  // outside of what the camera can see
  portal,        // behind doors and windows that the view does not go through
  back_face,     // on the far side of its own object
  occlusion,     // behind something else
  detail,        // in sight, but so small that an approximate method leaves it out
};
inline constexpr std::size_t culling_kind_count = 6;

struct KindsPictureInput {
  const Scene* scene = nullptr;
  const Frame* frame = nullptr;
  std::span<const CullingKind> kinds;  // by TriangleId, scene->triangle_count() of them
  std::string title;                   // scene, path, frame
  /// By kind: what stands in the legend behind its name.
  std::array<std::string, culling_kind_count> notes;
};

/// The scene from above and ahead of the eye, so that backs are seen, with the eye and its frustum;
/// what lies above the eye in scenes with cells is left away, so that rooms are looked into. Beside
/// it the frame from the eye, and a legend. Colours are those of Okabe and Ito (2008). Hidden
/// objects are not drawn. Throws std::logic_error if the input does not fit together. O(triangles).
Image render_kinds_picture(const KindsPictureInput& input);

}  // namespace vislab
