#include "common/raster/box_blocks.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/rounding.h"
#include "common/raster/margins.h"
#include "common/raster/tile_queries.h"

namespace vislab {
namespace {

/// Of a function of points relative to the eye, whose value at the eye is `constant`.
ColumnView::Row row_of(const glm::dvec3& normal, double constant, const glm::dvec3& eye) {
  constexpr double rounding = nearness_rounding;
  constexpr double eye_rounding = 0x1p-46;  // of the eye as two floats
  ColumnView::Row row;
  row.x = static_cast<float>(normal.x);
  row.y = static_cast<float>(normal.y);
  row.z = static_cast<float>(normal.z);
  row.constant = static_cast<float>(constant);
  const glm::dvec3 size = glm::abs(normal);
  const double greatest = std::max({size.x, size.y, size.z});
  row.reach_error = round_up(rounding * greatest);
  row.constant_error =
      round_up(rounding * std::abs(constant) + eye_rounding * greatest * absolute_sum(eye));
  return row;
}

}  // namespace

bool BoxColumns::says_something(const Aabb& box) {
  constexpr float greatest_coordinate = 1e12F;
  bool small = box.valid();
  for (int axis = 0; axis < 3; ++axis) {
    small = small && std::abs(box.min[axis]) <= greatest_coordinate &&
            std::abs(box.max[axis]) <= greatest_coordinate;
  }
  return small;
}

void BoxColumns::put(std::size_t column, const Aabb& new_box) {
  const std::uint32_t bit = 1U << column;
  present |= bit;
  const bool plain = says_something(new_box);
  always = plain ? always & ~bit : always | bit;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    rows[axis][column] = plain ? new_box.min[i] : 0.0F;
    rows[axis + 3][column] = plain ? new_box.max[i] : 0.0F;
  }
}

ColumnView::ColumnView(const WindowTransform& window, Coverage coverage)
    : perspective(window.perspective()),
      near_m(round_up(window.camera().lens.near_m)),
      far_m(round_up(window.camera().lens.far_m)),
      width(static_cast<float>(window.viewport().width)),
      height(static_cast<float>(window.viewport().height)),
      device_margin(round_up(window.device_margin())) {
  const Camera& camera = window.camera();
  const Lens& lens = camera.lens;
  const glm::dvec3 eye = camera.pose.eye;
  const glm::dvec3 high = rounded_to_float(eye);
  const glm::dvec3 low = rounded_to_float(eye - high);
  for (int axis = 0; axis < 3; ++axis) {
    eye_high[static_cast<std::size_t>(axis)] = static_cast<float>(high[axis]);
    eye_low[static_cast<std::size_t>(axis)] = static_cast<float>(low[axis]);
  }
  const WindowRows& rows = window.world();
  const glm::dvec3 normal_x(rows.x[0], rows.x[1], rows.x[2]);
  const glm::dvec3 normal_y(rows.y[0], rows.y[1], rows.y[2]);
  const glm::dvec3 normal_depth(rows.depth[0], rows.depth[1], rows.depth[2]);
  const double size_x = window.viewport().width, size_y = window.viewport().height;
  // At the eye a perspective camera's window positions, before the division, and depth are 0.
  const double at_eye_x = perspective ? 0.0 : -size_x * lens.left / (lens.right - lens.left);
  const double at_eye_y = perspective ? 0.0 : -size_y * lens.bottom / (lens.top - lens.bottom);
  window_x = row_of(normal_x, at_eye_x, eye);
  window_y = row_of(normal_y, at_eye_y, eye);
  depth = row_of(normal_depth, 0.0, eye);
  sides[0] = window_x;
  sides[1] = window_y;
  if (perspective) {
    sides[2] = row_of(size_x * normal_depth - normal_x, 0.0, eye);
    sides[3] = row_of(size_y * normal_depth - normal_y, 0.0, eye);
    depth_to_px = 2.0F * std::max(width, height);
  } else {
    sides[2] = row_of(-normal_x, size_x - at_eye_x, eye);
    sides[3] = row_of(-normal_y, size_y - at_eye_y, eye);
  }
  reach = round_up(snapping_margin_px + (coverage == Coverage::centres ? 0.5 : 1.0));
}

