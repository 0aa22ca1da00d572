// One lens for all poses of a path: what the description says, and the rest fitted to the scene.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"
#include "common/scene/settings.h"

namespace vislab {

struct LensWishes {
  double fov_deg = 60.0;  // the full vertical angle of a window that is not shifted
  std::optional<double>
      orthographic_height_m;            // an orthographic lens instead, whose image is so high
  double asymmetry = 0.0;               // the window lies this share of its width to the right
  std::optional<double> near_m, far_m;  // fitted if absent; far_m may be infinite
};

/// The keys `fov_deg` (1 to 179) or `orthographic_height_m`, `asymmetry` (-0.5 to 0.5), `near_m`,
/// `far_m` (inf: no far plane; perspective only). Throws InputError.
LensWishes read_lens_wishes(const Settings& path);

/// Unless given, the far plane is behind everything in `box`; the near plane is at no more than
/// half the smallest distance of an eye from it, so near that the image's corners cannot see past
/// it, or, for eyes inside, at a thousandth of the farthest distance: nearer, a depth buffer of 32
/// bits no longer tells apart what rays do. Throws InputError if the near plane is not before the
/// far plane.
Lens fitted_lens(const LensWishes& wishes, const std::vector<Pose>& poses, const Aabb& box,
                 double aspect);

}  // namespace vislab
