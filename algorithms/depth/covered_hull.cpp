#include "algorithms/depth/covered_hull.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/raster/margins.h"

namespace vislab::depth_culling {
namespace {

constexpr std::size_t max_corners = 64;  // of a chain; more are left out, which makes it smaller
constexpr std::size_t parts = 8;

/// One side of a hull, its corners by x.
class Chain {
 public:
  /// `points` by x and y; side is 1 for the lower chain, -1 for the upper one.
  Chain(std::span<const glm::dvec2> points, double side) {
    for (const glm::dvec2& p : points) {
      while (count_ >= 2 && side * turn(corners_[count_ - 2], corners_[count_ - 1], p) <= 0.0) {
        --count_;
      }
      // A full chain goes on from the corner before: inside of the hull all the same.
      if (count_ == max_corners) --count_;
      corners_[count_++] = p;
    }
  }

  /// Row at a column position, which lies between the first and the last corner.
  double at(double x) const {
    std::size_t i = 1;
    while (i + 1 < count_ && corners_[i].x < x) ++i;
    const glm::dvec2& p = corners_[i - 1];
    const glm::dvec2& q = corners_[i];
    if (!(p.x < q.x)) return q.y;
    return p.y + (q.y - p.y) * ((x - p.x) / (q.x - p.x));
  }

  std::span<const glm::dvec2> corners() const { return std::span(corners_).first(count_); }

 private:
  static double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  std::array<glm::dvec2, max_corners> corners_;
  std::size_t count_ = 0;
};

/// A column and the rows that are free in it.
struct Column {
  int x;
  double low, high;
};

}  // namespace

bool largest_covered(std::span<glm::dvec2> points, const Viewport& viewport, BoxWindow& out) {
  if (points.size() < 3) return false;
  std::ranges::sort(points, [](const glm::dvec2& a, const glm::dvec2& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  });
  constexpr double reach = snapping_margin_px;
  const auto column = [&](double x) { return std::clamp(x, -1.0, viewport.width + 1.0); };
  const int first =
      std::max(0, static_cast<int>(std::ceil(column(points.front().x + reach - 0.5))));
  const int last = std::min(viewport.width - 1,
                            static_cast<int>(std::floor(column(points.back().x - reach - 0.5))));
  if (first > last) return false;
  const Chain lower(points, 1.0);
  const Chain upper(points, -1.0);

  std::array<Column, 2 * 2 * max_corners + parts + 1> columns;
  std::size_t count = 0;
  const auto add = [&](int x) {
    if (x < first || x > last) return;
    const double left = std::max(x + 0.5 - reach, points.front().x);
    const double right = std::min(x + 0.5 + reach, points.back().x);
    columns[count++] = {x, std::max(lower.at(left), lower.at(right)),
                        std::min(upper.at(left), upper.at(right))};
  };
  for (const Chain* chain : {&lower, &upper}) {
    for (const glm::dvec2& corner : chain->corners()) {
      add(static_cast<int>(std::ceil(column(corner.x + reach - 0.5))));
      add(static_cast<int>(std::floor(column(corner.x - reach - 0.5))));
    }
  }
  for (std::size_t i = 0; i <= parts; ++i) {
    add(first + static_cast<int>((last - first) * i / parts));
  }
  std::int64_t largest = 0;
  const auto row = [&](double y) { return std::clamp(y, -1.0, viewport.height + 1.0); };
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = i; k < count; ++k) {
      const Column& a = columns[i];
      const Column& b = columns[k];
      const double low = std::max(a.low, b.low) + reach - 0.5;
      const double high = std::min(a.high, b.high) - reach - 0.5;
      const int y0 = std::max(0, static_cast<int>(std::ceil(row(low))));
      const int y1 = std::min(viewport.height, static_cast<int>(std::floor(row(high))) + 1);
      const int width = std::abs(a.x - b.x) + 1;
      if (y0 >= y1 || std::int64_t{width} * (y1 - y0) <= largest) continue;
      largest = std::int64_t{width} * (y1 - y0);
      out.x0 = std::min(a.x, b.x);
      out.x1 = std::max(a.x, b.x) + 1;
      out.y0 = y0;
      out.y1 = y1;
    }
  }
  return largest > 0;
}

}  // namespace vislab::depth_culling
