// The near plane's window, and what of it regions do not cover. Coordinates are metres on the near
// plane, right and up from the middle of the view.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace vislab::portal_culling {

/// Where a plane of the world meets the near plane: right * x + up * y + offset is the plane's own
/// distance, metres.
struct WindowLine {
  double right, up, offset;

  double distance(const glm::dvec2& p) const { return right * p.x + up * p.y + offset; }
  WindowLine moved(double outward_m) const { return {right, up, offset + outward_m}; }
};

/// A convex polygon, corners in order.
struct WindowPiece {
  static constexpr std::uint32_t capacity = 32;

  std::array<glm::dvec2, capacity> corners;
  std::uint32_t count = 0;

  std::span<const glm::dvec2> span() const { return {corners.data(), count}; }
  double area() const;
  /// Takes away what is outside of the line, and puts it into `outside` unless that is null. False
  /// if nothing is left. A piece that cannot be divided (convex_cut.h) stays, or is outside as a
  /// whole where that is asked.
  bool cut(const WindowLine& line, WindowPiece* outside = nullptr);
};

/// What is left of a window when regions are taken away.
class WindowCover {
 public:
  explicit WindowCover(const WindowPiece& window);
  /// Takes away what lies inside all lines, or outside of them by a rounding only.
  void take_away(std::span<const WindowLine> lines);
  /// Nothing is left.
  bool complete() const;

 private:
  static constexpr std::uint32_t most_pieces = 48;

  double negligible_;  // area; what rounding leaves between regions that touch
  std::array<WindowPiece, most_pieces> pieces_;
  std::uint32_t count_ = 1;
  bool too_many_ = false;
};

}  // namespace vislab::portal_culling
