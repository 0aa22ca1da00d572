// Convex polygons as the search for a cell's visible set clips them: without memory of their own,
// and never by more than exact arithmetic would clip.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace vislab::portal_culling {

/// Inside is where dot(normal, p) >= offset; the normal has unit length.
struct HalfSpace {
  glm::dvec3 normal{0.0};
  double offset = 0.0;

  double distance(const glm::dvec3& p) const { return glm::dot(normal, p) - offset; }
};

class FlowPolygon {
 public:
  static constexpr std::uint32_t capacity = 24;

  FlowPolygon() = default;
  /// The corners in order; polygons with more than `capacity` corners do not fit, see fits().
  explicit FlowPolygon(std::span<const glm::dvec3> corners) {
    for (const glm::dvec3& corner : corners) corners_[count_++] = corner;
  }
  static bool fits(std::size_t corners) { return corners <= capacity; }

  std::span<const glm::dvec3> corners() const { return {corners_.data(), count_}; }
  std::uint32_t size() const { return count_; }

  /// Keeps what is inside, boundary included. False if that is nothing. Where the result would have
  /// too many corners nothing is cut.
  bool clip(const HalfSpace& half);

  /// The greatest distance of a corner.
  double farthest(const HalfSpace& half) const;

 private:
  std::array<glm::dvec3, capacity> corners_;
  std::uint32_t count_ = 0;
};

/// The half spaces that hold all of every line beyond `second` that first crosses `first` and then
/// `second`: their planes go through an edge of one polygon and a corner of the other, and the
/// polygons lie on different sides. Each gives way by `slack` (metres). Appended to `found`.
/// O((corners of both)^3).
void append_separators(const FlowPolygon& first, const FlowPolygon& second, double slack,
                       std::vector<HalfSpace>& found);

}  // namespace vislab::portal_culling
