// Where to look from to see what a camera sees, and the lines of its frustum.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/render/picture.h"

namespace vislab {

struct OutsideView {
  Camera camera;
  double frustum_depth = 0.0;  // how far the frustum is drawn, metres along the view
};

/// A camera behind, above and to the right of the frame's eye that sees the eye, what is visible
/// and some of what lies around it. `aspect` is width / height of the picture. O(triangles).
OutsideView fit_outside_view(const PictureInput& input, double aspect);

/// A part of a line from window position `from` to `to` (pixels, y down), as the camera sees it.
struct WindowLine {
  glm::dvec2 from;
  glm::dvec2 to;
};

/// Projects the segment between two world points; false if it lies wholly behind the camera.
bool project_line(const Camera& camera, const Viewport& viewport, const glm::dvec3& from,
                  const glm::dvec3& to, WindowLine& line);

/// Edges of the frustum of `camera` from the eye (for parallel projection: from the near plane) to
/// `depth`, its outline there, and another one near the eye, which shows which way it looks.
std::vector<std::array<glm::dvec3, 2>> frustum_edges(const Camera& camera, double depth);

}  // namespace vislab
