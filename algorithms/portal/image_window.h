// What a walk through portals still sees of the image: a convex polygon in the plane at distance 1
// from the eye (for orthographic cameras: in the image plane, metres).
//
// Clipping keeps points that lie outside by no more than window_slack, so that rounding loses
// nothing; polygons with too many corners are not cut any further, which only keeps more.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace vislab::portal_culling {

/// About 1/200 of a pixel of a 512 pixel image.
inline constexpr double window_slack = 1e-5;

struct Rectangle {
  glm::dvec2 min{1e300}, max{-1e300};

  void extend(const glm::dvec2& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  bool overlaps(const Rectangle& other) const {
    return min.x <= other.max.x + window_slack && other.min.x <= max.x + window_slack &&
           min.y <= other.max.y + window_slack && other.min.y <= max.y + window_slack;
  }
};

class ImagePolygon {
 public:
  static constexpr std::uint32_t capacity = 24;

  void clear() {
    count_ = 0;
    bounds_ = {};
  }
  void add(const glm::dvec2& p) {
    corners_[count_++] = p;
    bounds_.extend(p);
  }
  std::span<const glm::dvec2> corners() const { return {corners_.data(), count_}; }
  std::uint32_t size() const { return count_; }
  const Rectangle& bounds() const { return bounds_; }

  /// What of this polygon lies in `window`, both counter-clockwise. False if nothing does.
  bool cut_by(const ImagePolygon& window);

 private:
  std::array<glm::dvec2, capacity> corners_;
  std::uint32_t count_ = 0;
  Rectangle bounds_;
};

}  // namespace vislab::portal_culling
