#include "common/raster/box_window.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/rounding.h"
#include "common/raster/margins.h"

namespace vislab {
namespace {

/// Do all corners surely lie beyond one and the same side of the image? Also for corners behind the
/// eye.
bool beyond_a_side(const WindowTransform& window, const std::array<WindowPoint, 8>& corners) {
  const double width = window.viewport().width, height = window.viewport().height;
  int left = 0, right = 0, below = 0, above = 0;
  for (const WindowPoint& corner : corners) {
    const double w = window.perspective() ? corner.depth : 1.0;
    const double error_x = rounding_margin * (std::abs(corner.x) + std::abs(width * w));
    const double error_y = rounding_margin * (std::abs(corner.y) + std::abs(height * w));
    left += corner.x < -error_x ? 1 : 0;
    right += corner.x - width * w > error_x ? 1 : 0;
    below += corner.y < -error_y ? 1 : 0;
    above += corner.y - height * w > error_y ? 1 : 0;
  }
  return left == 8 || right == 8 || below == 8 || above == 8;
}

}  // namespace

BoxPlace project_box(const WindowTransform& window, const Aabb& box, Coverage coverage,
                     BoxWindow& out) {
  if (!box.valid()) return BoxPlace::undecided;
  const Lens& lens = window.camera().lens;
  double least_x = INFINITY, least_y = INFINITY, greatest_x = -INFINITY, greatest_y = -INFINITY;
  double least_depth = INFINITY, greatest_depth = -INFINITY;
  std::array<WindowPoint, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] =
        window.world()({(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                        (i & 4) != 0 ? box.max.z : box.min.z});
    least_depth = std::min(least_depth, corners[i].depth);
    greatest_depth = std::max(greatest_depth, corners[i].depth);
  }
  const double depth_error = rounding_margin * (std::abs(least_depth) + std::abs(greatest_depth));
  if (greatest_depth + depth_error < lens.near_m) return BoxPlace::outside;
  const double least_seen = least_depth - depth_error;
  if (least_seen > lens.far_m) return BoxPlace::outside;
  if (!(least_seen > lens.near_m)) {
    return beyond_a_side(window, corners) ? BoxPlace::outside : BoxPlace::undecided;
  }
  for (const WindowPoint& corner : corners) {
    const double w = window.perspective() ? corner.depth : 1.0;
    const double x = corner.x / w;
    const double y = corner.y / w;
    least_x = std::min(least_x, x);
    greatest_x = std::max(greatest_x, x);
    least_y = std::min(least_y, y);
    greatest_y = std::max(greatest_y, y);
  }
  // A pixel's centre, or its far border if all of it counts.
  const double reach = coverage == Coverage::centres ? 0.5 : 1.0;
  const auto from = [&](double least) {
    return static_cast<int>(std::clamp(std::ceil(least - snapping_margin_px - reach), 0.0, 1e6));
  };
  const auto to = [&](double greatest, int size) {
    const double after = std::floor(greatest + snapping_margin_px + reach);
    return static_cast<int>(std::clamp(after, 0.0, static_cast<double>(size)));
  };
  out.x0 = from(least_x);
  out.y0 = from(least_y);
  out.x1 = to(greatest_x, window.viewport().width);
  out.y1 = to(greatest_y, window.viewport().height);
  if (out.x0 >= out.x1 || out.y0 >= out.y1) return BoxPlace::outside;
  const double nearest = window.nearness(least_seen);
  out.nearness = round_up(nearest + window.device_margin() + rounding_margin * std::abs(nearest));
  return BoxPlace::inside;
}

}  // namespace vislab
