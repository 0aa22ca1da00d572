// Images of hidden-surface algorithms beside the truth's: who owns each pixel, and where that is
// wrong.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/render/png.h"
#include "common/scene/frame.h"

namespace vislab {

/// One image of a surface picture.
struct SurfacePanel {
  std::string caption;
  std::string note;                     // below the caption
  std::span<const TriangleId> owners;   // row by row from the bottom; none_id = background
  std::span<const std::uint8_t> wrong;  // by pixel, not 0 where it is marked; may be empty: none is
};

/// All panels in rows of four at most, pixels enlarged to whole squares where the images are
/// small. Objects differ by hue, their triangles by lightness; wrong pixels are vermillion, which
/// no object is. Throws std::logic_error if sizes do not fit together.
Image render_surface_picture(const Scene& scene, const Viewport& viewport, const std::string& title,
                             std::span<const SurfacePanel> panels);

}  // namespace vislab
