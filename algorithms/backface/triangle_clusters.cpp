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

constexpr std::size_t feature_count = 4;

/// A triangle as a point: its normal, and its offset as an eye at the usual distance sees it.
struct Item {
  std::array<std::int16_t, feature_count> features;
  std::uint32_t triangle;
};

std::int16_t feature(double value) {
  return static_cast<std::int16_t>(std::lrint(std::clamp(value, -1.0, 1.0) * 32767.0));
}

class Builder {
 public:
  Builder(std::uint32_t size, TriangleClusters& clusters) : size_(size), clusters_(clusters) {}

  std::vector<Item> items;

  void build() {
    if (items.empty()) return;
    rest_.resize(items.size());
    build(0, static_cast<std::uint32_t>(items.size()));
  }

 private:
  std::uint32_t build(std::uint32_t first, std::uint32_t end) {
    const auto index = static_cast<std::uint32_t>(clusters_.nodes.size());
    clusters_.nodes.push_back({first, end, 0, 0});
    if (end - first > size_) {
      const std::uint32_t middle = split(first, end);
      const std::uint32_t left = build(first, middle);
      const std::uint32_t right = build(middle, end);
      clusters_.nodes[index].left = left;
      clusters_.nodes[index].right = right;
    } else {
      clusters_.first.push_back(first);
    }
    return index;
  }

  /// How many of `count` triangles go to the left: so many that clusters are full, and the nodes
  /// of trees with `width` children too.
  std::uint32_t left_count(std::uint32_t count) const {
    constexpr std::uint64_t width = 16;
    std::uint64_t unit = size_;
    while (unit * width < count) unit *= width;
    const std::uint64_t units = (count + unit - 1) / unit;
    return static_cast<std::uint32_t>(unit * std::max<std::uint64_t>(1, units / 2));
  }

  /// Splits across the feature that extends farthest; ascending order is kept on both sides.
  std::uint32_t split(std::uint32_t first, std::uint32_t end) {
    const std::span<Item> all = std::span(items).subspan(first, end - first);
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

  std::uint32_t size_;
  TriangleClusters& clusters_;
  std::vector<Item> rest_;
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
  Builder builder(settings.size, clusters);
  builder.items.reserve(mesh.triangles.size());
  std::vector<std::uint32_t> apart;
  const double offset_scale = frame.size > 0.0 ? 1.0 / (settings.eye_distance * frame.size) : 0.0;
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const glm::dvec4 plane = unit_plane(mesh, frame, triangle);
    if (plane == glm::dvec4(0.0)) {
      apart.push_back(triangle);
    } else {
      builder.items.push_back(
          {{feature(plane.x), feature(plane.y), feature(plane.z), feature(plane.w * offset_scale)},
           triangle});
    }
  }
  builder.build();
  clusters.order.reserve(mesh.triangles.size());
  for (const Item& item : builder.items) clusters.order.push_back(item.triangle);
  clusters.tested = static_cast<std::uint32_t>(clusters.first.size());
  if (!apart.empty()) clusters.first.push_back(static_cast<std::uint32_t>(clusters.order.size()));
  clusters.order.insert(clusters.order.end(), apart.begin(), apart.end());
  clusters.first.push_back(static_cast<std::uint32_t>(clusters.order.size()));
  return clusters;
}

void append_runs(std::span<const std::uint32_t> triangles, std::vector<TriangleRun>& runs) {
  const std::size_t before = runs.size();
  for (const std::uint32_t triangle : triangles) {
    const bool follows = runs.size() > before && runs.back().first + runs.back().count == triangle;
    if (follows) {
      ++runs.back().count;
    } else {
      runs.push_back({triangle, 1});
    }
  }
}

}  // namespace vislab::backface_culling
