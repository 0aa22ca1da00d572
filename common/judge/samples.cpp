#include "common/judge/samples.h"

#include "common/geometry/random.h"

namespace vislab {

EightPositions pixel_centres(int tile_x, int tile_y) {
  EightPositions positions;
  for (int lane = 0; lane < 8; ++lane) {
    positions.x[lane] = tile_x * tile_width + lane % tile_width + 0.5;
    positions.y[lane] = tile_y * tile_height + lane / tile_width + 0.5;
  }
  return positions;
}

JitteredSamples::JitteredSamples(const Viewport& viewport, int per_pixel, std::uint64_t seed)
    : per_pixel_(per_pixel),
      start_(Random(seed).bits()),
      samples_in_row_(static_cast<std::uint64_t>(viewport.width) * per_pixel) {
  int rows = 1;
  for (int divisor = 1; divisor * divisor <= per_pixel; ++divisor) {
    if (per_pixel % divisor == 0) rows = divisor;
  }
  const int columns = per_pixel / rows;
  jitter_x_ = 0x1p-25 / columns;
  jitter_y_ = 0x1p-25 / rows;
  for (int pixel = 0; pixel < tile_width * tile_height; ++pixel) {
    const int x = pixel % tile_width;
    const int y = pixel / tile_width;
    for (int sample = 0; sample < per_pixel; ++sample) {
      strata_.push_back({x + static_cast<double>(sample % columns) / columns,
                         y + static_cast<double>(sample / columns) / rows,
                         y * samples_in_row_ + x * per_pixel + sample});
    }
  }
}

EightPositions JitteredSamples::packet(int tile_x, int tile_y, int packet) const {
  const double x = tile_x * tile_width;
  const double y = tile_y * tile_height;
  const std::uint64_t first = static_cast<std::uint64_t>(tile_y) * tile_height * samples_in_row_ +
                              static_cast<std::uint64_t>(tile_x) * tile_width * per_pixel_;
  const Stratum* stratum = &strata_[static_cast<std::size_t>(packet) * 8];
  EightPositions positions;
  for (int lane = 0; lane < 8; ++lane) {
    const std::uint64_t bits =
        Random(start_ + (first + stratum[lane].number) * Random::increment).bits();
    const auto jitter_x = static_cast<std::int32_t>((bits >> 39U) | 1U);
    const auto jitter_y = static_cast<std::int32_t>(((bits >> 7U) & 0x1FFFFFFU) | 1U);
    positions.x[lane] = x + stratum[lane].x + jitter_x * jitter_x_;
    positions.y[lane] = y + stratum[lane].y + jitter_y * jitter_y_;
  }
  return positions;
}

RayMaker::RayMaker(const Camera& camera, const Viewport& viewport, const glm::dvec3& scene_origin)
    : orthographic_(camera.lens.projection == Projection::orthographic) {
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;
  const double scale = orthographic_ ? 1.0 : 1.0 / lens.near_m;
  step_x_ = right * ((lens.right - lens.left) * scale / viewport.width);
  step_y_ = up * ((lens.top - lens.bottom) * scale / viewport.height);
  const glm::dvec3 window_corner = right * (lens.left * scale) + up * (lens.bottom * scale);
  if (orthographic_) {
    // Rays start on the near plane: it may lie behind the eye, and the ray tracer knows no negative
    // distances.
    common_ = glm::vec3(-back);
    corner_ = eye - scene_origin - back * lens.near_m + window_corner;
    depth_offset_ = lens.near_m;
  } else {
    common_ = glm::vec3(eye - scene_origin);
    corner_ = window_corner - back;
    depth_offset_ = 0.0;
  }
  near_distance_ = static_cast<float>(lens.near_m - depth_offset_);
  far_distance_ = static_cast<float>(lens.far_m - depth_offset_);
}

void RayMaker::vary(const EightPositions& window_px, float* x, float* y, float* z) const {
  float* out[] = {x, y, z};
  for (int axis = 0; axis < 3; ++axis) {
    const double corner = corner_[axis];
    const double step_x = step_x_[axis];
    const double step_y = step_y_[axis];
    for (int lane = 0; lane < 8; ++lane) {
      out[axis][lane] =
          static_cast<float>(corner + step_x * window_px.x[lane] + step_y * window_px.y[lane]);
    }
  }
}

}  // namespace vislab