void place_columns_scalar(const ColumnView& view, const BoxColumns& boxes, ColumnPlaces& out) {
  const auto error = [](const ColumnView::Row& row, float reach) {
    return reach * row.reach_error + row.constant_error;
  };
  out.undecided = out.inside = 0;
  for (std::size_t column = 0; column < BoxColumns::width; ++column) {
    const std::uint32_t bit = 1U << column;
    if ((boxes.present & ~boxes.always & bit) == 0) continue;
    std::array<float, 3> low, high;
    std::array<float, 3> size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float eye_high = view.eye_high[axis], eye_low = view.eye_low[axis];
      low[axis] = (boxes.rows[axis][column] - eye_high) - eye_low;
      high[axis] = (boxes.rows[axis + 3][column] - eye_high) - eye_low;
      size[axis] = std::max(std::abs(low[axis]), std::abs(high[axis]));
    }
    const float reach = (size[0] + size[1]) + size[2];
    const auto greatest = [&](const ColumnView::Row& row) {
      return ((row.x * (row.x >= 0.0F ? high[0] : low[0]) +
               row.y * (row.y >= 0.0F ? high[1] : low[1])) +
              row.z * (row.z >= 0.0F ? high[2] : low[2])) +
             row.constant;
    };
    bool outside = false;
    for (const ColumnView::Row& side : view.sides) {
      outside = outside || greatest(side) + error(side, reach) < 0.0F;
    }
    const float depth_error = error(view.depth, reach);
    outside = outside || greatest(view.depth) + depth_error < view.near_m;

    // Of the corners.
    float least_depth = INFINITY;
    float least_x = INFINITY, least_y = INFINITY, greatest_x = -INFINITY, greatest_y = -INFINITY;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const float x = (corner & 1) != 0 ? high[0] : low[0];
      const float y = (corner & 2) != 0 ? high[1] : low[1];
      const float z = (corner & 4) != 0 ? high[2] : low[2];
      const auto value = [&](const ColumnView::Row& row) {
        return ((row.x * x + row.y * y) + row.z * z) + row.constant;
      };
      const float depth = value(view.depth);
      const float inverse = view.perspective ? 1.0F / depth : 1.0F;
      const float at_x = value(view.window_x) * inverse;
      const float at_y = value(view.window_y) * inverse;
      least_depth = std::min(least_depth, depth);
      least_x = std::min(least_x, at_x);
      least_y = std::min(least_y, at_y);
      greatest_x = std::max(greatest_x, at_x);
      greatest_y = std::max(greatest_y, at_y);
    }
    const float seen = least_depth - depth_error;
    outside = outside || seen > view.far_m;
    if (outside) continue;
    if (!(seen > view.near_m) || (view.perspective && !(seen > 4.0F * depth_error))) {
      out.undecided |= bit;
      continue;
    }
    const float inverse = view.perspective ? 1.0F / seen : 1.0F;
    const auto margin = [&](const ColumnView::Row& row) {
      return view.reach + (error(row, reach) + depth_error * view.depth_to_px) * inverse;
    };
    const float margin_x = margin(view.window_x), margin_y = margin(view.window_y);
    const auto from = [](float value, float size_px) {
      return static_cast<std::int32_t>(std::ceil(std::min(std::max(value, 0.0F), size_px)));
    };
    const auto to = [](float value, float size_px) {
      return static_cast<std::int32_t>(std::floor(std::min(std::max(value, 0.0F), size_px)));
    };
    out.x0[column] = from(least_x - margin_x, view.width);
    out.y0[column] = from(least_y - margin_y, view.height);
    out.x1[column] = to(greatest_x + margin_x, view.width);
    out.y1[column] = to(greatest_y + margin_y, view.height);
    const float nearest = view.perspective ? inverse : -seen;
    out.nearness[column] = (nearest + std::abs(nearest) * nearness_rounding) + view.device_margin;
    if (out.x0[column] < out.x1[column] && out.y0[column] < out.y1[column]) out.inside |= bit;
  }
}

}  // namespace vislab
