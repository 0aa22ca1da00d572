#include "report/chart_labels.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>
#include <optional>

namespace vislab {
namespace {

constexpr double nearest_px = 10.0;   // of a label's centre from its point
constexpr double ring_step_px = 6.0;  // between the circles of places that are tried
constexpr int rings = 9;
constexpr int directions = 16;
constexpr double leader_from_px = 15.0;
constexpr double most_covered_px2 = 8.0;  // of a legible label: less than a line through a letter
constexpr double weight_outside = 10.0, weight_of_label = 10.0;  // beside other things covered
constexpr double crossing_px2 = 400.0;  // of a leader with a label or a leader; as if so much of a
                                        // label were covered

ChartBox box_at(double x, double y, const LabelRequest& request) {
  return {x - 0.5 * request.width, y - 0.5 * request.height, x + 0.5 * request.width,
          y + 0.5 * request.height};
}

/// The line that joins a label to its point.
struct Leader {
  glm::dvec2 from, to;
};

bool crosses(const Leader& leader, const ChartBox& box) {
  const glm::dvec2 way = leader.to - leader.from;
  double first = 0.0;
  double last = 1.0;
  const auto clip = [&](double start, double step, double low, double high) {
    if (step == 0.0) return start > low && start < high;
    const auto [enters, leaves] = std::minmax({(low - start) / step, (high - start) / step});
    first = std::max(first, enters);
    last = std::min(last, leaves);
    return first < last;
  };
  return clip(leader.from.x, way.x, box.left, box.right) &&
         clip(leader.from.y, way.y, box.bottom, box.top);
}

bool crosses(const Leader& a, const Leader& b) {
  const auto side = [](const Leader& line, const glm::dvec2& point) {
    const glm::dvec2 way = line.to - line.from;
    const glm::dvec2 there = point - line.from;
    return way.x * there.y - way.y * there.x;
  };
  return side(a, b.from) * side(a, b.to) < 0.0 && side(b, a.from) * side(b, a.to) < 0.0;
}

double distance(const ChartBox& box, const LabelRequest& point) {
  const double x = std::max({box.left - point.x, 0.0, point.x - box.right});
  const double y = std::max({box.bottom - point.y, 0.0, point.y - box.top});
  return std::hypot(x, y);
}

/// Would a reader take the label to be another point's?
bool is_nearer_to_another(const ChartBox& box, const LabelRequest& own,
                          const std::vector<LabelRequest>& requests) {
  return std::ranges::any_of(requests, [&](const LabelRequest& other) {
    return distance(box, other) < distance(box, own);
  });
}

/// How often a label and its leader, if it has one, cross the leaders and labels that are there.
std::ptrdiff_t crossings(const ChartBox& box, const std::optional<Leader>& leader,
                         const std::vector<ChartBox>& labels, const std::vector<Leader>& leaders) {
  std::ptrdiff_t count =
      std::ranges::count_if(leaders, [&](const Leader& other) { return crosses(other, box); });
  if (!leader) return count;
  count +=
      std::ranges::count_if(labels, [&](const ChartBox& label) { return crosses(*leader, label); });
  return count + std::ranges::count_if(
                     leaders, [&](const Leader& other) { return crosses(*leader, other); });
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
  std::vector<ChartBox> taken;  // by legible labels
  std::vector<Leader> leaders;  // theirs
  std::vector<PlacedLabel> placed;
  for (const LabelRequest& request : requests) {
    const double area = request.width * request.height;
    PlacedLabel best;
    double least = std::numeric_limits<double>::infinity();
    for (int ring = 0; ring < rings && least > 0.0; ++ring) {
      const double radius = nearest_px + ring * ring_step_px;
      for (int direction = 0; direction < directions && least > 0.0; ++direction) {
        // Straight up first, then alternately to both sides.
        const int turn = (direction + 1) / 2 * (direction % 2 == 0 ? 1 : -1);
        const double angle = std::numbers::pi * (0.5 + 2.0 * turn / directions);
        // Wide labels stand off by their own width, or they would cover what they name.
        const double x =
            request.x +
            (radius + 0.5 * std::max(0.0, request.width - 2.0 * nearest_px)) * std::cos(angle);
        const double y = request.y + radius * std::sin(angle);
        const ChartBox box = box_at(x, y, request);
        const double outside = std::max(0.0, area - box.overlap(frame) - 1e-9);
        double on_labels = 0.0;
        for (const ChartBox& other : taken) on_labels += box.overlap(other);
        double covered = 0.0;
        for (const ChartBox& other : obstacles) covered += box.overlap(other);
        const bool has_leader =
            radius > leader_from_px || is_nearer_to_another(box, request, requests);
        std::optional<Leader> leader;
        if (has_leader) leader = Leader{{request.x, request.y}, {x, y}};
        const auto crossed = crossings(box, leader, taken, leaders);
        const double cost = covered + weight_outside * outside + weight_of_label * on_labels +
                            crossing_px2 * static_cast<double>(crossed);
        if (cost < least) {
          least = cost;
          best = {
              x, y, has_leader,
              outside == 0.0 && on_labels == 0.0 && crossed == 0 && covered <= most_covered_px2};
        }
      }
    }
    if (best.is_legible) {
      taken.push_back(box_at(best.x, best.y, request));
      if (best.leader) leaders.push_back({{request.x, request.y}, {best.x, best.y}});
    }
    placed.push_back(best);
  }
  return placed;
}

std::vector<PointGroup> group_points(const std::vector<NumberedPoint>& points, double reach) {
  std::vector<PointGroup> groups;
  std::vector<NumberedPoint> firsts;
  for (const NumberedPoint& point : points) {
    const auto first = std::ranges::find_if(firsts, [&](const NumberedPoint& other) {
      return std::abs(other.x - point.x) <= reach && std::abs(other.y - point.y) <= reach;
    });
    if (first == firsts.end()) {
      firsts.push_back(point);
      groups.push_back({point.x, point.y, {point.number}});
      continue;
    }
    PointGroup& group = groups[static_cast<std::size_t>(first - firsts.begin())];
    const auto count = static_cast<double>(group.numbers.size());
    group.x = (count * group.x + point.x) / (count + 1.0);
    group.y = (count * group.y + point.y) / (count + 1.0);
    group.numbers.push_back(point.number);
  }
  return groups;
}

std::string number_list(std::vector<std::size_t> numbers) {
  std::ranges::sort(numbers);
  std::string list;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    list += (list.empty() ? "" : ", ") + std::to_string(numbers[i]);
    if (end - i > 1) list += (end - i == 2 ? ", " : "–") + std::to_string(numbers[end - 1]);
    i = end;
  }
  return list;
}

}  // namespace vislab
