// The kernels are written once, as plain loops over eight lanes, and compiled twice: for AVX2,
// which is chosen at run time, and for the baseline. They use no fused operations, so both give the
// same bits.
#include "common/judge/samples.h"

#include "common/geometry/random.h"

namespace vislab {
namespace {

bool has_avx2() { return __builtin_cpu_supports("avx2") != 0; }

/// The finaliser of MurmurHash3 (Appleby 2011): every bit of the input flips each bit of the output
/// with a probability of about one half.
[[gnu::always_inline]] inline std::uint32_t mix(std::uint32_t h) {
  h ^= h >> 16U;
  h *= 0x85EBCA6BU;
  h ^= h >> 13U;
  h *= 0xC2B2AE35U;
  return h ^ (h >> 16U);
}

struct JitterInput {
  std::uint32_t seed, twist, first_number;
  double tile_x, tile_y;      // of the tile's lower left corner, pixels
  double jitter_x, jitter_y;  // pixels in a step
  const double* stratum_x;
  const double* stratum_y;
  const std::uint32_t* stratum_number;
};

[[gnu::always_inline]] inline void jitter(const JitterInput& in, int packets,
                                          EightPositions* __restrict out) {
  const JitterInput local = in;
  for (int packet = 0; packet < packets; ++packet) {
    const double* __restrict stratum_x = local.stratum_x + packet * 8;
    const double* __restrict stratum_y = local.stratum_y + packet * 8;
    const std::uint32_t* __restrict number = local.stratum_number + packet * 8;
    double* __restrict x = out[packet].x.data();
    double* __restrict y = out[packet].y.data();
    std::int32_t steps_x[8];
    std::int32_t steps_y[8];
    for (int lane = 0; lane < 8; ++lane) {
      const std::uint32_t hash = mix(local.first_number + number[lane] + local.seed) ^ local.twist;
      steps_x[lane] = static_cast<std::int32_t>((hash >> 16U) * 2U + 1U);
      steps_y[lane] = static_cast<std::int32_t>((hash & 0xFFFFU) * 2U + 1U);
    }
    for (int lane = 0; lane < 8; ++lane) {
      x[lane] = local.tile_x + stratum_x[lane] + steps_x[lane] * local.jitter_x;
      y[lane] = local.tile_y + stratum_y[lane] + steps_y[lane] * local.jitter_y;
    }
  }
}

[[gnu::target("avx2")]] void jitter_avx2(const JitterInput& in, int packets, EightPositions* out) {
  jitter(in, packets, out);
}

void jitter_baseline(const JitterInput& in, int packets, EightPositions* out) {
  jitter(in, packets, out);
}

struct Affine {
  glm::dvec3 corner, step_x, step_y;
};

[[gnu::always_inline]] inline void vary_lanes(const Affine& affine,
                                              std::span<const EightPositions> in,
                                              EightVectors* __restrict out) {
  const Affine local = affine;
  for (const EightPositions& positions : in) {
    float* const to[] = {out->x.data(), out->y.data(), out->z.data()};
    for (int axis = 0; axis < 3; ++axis) {
      const double corner = local.corner[axis];
      const double step_x = local.step_x[axis];
      const double step_y = local.step_y[axis];
      float* const __restrict values = to[axis];
      for (int lane = 0; lane < 8; ++lane) {
        values[lane] =
            static_cast<float>(corner + step_x * positions.x[lane] + step_y * positions.y[lane]);
      }
    }
    ++out;
  }
}

[[gnu::target("avx2")]] void vary_avx2(const Affine& affine, std::span<const EightPositions> in,
                                       EightVectors* out) {
  vary_lanes(affine, in, out);
}

void vary_baseline(const Affine& affine, std::span<const EightPositions> in, EightVectors* out) {
  vary_lanes(affine, in, out);
}

}  // namespace

EightPositions pixel_centres(int tile_x, int tile_y) {
  EightPositions positions;
  for (int lane = 0; lane < 8; ++lane) {
    positions.x[lane] = tile_x * tile_width + lane % tile_width + 0.5;
    positions.y[lane] = tile_y * tile_height + lane / tile_width + 0.5;
  }
  return positions;
}

JitteredSamples::JitteredSamples(const Viewport& viewport, int per_pixel, std::uint64_t seed,
                                 bool use_avx2)
    : per_pixel_(per_pixel),
      use_avx2_(use_avx2 && has_avx2()),
      samples_in_row_(static_cast<std::uint32_t>(viewport.width) * per_pixel) {
  const std::uint64_t seeds = Random(seed).bits();
  seed_ = static_cast<std::uint32_t>(seeds);
  twist_ = static_cast<std::uint32_t>(seeds >> 32U);
  int rows = 1;
  for (int divisor = 1; divisor * divisor <= per_pixel; ++divisor) {
    if (per_pixel % divisor == 0) rows = divisor;
  }
  const int columns = per_pixel / rows;
  jitter_x_ = 0x1p-17 / columns;
  jitter_y_ = 0x1p-17 / rows;
  for (int pixel = 0; pixel < tile_width * tile_height; ++pixel) {
    const int x = pixel % tile_width;
    const int y = pixel / tile_width;
    for (int sample = 0; sample < per_pixel; ++sample) {
      stratum_x_.push_back(x + static_cast<double>(sample % columns) / columns);
      stratum_y_.push_back(y + static_cast<double>(sample / columns) / rows);
      stratum_number_.push_back(y * samples_in_row_ + x * per_pixel + sample);
    }
  }
}

void JitteredSamples::tile(int tile_x, int tile_y, EightPositions* packets) const {
  // The number of a sample may wrap around in images of more than 2^32 samples: the hash then gives
  // the same jitter to pixels that are far from each other.
  const JitterInput in{seed_,
                       twist_,
                       static_cast<std::uint32_t>(tile_y * tile_height) * samples_in_row_ +
                           static_cast<std::uint32_t>(tile_x * tile_width) * per_pixel_,
                       static_cast<double>(tile_x * tile_width),
                       static_cast<double>(tile_y * tile_height),
                       jitter_x_,
                       jitter_y_,
                       stratum_x_.data(),
                       stratum_y_.data(),
                       stratum_number_.data()};
  (use_avx2_ ? jitter_avx2 : jitter_baseline)(in, per_pixel_, packets);
}

RayMaker::RayMaker(const Camera& camera, const Viewport& viewport, const glm::dvec3& scene_origin,
                   bool use_avx2)
    : orthographic_(camera.lens.projection == Projection::orthographic),
      use_avx2_(use_avx2 && has_avx2()) {
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

void RayMaker::vary(std::span<const EightPositions> window_px, EightVectors* vectors) const {
  (use_avx2_ ? vary_avx2 : vary_baseline)({corner_, step_x_, step_y_}, window_px, vectors);
}

}  // namespace vislab
