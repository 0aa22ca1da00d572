#include "algorithms/backface/triangle_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vislab::backface_culling {
namespace {

/// Normals shorter than this, of scaled planes, are mostly cancellation: with the 9 roundings of a
/// scaled plane the error of the unit plane stays below plane_error.
constexpr double shortest_normal = 1e-6;

/// Clusters that are culled from less than this of the places from which their first triangle is
/// are divided on, down to a quarter of the size: they lie across edges, mostly.
constexpr double least_part_culled = 0.6;
constexpr std::uint32_t most_division = 4;

constexpr std::size_t feature_count = 4;

/// A triangle as a point: its normal, and its offset as an eye at the usual distance sees it.
struct Item {
  std::array<std::int16_t, feature_count> features;
  std::uint32_t triangle;
  std::uint32_t plane;
};

std::int16_t feature(double value) {
  return static_cast<std::int16_t>(std::lrint(std::clamp(value, -1.0, 1.0) * 32767.0));
}

class Builder {
 public:
  Builder(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings,
          TriangleClusters& clusters)
      : mesh_(mesh), frame_(frame), settings_(settings), clusters_(clusters) {
    const double offset_scale = frame.size > 0.0 ? 1.0 / (settings.eye_distance * frame.size) : 0.0;
    items_.reserve(mesh.triangles.size());
    planes_.reserve(mesh.triangles.size());
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      const glm::dvec4 plane = unit_plane(mesh, frame, triangle);
      if (plane == glm::dvec4(0.0)) {
        apart_.push_back(triangle);
      } else {
        items_.push_back({{feature(plane.x), feature(plane.y), feature(plane.z),
                           feature(plane.w * offset_scale)},
                          triangle,
                          static_cast<std::uint32_t>(planes_.size())});
        planes_.push_back(plane);
      }
    }
    const auto count = static_cast<std::uint32_t>(items_.size());
    size_ = std::clamp(count / settings.least_count, 1U, settings.size);
    smallest_ = std::max(1U, size_ / most_division);
    const auto reach = static_cast<float>(settings.eye_distance * frame.size / frame.unit());
    eyes_.extend(glm::vec3(-reach));
    eyes_.extend(glm::vec3(reach));
    eyes_volume_ = 8.0 * double(reach) * double(reach) * double(reach);
  }

  void build() {
    const auto count = static_cast<std::uint32_t>(items_.size());
    rest_.resize(count);
    clusters_.order.reserve(mesh_.triangles.size());
    if (count > 0) build(0, count);
    clusters_.tested = static_cast<std::uint32_t>(clusters_.first.size());
    clusters_.first.push_back(count);
    // Joined clusters are ascending in their halves only.
    for (std::uint32_t cluster = 0; cluster < clusters_.tested; ++cluster) {
      const auto begin = clusters_.order.begin() + clusters_.first[cluster];
      const auto end = clusters_.order.begin() + clusters_.first[cluster + 1];
      if (!std::is_sorted(begin, end)) std::sort(begin, end);
    }
    if (apart_.empty()) return;
    clusters_.order.insert(clusters_.order.end(), apart_.begin(), apart_.end());
    clusters_.first.push_back(static_cast<std::uint32_t>(clusters_.order.size()));
  }

 private:
  /// What the cost model needs of a subtree that is one cluster.
  struct Made {
    bool one_cluster = false;
    ClusterOdds odds;
    Aabb box;
  };

  Made build(std::uint32_t first, std::uint32_t end) {
    const auto index = static_cast<std::uint32_t>(clusters_.nodes.size());
    clusters_.nodes.push_back({first, end, 0, 0});
    Made made;
    if (end - first <= size_) {
      for (std::uint32_t i = first; i < end; ++i) {
        clusters_.order.push_back(items_[i].triangle);
        ordered_planes_.push_back(planes_[items_[i].plane]);
      }
      made.one_cluster = true;
      made.box = box_of(mesh_, frame_, std::span(clusters_.order).subspan(first));
      made.odds = odds_of(first, end, made.box);
      const double alone = odds_of(first, first + 1, made.box).probability;
      if (end - first <= smallest_ || made.odds.probability >= least_part_culled * alone) {
        clusters_.first.push_back(first);
        return made;
      }
      clusters_.order.resize(first);
      ordered_planes_.resize(first);
      made = {};
    }
    const std::uint32_t middle = split(first, end);
    const std::uint32_t left = static_cast<std::uint32_t>(clusters_.nodes.size());
    const Made left_made = build(first, middle);
    const std::uint32_t right = static_cast<std::uint32_t>(clusters_.nodes.size());
    const Made right_made = build(middle, end);
    clusters_.nodes[index].left = left;
    clusters_.nodes[index].right = right;
    if (!left_made.one_cluster || !right_made.one_cluster) return made;
    made.box = left_made.box;
    made.box.extend(right_made.box);
    made.odds = odds_of(first, end, made.box);
    made.one_cluster = should_join(left_made.odds, right_made.odds, made.odds.probability,
                                   settings_.test_cost, settings_.join);
    if (made.one_cluster) {
      clusters_.nodes.resize(index + 1);
      clusters_.nodes[index].left = clusters_.nodes[index].right = 0;
      clusters_.first.pop_back();
    }
    return made;
  }

