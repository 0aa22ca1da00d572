#include "algorithms/surface/window_face.h"

#include <algorithm>
#include <cmath>

namespace vislab::surface {
namespace {

/// Rounded up, for a positive divisor.
std::int64_t divided_up(std::int64_t value, std::int64_t divisor) {
  return value / divisor + (value % divisor > 0 ? 1 : 0);
}

/// Rounded down, for a positive divisor.
std::int64_t divided_down(std::int64_t value, std::int64_t divisor) {
  return value / divisor - (value % divisor < 0 ? 1 : 0);
}

}  // namespace

RowSpan on_side(RowSpan row, const WindowLine& line, int y, bool positive) {
  if (row.empty()) return row;
  const auto is_positive = [&](int x) { return line.at(x, y) > 0.0; };
  if (!(line.a > 0.0) && !(line.a < 0.0)) {
    return is_positive(row.x0) == positive ? row : RowSpan{row.x0, row.x0};
  }
  // The first pixel at which the sign is what it is at the right-hand end.
  const bool rises = line.a > 0.0;
  const double crossing = line.from_x - line.at(line.from_x, y) / line.a;
  int x = static_cast<int>(
      std::clamp(std::ceil(crossing), static_cast<double>(row.x0), static_cast<double>(row.x1)));
  while (x > row.x0 && is_positive(x - 1) == rises) --x;
  while (x < row.x1 && is_positive(x) != rises) ++x;
  return rises == positive ? RowSpan{x, row.x1} : RowSpan{row.x0, x};
}

bool WindowFace::set(const WindowTransform& window, const std::array<WindowPoint, 3>& corners) {
  count_ = set_up_triangle(window, corners, 0, {}, pieces_).count;
  if (count_ == 0) return false;
  from_x_ = pieces_[0].anchor_x;
  from_y_ = pieces_[0].anchor_y;
  for (std::size_t i = 0; i < 3; ++i) {
    const double w = window.perspective() ? corners[i].depth : 1.0;
    corners_[i] = {corners[i].x - (from_x_ + 0.5) * w, corners[i].y - (from_y_ + 0.5) * w, w};
  }
  determinant_ = glm::dot(corners_[0], glm::cross(corners_[1], corners_[2]));
  nearness_ = line(window.perspective()
                       ? std::array{1.0, 1.0, 1.0}
                       : std::array{-corners[0].depth, -corners[1].depth, -corners[2].depth});
  const double far_m = window.camera().lens.far_m;
  cut_by_far_ = std::ranges::any_of(corners, [&](const WindowPoint& p) { return p.depth > far_m; });
  if (cut_by_far_) {
    before_far_ = nearness_;
    before_far_.c -= window.nearness(far_m);
  }
  return true;
}

WindowLine WindowFace::line(const std::array<double, 3>& values) const {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    sum += values[i] * glm::cross(corners_[(i + 1) % 3], corners_[(i + 2) % 3]);
  }
  sum /= determinant_;
  return {sum.x, sum.y, sum.z, from_x_, from_y_};
}

RowSpan WindowFace::covered(const SetupTriangle& piece, int y, RowEnds& ends) {
  std::int64_t x0 = piece.x0;
  std::int64_t x1 = piece.x1;
  ends = {static_cast<double>(x0) - 0.5, static_cast<double>(x1) - 0.5};
  for (const WindowEdge& edge : piece.edges) {
    const std::int64_t c = edge.at(0, y);
    if (edge.a > 0) {
      x0 = std::max(x0, divided_up(-c, edge.a));
      ends.left = std::max(ends.left, -static_cast<double>(c) / edge.a);
    } else if (edge.a < 0) {
      x1 = std::min(x1, divided_down(c, -std::int64_t{edge.a}) + 1);
      ends.right = std::min(ends.right, -static_cast<double>(c) / edge.a);
    } else if (c < 0) {
      return {};
    }
  }
  return {static_cast<int>(std::min(x0, x1)), static_cast<int>(x1)};
}

}  // namespace vislab::surface
