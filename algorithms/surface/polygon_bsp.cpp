#include "algorithms/surface/polygon_bsp.h"

#include <algorithm>
#include <utility>

namespace vislab::surface {
namespace {

glm::dvec2 normal_of(const std::array<glm::dvec2, 2>& edge) {
  const glm::dvec2 along = edge[1] - edge[0];
  return {along.y, -along.x};
}

glm::dvec3 normal_of(const std::array<glm::dvec3, 3>& triangle) {
  return glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
}

constexpr std::size_t candidates_tried = 8;
constexpr std::size_t parts_sampled = 32;
constexpr std::uint64_t split_cost = 4;  // as so many pieces too many on one side

}  // namespace

template <int dimensions>
bool PolygonBsp<dimensions>::plane_of(const Face& face, Plane& plane) {
  const Point normal = normal_of(face);
  const double length = glm::length(normal);
  if (!(length > 0.0) || !std::isfinite(length)) return false;
  plane = {normal / length, face[0]};
  return true;
}

template <int dimensions>
void PolygonBsp<dimensions>::clear() {
  nodes_.clear();
  pieces_.clear();
  cuts_.clear();
  splits_ = 0;
  tests_ = 0;
}

template <int dimensions>
auto PolygonBsp<dimensions>::classify(const Part& part, const Plane& plane) -> Where {
  ++tests_;
  bool front = false;
  bool back = false;
  distances_.clear();
  for (std::uint32_t i = 0; i < part.corner_count; ++i) {
    const double distance = plane.distance(corners_[part.first_corner + i]);
    front = front || distance > limits_.tolerance;
    back = back || distance < -limits_.tolerance;
    distances_.push_back(distance);
  }
  if (front && back) return Where::both;
  return front ? Where::front : back ? Where::back : Where::in;
}

/// Sutherland and Hodgman 1974, both sides at once. The part was classified last.
template <int dimensions>
auto PolygonBsp<dimensions>::divide(const Part& part, std::uint32_t node) -> std::array<Part, 2> {
  std::array<Part, 2> sides;
  for (const bool front : {true, false}) {
    const double sign = front ? 1.0 : -1.0;
    Part& side = sides[front ? 0 : 1];
    side = {part.face, static_cast<std::uint32_t>(cuts_.size()),
            static_cast<std::uint32_t>(corners_.size()), 0};
    cuts_.push_back({node, front, part.cut});
    for (std::uint32_t i = 0; i < part.corner_count; ++i) {
      const double distance = sign * distances_[i];
      const std::uint32_t next = (i + 1) % part.corner_count;
      const double next_distance = sign * distances_[next];
      const Point a = corners_[part.first_corner + i];
      const Point b = corners_[part.first_corner + next];
      if (distance >= -limits_.tolerance) corners_.push_back(a);
      const bool is_edge = dimensions > 2 || i == 0;
      if (is_edge && std::min(distance, next_distance) < -limits_.tolerance &&
          std::max(distance, next_distance) > limits_.tolerance) {
        corners_.push_back(a + (b - a) * (distance / (distance - next_distance)));
      }
    }
    side.corner_count = static_cast<std::uint32_t>(corners_.size()) - side.first_corner;
  }
  return sides;
}

template <int dimensions>
std::size_t PolygonBsp<dimensions>::choose(const std::vector<Part>& parts, Random& random) {
  if (limits_.splitter == Splitter::first || parts.size() < 3) return 0;
  const std::size_t sampled = std::min(parts.size(), parts_sampled);
  std::size_t best = 0;
  std::uint64_t best_cost = ~std::uint64_t{0};
  for (std::size_t k = 0; k < candidates_tried && best_cost > 0; ++k) {
    const std::size_t candidate = random.below(parts.size());
    const Plane& plane = planes_[parts[candidate].face];
    std::array<std::uint64_t, 4> counts{};
    for (std::size_t i = 0; i < sampled; ++i) {
      const std::size_t other = i * parts.size() / sampled;
      if (other != candidate) ++counts[static_cast<std::size_t>(classify(parts[other], plane))];
    }
    const std::uint64_t front = counts[static_cast<std::size_t>(Where::front)];
    const std::uint64_t back = counts[static_cast<std::size_t>(Where::back)];
    const std::uint64_t cost = split_cost * counts[static_cast<std::size_t>(Where::both)] +
                               std::max(front, back) - std::min(front, back);
    if (cost < best_cost) {
      best = candidate;
      best_cost = cost;
    }
  }
  return best;
}

template <int dimensions>
bool PolygonBsp<dimensions>::build(std::span<const Face> faces, const Limits& limits) {
  clear();
  limits_ = limits;
  corners_.clear();
  planes_.assign(faces.size(), {});
  std::vector<Part> all;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    if (!plane_of(faces[i], planes_[i])) continue;
    all.push_back({i, none, static_cast<std::uint32_t>(corners_.size()), dimensions});
    corners_.insert(corners_.end(), faces[i].begin(), faces[i].end());
  }
  part_count_ = all.size();
  Random random(1);
  std::vector<Task> tasks;
  if (!all.empty()) tasks.push_back({none, false, std::move(all)});
  while (!tasks.empty()) {
    const Task task = std::move(tasks.back());
    tasks.pop_back();
    if (part_count_ > limits_.max_pieces || tests_ > limits_.max_tests) break;
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    if (task.parent != none) {
      (task.front ? nodes_[task.parent].front : nodes_[task.parent].back) = number;
    }
    const std::size_t chosen = choose(task.parts, random);
    const Plane plane = planes_[task.parts[chosen].face];
    Node node{plane, none, none, static_cast<std::uint32_t>(pieces_.size()), 0};
    pieces_.push_back({task.parts[chosen].face, task.parts[chosen].cut});
    std::vector<Part> front;
    std::vector<Part> back;
    for (std::size_t i = 0; i < task.parts.size(); ++i) {
      if (i == chosen) continue;
      const Part& part = task.parts[i];
      switch (classify(part, plane)) {
        case Where::in:
          pieces_.push_back({part.face, part.cut});
          break;
        case Where::front:
          front.push_back(part);
          break;
        case Where::back:
          back.push_back(part);
          break;
        case Where::both: {
          const auto sides = divide(part, number);
          front.push_back(sides[0]);
          back.push_back(sides[1]);
          ++splits_;
          ++part_count_;
          break;
        }
      }
    }
    node.piece_count = static_cast<std::uint32_t>(pieces_.size()) - node.first_piece;
    nodes_.push_back(node);
    if (!back.empty()) tasks.push_back({number, false, std::move(back)});
    if (!front.empty()) tasks.push_back({number, true, std::move(front)});
  }
  const bool fits = part_count_ <= limits_.max_pieces && tests_ <= limits_.max_tests;
  if (!fits) {
    nodes_.clear();
    pieces_.clear();
    cuts_.clear();
  }
  corners_ = {};
  distances_ = {};
  planes_ = {};
  nodes_.shrink_to_fit();
  pieces_.shrink_to_fit();
  cuts_.shrink_to_fit();
  return fits;
}

template class PolygonBsp<2>;
template class PolygonBsp<3>;

}  // namespace vislab::surface
