#include "common/raster/box_silhouette.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/rounding.h"
#include "common/raster/margins.h"
#include "common/raster/tile_queries.h"

namespace vislab {
namespace {

// Of a box's distance along an axis: what is nearer to the eye's plane is not divided by.
constexpr double least_distance = 1e-12;
constexpr double least_slope = 1e-6;  // of orthographic rays against a slab

}  // namespace

PixelRays::PixelRays(const WindowTransform& window, Coverage coverage)
    : perspective_(window.perspective()),
      eye_(window.camera().pose.eye),
      back_(window.camera().pose.back),
      reach_(coverage == Coverage::centres ? 0.0 : 0.5),
      device_margin_(round_up(window.device_margin())) {
  const auto& [eye, right, up, back] = window.camera().pose;
  const Lens& lens = window.camera().lens;
  const double scale = perspective_ ? 1.0 / lens.near_m : 1.0;
  const double pixel_x = scale * (lens.right - lens.left) / window.viewport().width;
  const double pixel_y = scale * (lens.top - lens.bottom) / window.viewport().height;
  step_x_ = right * pixel_x;
  step_y_ = up * pixel_y;
  start_ = right * (scale * lens.left) + up * (scale * lens.bottom) + (step_x_ + step_y_) * 0.5;
  if (perspective_) start_ -= back;
  pixel_m_ = std::max(pixel_x, pixel_y);
  least_depth_ = lens.near_m;
  greatest_depth_ = lens.far_m;
}

BoxPlanes PixelRays::planes_of(const Aabb& box) const {
  glm::dvec3 low = glm::dvec3(box.min) - eye_;
  glm::dvec3 high = glm::dvec3(box.max) - eye_;
  double grown = snapping_margin_px * pixel_m_;
  if (perspective_) {
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      farthest -= std::min(back_[axis] * low[axis], back_[axis] * high[axis]);
    }
    grown *= std::clamp(farthest, least_depth_, greatest_depth_);
  }
  low -= grown;
  high += grown;

  BoxPlanes result;
  result.device_margin = device_margin_;
  std::array<BoxPlanes::NearnessPlane, 6> exits;
  int exit_count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto plane = [&](double at, double side) {
      BoxPlanes::NearnessPlane p;
      if (perspective_) {
        const double inverse = 1.0 / at;
        p = {start_[axis] * inverse, step_x_[axis] * inverse, step_y_[axis] * inverse};
      } else {
        const double inverse = -1.0 / back_[axis];
        p = {(start_[axis] - at) * inverse, step_x_[axis] * inverse, step_y_[axis] * inverse};
      }
      p.c += side * reach_ * (std::abs(p.a) + std::abs(p.b));
      return p;
    };
    const auto enter = [&](double at) {
      result.planes[static_cast<std::size_t>(result.enter_count++)] = plane(at, 1.0);
    };
    const auto leave = [&](double at) {
      exits[static_cast<std::size_t>(exit_count++)] = plane(at, -1.0);
    };
    if (!perspective_) {
      if (std::abs(back_[axis]) < least_slope) continue;
      const bool upward = back_[axis] < 0.0;
      enter(upward ? low[axis] : high[axis]);
      leave(upward ? high[axis] : low[axis]);
    } else if (low[axis] > least_distance) {
      enter(low[axis]);
      leave(high[axis]);
    } else if (high[axis] < -least_distance) {
      enter(high[axis]);
      leave(low[axis]);
    } else {
      // The eye is between the slab's planes: rays leave through one of them.
      if (low[axis] < -least_distance) leave(low[axis]);
      if (high[axis] > least_distance) leave(high[axis]);
    }
  }
  result.count = result.enter_count;
  for (int i = 0; i < exit_count; ++i) {
    result.planes[static_cast<std::size_t>(result.count++)] = exits[static_cast<std::size_t>(i)];
  }
  return result;
}

bool hides_silhouette_scalar(const TileStore& tiles, const BoxWindow& rectangle,
                             const BoxPlanes& planes) {
  for (int tile_y = rectangle.y0 / tile_size; tile_y * tile_size < rectangle.y1; ++tile_y) {
    for (int tile_x = rectangle.x0 / tile_size; tile_x * tile_size < rectangle.x1; ++tile_x) {
      const std::size_t tile = tiles.index(tile_x, tile_y);
      if (tiles.farthest()[tile] > rectangle.nearness) continue;
      const TilePlanes in_tile(planes, tile_x, tile_y);
      const int left = tile_x * tile_size, below = tile_y * tile_size;
      for (int y = std::max(rectangle.y0, below); y < std::min(rectangle.y1, below + tile_size);
           ++y) {
        for (int x = std::max(rectangle.x0, left); x < std::min(rectangle.x1, left + tile_size);
             ++x) {
          const auto dx = static_cast<float>(x - left);
          const auto dy = static_cast<float>(y - below);
          const auto value = [&](int i) {
            const auto& p = in_tile.planes[static_cast<std::size_t>(i)];
            return p.c + (p.a * dx + p.b * dy);
          };
          float nearest = rectangle.nearness;
          for (int i = 0; i < planes.enter_count; ++i) {
            const float entry = value(i);
            nearest = std::min(
                nearest, (entry + std::abs(entry) * nearness_rounding) + planes.device_margin);
          }
          float hidden_below = tiles.nearness(tile, x - left, y - below);
          for (int i = planes.enter_count; i < planes.count; ++i) {
            hidden_below = std::max(hidden_below, value(i));
          }
          if (!(hidden_below > nearest)) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace vislab