  ClusterOdds odds_of(std::uint32_t first, std::uint32_t end, const Aabb& box) const {
    const std::span<const glm::dvec4> planes =
        std::span(ordered_planes_).subspan(first, end - first);
    const ClusterBound bound = bound_of(planes, box, frame_, settings_.origin);
    return {culling_volume(bound, eyes_) / eyes_volume_, static_cast<double>(end - first)};
  }

  /// How many of `count` triangles go to the left: so many that clusters are full, and the nodes
  /// of trees with `width` children too.
  std::uint32_t left_count(std::uint32_t count) const {
    if (count <= size_) return count / 2;
    constexpr std::uint64_t width = 16;
    std::uint64_t unit = size_;
    while (unit * width < count) unit *= width;
    const std::uint64_t units = (count + unit - 1) / unit;
    return static_cast<std::uint32_t>(unit * std::max<std::uint64_t>(1, units / 2));
  }

  /// Splits across the feature that extends farthest; ascending order is kept on both sides.
  std::uint32_t split(std::uint32_t first, std::uint32_t end) {
    const std::span<Item> all = std::span(items_).subspan(first, end - first);
    std::array<int, feature_count> low, high;
    low.fill(std::numeric_limits<int>::max());
    high.fill(std::numeric_limits<int>::min());
    for (const Item& item : all) {
      for (std::size_t f = 0; f < feature_count; ++f) {
        low[f] = std::min<int>(low[f], item.features[f]);
        high[f] = std::max<int>(high[f], item.features[f]);
      }
    }
    std::size_t axis = 0;
    for (std::size_t f = 1; f < feature_count; ++f) {
      if (high[f] - low[f] > high[axis] - low[axis]) axis = f;
    }
    const std::uint32_t wanted = left_count(end - first);
    // The place of the cut to 1/256 of the extent; those in its bin go left until it is full.
    const std::uint32_t scale =
        (256U << 16U) / static_cast<std::uint32_t>(high[axis] - low[axis] + 1);
    const auto bin_of = [&](const Item& item) {
      return (static_cast<std::uint32_t>(item.features[axis] - low[axis]) * scale) >> 16U;
    };
    std::array<std::uint32_t, 257> histogram{};
    for (const Item& item : all) ++histogram[bin_of(item)];
    std::uint32_t cut = 0;
    std::uint32_t below = 0;
    while (below + histogram[cut] < wanted) below += histogram[cut++];
    std::uint32_t room = wanted - below;
    Item* left = all.data();
    Item* right = rest_.data();
    for (const Item& item : all) {
      const std::uint32_t bin = bin_of(item);
      const bool goes_left = bin < cut || (bin == cut && room > 0);
      room -= bin == cut && goes_left ? 1 : 0;
      if (goes_left) {
        *left++ = item;
      } else {
        *right++ = item;
      }
    }
    std::copy(rest_.data(), right, left);
    return first + wanted;
  }

  const Mesh& mesh_;
  const MeshFrame& frame_;
  const ClusterSettings& settings_;
  TriangleClusters& clusters_;
  std::uint32_t size_ = 1;
  std::uint32_t smallest_ = 1;
  Aabb eyes_;  // where eyes may be, in the unit of bounds
  double eyes_volume_ = 1.0;
  std::vector<Item> items_, rest_;
  std::vector<std::uint32_t> apart_;
  std::vector<glm::dvec4> planes_, ordered_planes_;
};

}  // namespace

glm::dvec4 unit_plane(const Mesh& mesh, const MeshFrame& frame, std::uint32_t triangle) {
  const glm::dvec4 plane = scaled_plane(mesh, frame, triangle);
  const double length = glm::length(glm::dvec3(plane));
  if (!(length > shortest_normal)) return glm::dvec4(0.0);
  return plane / length;
}

TriangleClusters make_clusters(const Mesh& mesh, const MeshFrame& frame,
                               const ClusterSettings& settings) {
  TriangleClusters clusters;
  Builder(mesh, frame, settings, clusters).build();
  return clusters;
}

std::vector<glm::dvec4> planes_in_order(const Mesh& mesh, const MeshFrame& frame,
                                        const TriangleClusters& clusters) {
  std::vector<glm::dvec4> planes;
  planes.reserve(clusters.first[clusters.tested]);
  for (std::uint32_t i = 0; i < clusters.first[clusters.tested]; ++i) {
    planes.push_back(unit_plane(mesh, frame, clusters.order[i]));
  }
  return planes;
}

Aabb box_of(const Mesh& mesh, const MeshFrame& frame, std::span<const std::uint32_t> triangles) {
  Aabb box;
  for (const std::uint32_t triangle : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      box.extend(mesh.positions[mesh.triangles[triangle][corner]]);
    }
  }
  box.min = glm::vec3(glm::dvec3(box.min) - frame.middle);
  box.max = glm::vec3(glm::dvec3(box.max) - frame.middle);
  return box;
}

}  // namespace vislab::backface_culling
