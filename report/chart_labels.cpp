#include "report/chart_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace vislab {
namespace {

constexpr double nearest_px = 10.0;   // of a label's centre from its point
constexpr double ring_step_px = 6.0;  // between the circles of places that are tried
constexpr int rings = 9;
constexpr int directions = 16;
constexpr double leader_from_px = 15.0;

ChartBox box_at(double x, double y, const LabelRequest& request) {
  return {x - 0.5 * request.width, y - 0.5 * request.height, x + 0.5 * request.width,
          y + 0.5 * request.height};
}

}  // namespace

double ChartBox::overlap(const ChartBox& other) const {
  const double width = std::min(right, other.right) - std::max(left, other.left);
  const double height = std::min(top, other.top) - std::max(bottom, other.bottom);
  return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

std::vector<PlacedLabel> place_labels(const std::vector<LabelRequest>& requests,
                                      const std::vector<ChartBox>& obstacles,
                                      const ChartBox& frame) {
  std::vector<ChartBox> taken = obstacles;
  std::vector<PlacedLabel> placed;
  for (const LabelRequest& request : requests) {
    PlacedLabel best;
    double least = std::numeric_limits<double>::infinity();
    for (int ring = 0; ring < rings && least > 0.0; ++ring) {
      const double radius = nearest_px + ring * ring_step_px;
      for (int direction = 0; direction < directions && least > 0.0; ++direction) {
        // Straight up first, then alternately to both sides.
        const int turn = (direction + 1) / 2 * (direction % 2 == 0 ? 1 : -1);
        const double angle = std::numbers::pi * (0.5 + 2.0 * turn / directions);
        const double x = request.x + radius * std::cos(angle);
        const double y = request.y + radius * std::sin(angle);
        const ChartBox box = box_at(x, y, request);
        const double outside = request.width * request.height - box.overlap(frame);
        double covered = 10.0 * std::max(0.0, outside - 1e-9);
        for (const ChartBox& other : taken) covered += box.overlap(other);
        if (covered < least) {
          least = covered;
          best = {x, y, radius > leader_from_px};
        }
      }
    }
    taken.push_back(box_at(best.x, best.y, request));
    placed.push_back(best);
  }
  return placed;
}

}  // namespace vislab
