#include "algorithms/portal/window_cover.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "algorithms/portal/convex_cut.h"

namespace vislab::portal_culling {
namespace {

/// Regions written by hand touch within the rounding of float.
constexpr double cover_slack_m = 1e-6;

}  // namespace

double WindowPiece::area() const {
  double twice = 0.0;
  for (std::uint32_t i = 2; i < count; ++i) {
    const glm::dvec2 a = corners[i - 1] - corners[0];
    const glm::dvec2 b = corners[i] - corners[0];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * std::abs(twice);
}

bool WindowPiece::cut(const WindowLine& line, WindowPiece* outside) {
  std::array<double, capacity> distance;
  const std::span<double> distances = std::span(distance).first(count);
  for (std::uint32_t i = 0; i < count; ++i) distance[i] = line.distance(corners[i]);
  if (outside != nullptr) outside->count = 0;
  WindowPiece inside;
  Cut cut = cut_convex<glm::dvec2>(span(), distances, inside.corners, inside.count);
  if (cut == Cut::in_two && outside != nullptr) {
    for (double& d : distances) d = -d;
    cut = cut_convex<glm::dvec2>(span(), distances, outside->corners, outside->count);
    if (cut != Cut::in_two) cut = Cut::all_outside;  // touches the line, or cannot be divided
  }
  if (cut == Cut::in_two) {
    count = inside.count;
    std::copy_n(inside.corners.begin(), count, corners.begin());
  } else if (cut == Cut::all_outside || (cut == Cut::undecided && outside != nullptr)) {
    if (outside != nullptr) *outside = *this;
    count = 0;
  }
  return count > 0;
}

WindowCover::WindowCover(const WindowPiece& window) : negligible_(1e-9 * window.area()) {
  pieces_[0] = window;
}

void WindowCover::take_away(std::span<const WindowLine> lines) {
  std::array<WindowPiece, most_pieces> left;
  std::uint32_t left_count = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    WindowPiece& piece = pieces_[i];
    for (const WindowLine& line : lines) {
      WindowPiece outside;
      const bool any = piece.cut(line.moved(cover_slack_m), &outside);
      if (outside.count >= 3 && outside.area() > negligible_) {
        if (left_count == most_pieces) {
          too_many_ = true;
          return;
        }
        left[left_count++] = outside;
      }
      if (!any) break;
    }
  }
  std::copy_n(left.begin(), left_count, pieces_.begin());
  count_ = left_count;
}

bool WindowCover::complete() const { return count_ == 0 && !too_many_; }

}  // namespace vislab::portal_culling
