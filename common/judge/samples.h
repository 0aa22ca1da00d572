// Where the samples of a frame lie, set C in the centres of the pixels and set J stratified and
// jittered, and the rays through them. Both are made eight at a time, as the ray tracer takes them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/geometry/camera.h"

namespace vislab {

/// Eight window positions, pixels.
struct alignas(32) EightPositions {
  std::array<double, 8> x;
  std::array<double, 8> y;

  glm::dvec2 operator[](std::size_t i) const { return {x[i], y[i]}; }
};

/// Eight vectors, world frame.
struct alignas(32) EightVectors {
  std::array<float, 8> x, y, z;
};

/// Packets are taken from tiles of 4 x 2 pixels. Tile (0, 0) holds pixel (0, 0) in its lower left
/// corner; lanes count along x first. Tiles at the right and upper border may stick out.
inline constexpr int tile_width = 4;
inline constexpr int tile_height = 2;

/// The centres of a tile's pixels.
EightPositions pixel_centres(int tile_x, int tile_y);

/// Sample set J: every pixel is divided into columns * rows strata, as near to squares as the
/// number of samples allows, with one sample in each at a place that a hash of (seed, pixel,
/// sample) gives. Any sample can be computed again, which is why truth need not keep them. Inside
/// its stratum a sample lies at odd multiples of 2^-17 of the stratum's size, so never on an edge
/// of a pixel.
class JitteredSamples {
 public:
  /// `per_pixel` is at least 1. `use_avx2` may be false to get the same from the scalar twin.
  JitteredSamples(const Viewport& viewport, int per_pixel, std::uint64_t seed,
                  bool use_avx2 = true);

  /// A tile has 8 * packets_per_tile() samples, those of one pixel after the other.
  int packets_per_tile() const { return per_pixel_; }
  /// All samples of a tile: packets_per_tile() packets are written to `packets`. A tile at a time,
  /// because the hash of a single packet is all waiting.
  void tile(int tile_x, int tile_y, EightPositions* packets) const;

 private:
  int per_pixel_;
  bool use_avx2_;
  std::uint32_t seed_;            // shifts the sequence of hashes
  std::uint32_t twist_;           // flips bits of every hash
  std::uint32_t samples_in_row_;  // of pixels
  double jitter_x_, jitter_y_;    // pixels in a step of the jitter
  // Of the strata of a tile: lower left corner, pixels from the tile's, and number, counted along
  // the image from the tile's first sample.
  std::vector<double> stratum_x_, stratum_y_;
  std::vector<std::uint32_t> stratum_number_;
};

/// Rays of a camera: float, relative to a scene's origin, with a direction of length 1 along the
/// view, so that distances along a ray are planar. Computed in double from the window position and
/// rounded once.
class RayMaker {
 public:
  /// `use_avx2` may be false to get the same from the scalar twin.
  RayMaker(const Camera& camera, const Viewport& viewport, const glm::dvec3& scene_origin,
           bool use_avx2 = true);

  bool orthographic() const { return orthographic_; }
  /// The origin of all rays of a perspective camera, the direction of all of an orthographic one.
  glm::vec3 common() const { return common_; }
  /// The other vector of the rays through window positions; `vectors` has room for as many.
  void vary(std::span<const EightPositions> window_px, EightVectors* vectors) const;

  /// Distances along every ray. Planar depth is depth_offset() + distance.
  float near_distance() const { return near_distance_; }
  float far_distance() const { return far_distance_; }
  double depth_offset() const { return depth_offset_; }

 private:
  bool orthographic_;
  bool use_avx2_;
  glm::vec3 common_;
  glm::dvec3 corner_;  // the varying vector at window position (0, 0)
  glm::dvec3 step_x_;  // what a pixel to the right adds to it
  glm::dvec3 step_y_;
  float near_distance_;
  float far_distance_;
  double depth_offset_;
};

}  // namespace vislab
