#include "common/scene/paths/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "common/scene/error.h"

namespace vislab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The lens but for its asymmetry.
Lens centred_lens(const LensWishes& wishes, double aspect, double near_m, double far_m) {
  if (wishes.orthographic_height_m) {
    return orthographic_lens(*wishes.orthographic_height_m, aspect, near_m, far_m);
  }
  return perspective_lens(wishes.fov_deg * std::numbers::pi / 180.0, aspect, near_m, far_m);
}

Lens lens_of(const LensWishes& wishes, double aspect, double near_m, double far_m) {
  Lens lens = centred_lens(wishes, aspect, near_m, far_m);
  const double shift = wishes.asymmetry * (lens.right - lens.left);
  lens.left += shift;
  lens.right += shift;
  return lens;
}

/// The farthest near plane whose corners are within `nearest` metres of the eye, and at most at
/// half of that; 0 if there is none.
double nearest_corners(const LensWishes& wishes, double aspect, double nearest) {
  const Lens unit = lens_of(wishes, aspect, 1.0, 2.0);
  const double corner = std::hypot(std::max(std::abs(unit.left), std::abs(unit.right)), unit.top);
  if (wishes.orthographic_height_m) {
    const double rest = nearest * nearest - corner * corner;
    return rest > 0.0 ? std::min(0.5 * nearest, 0.95 * std::sqrt(rest)) : 0.0;
  }
  return std::min(0.5, 0.95 / std::hypot(corner, 1.0)) * nearest;
}

}  // namespace

LensWishes read_lens_wishes(const Settings& path) {
  LensWishes wishes;
  if (path.has("orthographic_height_m")) {
    if (path.has("fov_deg")) {
      throw InputError(path.where() +
                       ": `fov_deg` is for perspective lenses; leave it out beside "
                       "`orthographic_height_m`");
    }
    wishes.orthographic_height_m = path.number("orthographic_height_m", 1e-9, 1e9);
  }
  wishes.fov_deg = path.number("fov_deg", 1.0, 179.0, wishes.fov_deg);
  wishes.asymmetry = path.number("asymmetry", -0.5, 0.5, wishes.asymmetry);
  if (path.has("near_m")) wishes.near_m = path.number("near_m", 1e-9, 1e12);
  if (path.has("far_m")) {
    wishes.far_m = path.number("far_m", 1e-9, infinity);
    if (wishes.orthographic_height_m && std::isinf(*wishes.far_m)) {
      throw InputError(path.where() + ": an orthographic lens needs a finite `far_m`");
    }
  }
  return wishes;
}

Lens fitted_lens(const LensWishes& wishes, const std::vector<Pose>& poses, const Aabb& box,
                 double aspect) {
  double nearest = infinity;
  double farthest = 0.0;
  for (const Pose& pose : poses) {
    nearest = std::min(nearest, std::sqrt(distance_squared(box, pose.eye)));
    farthest = std::max(farthest, glm::length(glm::abs(pose.eye - box.center()) + box.half_size()));
  }
  const double far_m = wishes.far_m.value_or(1.01 * farthest);
  const double reach_m = std::isinf(far_m) ? 1.01 * farthest : far_m;
  const double fitted_near = std::max(nearest_corners(wishes, aspect, nearest), 1e-3 * reach_m);
  const double near_m = wishes.near_m.value_or(std::min(fitted_near, 0.5 * reach_m));
  if (!(near_m < far_m)) {
    throw InputError("the near plane at " + std::to_string(near_m) +
                     " m must be nearer than the far plane at " + std::to_string(far_m) + " m");
  }
  return lens_of(wishes, aspect, near_m, far_m);
}

}  // namespace vislab
