#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/random.h"
#include "common/spatial/bvh.h"
#include "common/spatial/morton.h"

namespace vislab {
namespace {

constexpr std::size_t bin_count = 16;
/// How far along the Z curve partners are looked for (Meister and Bittner 2018: 14 is close to the
/// best quality).
constexpr std::size_t search_radius = 14;

struct Item {
  Aabb box;
  glm::dvec3 center;
  ObjectId object;
};

Aabb united(Aabb a, const Aabb& b) {
  a.extend(b);
  return a;
}

/// A plane between two bins, and what it promises: areas times numbers of full leaves.
struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0;
  std::size_t bin = 0;  // the last of the lower side
};

/// The bins of some items along one axis.
class Bins {
 public:
  Bins(double low, double high)
      : low_(low), per_m_(static_cast<double>(bin_count) / (high - low)) {}
  /// Without extent, all is one bin.
  bool usable() const { return std::isfinite(per_m_) && per_m_ > 0.0; }
  std::size_t of(double center) const {
    return std::min(static_cast<std::size_t>((center - low_) * per_m_), bin_count - 1);
  }

 private:
  double low_, per_m_;
};

struct Centers {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

Centers centers_of(std::span<const Item> items) {
  Centers centers;
  for (const Item& item : items) {
    centers.low = glm::min(centers.low, item.center);
    centers.high = glm::max(centers.high, item.center);
  }
  return centers;
}

void try_axis(std::span<const Item> items, const Bins& bins, int axis, std::size_t leaf_objects,
              Split& best) {
  struct Bin {
    Aabb box;
    std::size_t count = 0;
  };
  std::array<Bin, bin_count> filled;
  for (const Item& item : items) {
    Bin& bin = filled[bins.of(item.center[axis])];
    bin.box.extend(item.box);
    ++bin.count;
  }
  const auto leaves = [&](std::size_t count) {
    return static_cast<double>((count + leaf_objects - 1) / leaf_objects);
  };
  std::array<double, bin_count> above{};  // cost of all bins behind this one
  Aabb box;
  std::size_t count = 0;
  for (std::size_t bin = bin_count - 1; bin > 0; --bin) {
    box.extend(filled[bin].box);
    count += filled[bin].count;
    above[bin - 1] = half_area(box) * leaves(count);
  }
  box = {};
  count = 0;
  for (std::size_t bin = 0; bin + 1 < bin_count; ++bin) {
    box.extend(filled[bin].box);
    count += filled[bin].count;
    const double cost = half_area(box) * leaves(count) + above[bin];
    if (count > 0 && count < items.size() && cost < best.cost) best = {cost, axis, bin};
  }
}

/// Parts the items in two; returns how many are in the first part. If no plane between bins parts
/// them, they are halved as they lie.
std::size_t split_by_areas(std::span<Item> items, std::size_t leaf_objects) {
  const Centers centers = centers_of(items);
  const auto bins = [&](int axis) { return Bins(centers.low[axis], centers.high[axis]); };
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (bins(axis).usable()) try_axis(items, bins(axis), axis, leaf_objects, best);
  }
  if (std::isinf(best.cost)) return items.size() / 2;
  const Bins chosen = bins(best.axis);
  const auto second = std::partition(items.begin(), items.end(), [&](const Item& item) {
    return chosen.of(item.center[best.axis]) <= best.bin;
  });
  return static_cast<std::size_t>(second - items.begin());
}

/// A part of the tree that the bottom-up builder has made.
struct Cluster {
  Aabb box;
  std::uint32_t count = 0;            // objects
  std::uint32_t left = 0, right = 0;  // clusters; of a single object: its item, twice
};

/// A node that is still to be divided among its items.
struct Range {
  Bvh::NodeIndex node;
  std::size_t begin, end;
};

/// A node and the cluster that it is made of, whose items begin there.
struct Part {
  Bvh::NodeIndex node;
  std::uint32_t cluster;
  std::size_t begin;
};

}  // namespace

/// What builders work in, from one build to the next.
struct BvhBuildMemory {
  std::vector<Item> items, ordered;
  std::vector<Range> ranges;  // in the order in which they are divided
  std::vector<MortonKey> keys, key_scratch;
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> active;  // clusters that have no parent yet
  std::vector<std::size_t> partners;  // by active cluster
  std::vector<Part> parts, leaves;
  std::vector<ObjectId> objects;
  std::vector<Bvh::NodeIndex> nodes;

  std::size_t bytes() const {
    const auto size = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
    return sizeof(BvhBuildMemory) + size(items) + size(ordered) + size(ranges) + size(keys) +
           size(key_scratch) + size(clusters) + size(active) + size(partners) + size(parts) +
           size(leaves) + size(objects) + size(nodes);
  }
};

/// Fills the nodes of one tree with the items in the memory. Friend of Bvh.
class BvhBuilder {
 public:
  BvhBuilder(Bvh& bvh, BvhBuildMemory& memory)
      : bvh_(bvh), memory_(memory), items_(memory.items), open_(memory.ranges) {
    open_.clear();
  }

  void from_ranges(bool along_curve) {
    if (along_curve) sort_along_curve();
    const std::size_t leaf_objects = bvh_.limits_.leaf_objects;
    split_range(Bvh::root, 0, items_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const auto [node, begin, end] = open_[i];
      const std::span<Item> range(items_.data() + begin, end - begin);
      const std::size_t first =
          along_curve ? range.size() / 2 : split_by_areas(range, leaf_objects);
      const Bvh::NodeIndex pair = divide(node);
      split_range(pair, begin, begin + first);
      split_range(pair + 1, begin + first, end);
    }
    set_boxes();
  }

  void bottom_up() {
    sort_along_curve();
    std::vector<Cluster>& clusters = memory_.clusters;
    std::vector<std::uint32_t>& active = memory_.active;
    clusters.clear();
    clusters.reserve(items_.size() * 2);
    active.clear();
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      active.push_back(i);
      clusters.push_back({items_[i].box, 1, i, i});
    }
    while (active.size() > 1) merge_partners();
    if (!clusters.empty()) from_clusters();
    set_boxes();
  }

  void incremental() {
    Random random(1);
    for (std::size_t i = items_.size(); i > 1; --i) {
      std::swap(items_[i - 1], items_[random.below(i)]);
    }
    for (const Item& item : items_) bvh_.put_in_tree(item.object);
    lay_out();
  }

 private:
  /// Puts the items in the order of the Z curve.
  void sort_along_curve() {
    Aabb domain;
    for (const Item& item : items_) domain.extend(glm::vec3(item.center));
    const MortonGrid grid(domain);
    std::vector<MortonKey>& keys = memory_.keys;
    keys.clear();
    // Arrays that are swapped have room for the same number: then it does not matter which is
    // which.
    keys.reserve(items_.capacity());
    memory_.key_scratch.reserve(items_.capacity());
    memory_.ordered.reserve(items_.capacity());
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      keys.push_back({grid.code(glm::vec3(items_[i].center)), i});
    }
    sort_by_code(keys, memory_.key_scratch);
    memory_.ordered.clear();
    for (const MortonKey& key : keys) memory_.ordered.push_back(items_[key.index]);
    items_.swap(memory_.ordered);
  }

  Bvh::NodeIndex divide(Bvh::NodeIndex node) {
    const Bvh::NodeIndex pair = bvh_.add_pair(node);
    bvh_.nodes_[node].first_child = pair;
    bvh_.nodes_[node].child_count = 2;
    return pair;
  }

  void set_run(Bvh::NodeIndex node, std::size_t begin, std::size_t end) {
    bvh_.links_[node].first_below = static_cast<std::uint32_t>(begin);
    bvh_.links_[node].count_below = static_cast<std::uint32_t>(end - begin);
  }

  void fill_leaf(Bvh::NodeIndex node, std::size_t begin, std::size_t end) {
    const auto count = static_cast<std::uint32_t>(end - begin);
    bvh_.leaves_[node] = {static_cast<std::uint32_t>(begin), count, count};
    for (std::size_t i = begin; i < end; ++i) {
      bvh_.objects_[i] = items_[i].object;
      bvh_.places_[items_[i].object].node = node;
    }
  }

  /// Makes the node a leaf, or one that is still to be divided.
  void split_range(Bvh::NodeIndex node, std::size_t begin, std::size_t end) {
    if (begin == 0 && end == items_.size()) bvh_.objects_.resize(items_.size());
    set_run(node, begin, end);
    if (end - begin > bvh_.limits_.leaf_objects) {
      open_.push_back({node, begin, end});
    } else {
      fill_leaf(node, begin, end);
    }
  }

  /// One round: those that are each other's best partner become one.
  void merge_partners() {
    std::vector<Cluster>& clusters = memory_.clusters;
    std::vector<std::uint32_t>& active = memory_.active;
    std::vector<std::size_t>& partner = memory_.partners;
    const std::size_t count = active.size();
    partner.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      double best = std::numeric_limits<double>::infinity();
      std::size_t chosen = i == 0 ? 1 : i - 1;
      const std::size_t end = std::min(count, i + search_radius + 1);
      for (std::size_t j = i - std::min(i, search_radius); j < end; ++j) {
        if (j == i) continue;
        const double area = half_area(united(clusters[active[i]].box, clusters[active[j]].box));
        // Equal areas: an order that is the same seen from both sides, so that where all are equal
        // all find a partner at once.
        const bool nearer = (i ^ j) < (i ^ chosen);
        if (area < best || (area == best && nearer)) {
          best = area;
          chosen = j;
        }
      }
      partner[i] = chosen;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t other = partner[i];
      const bool mutual = partner[other] == i;
      if (mutual && other < i) continue;  // gone into its partner
      if (mutual) {
        const std::uint32_t left = active[i];
        const std::uint32_t right = active[other];
        clusters.push_back({united(clusters[left].box, clusters[right].box),
                            clusters[left].count + clusters[right].count, left, right});
        // What is behind i is still needed: the new cluster takes i's place, or an earlier one.
        active[kept++] = static_cast<std::uint32_t>(clusters.size()) - 1;
      } else {
        active[kept++] = active[i];
      }
    }
    active.resize(kept);
  }

  void from_clusters() {
    const std::vector<Cluster>& clusters = memory_.clusters;
    std::vector<Item>& ordered = memory_.ordered;
    std::vector<Part>& open = memory_.parts;
    std::vector<Part>& leaves = memory_.leaves;
    ordered.resize(items_.size());
    bvh_.objects_.resize(items_.size());
    open.assign(1, {Bvh::root, static_cast<std::uint32_t>(clusters.size()) - 1, 0});
    leaves.clear();
    for (std::size_t i = 0; i < open.size(); ++i) {
      const auto [node, index, begin] = open[i];
      const Cluster& cluster = clusters[index];
      set_run(node, begin, begin + cluster.count);
      if (cluster.count <= bvh_.limits_.leaf_objects) {
        gather(clusters, index, ordered.data() + begin);
        leaves.push_back(open[i]);
      } else {
        const Bvh::NodeIndex pair = divide(node);
        open.push_back({pair, cluster.left, begin});
        open.push_back({pair + 1, cluster.right, begin + clusters[cluster.left].count});
      }
    }
    items_.swap(ordered);
    for (const Part& leaf : leaves) {
      fill_leaf(leaf.node, leaf.begin, leaf.begin + clusters[leaf.cluster].count);
    }
  }

  /// Copies the items of a small cluster.
  Item* gather(const std::vector<Cluster>& clusters, std::uint32_t index, Item* out) const {
    const Cluster& cluster = clusters[index];
    if (cluster.count == 1) {
      *out = items_[cluster.left];
      return out + 1;
    }
    return gather(clusters, cluster.right, gather(clusters, cluster.left, out));
  }

  /// Brings the objects of a tree that was made by insertion into the order of its leaves.
  void lay_out() {
    std::vector<ObjectId>& ordered = memory_.objects;
    std::vector<Bvh::NodeIndex>& open = memory_.nodes;
    ordered.resize(items_.size());
    open.assign(1, Bvh::root);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Bvh::NodeIndex node = open[i];
      const std::uint32_t begin = bvh_.links_[node].first_below;
      const SpatialNode& at = bvh_.nodes_[node];
      if (at.child_count == 0) {
        const std::span<const ObjectId> here = bvh_.objects_at(node);
        std::ranges::copy(here, ordered.begin() + begin);
        const auto count = static_cast<std::uint32_t>(here.size());
        bvh_.leaves_[node] = {begin, count, count};
        continue;
      }
      bvh_.links_[at.first_child].first_below = begin;
      bvh_.links_[at.first_child + 1].first_below = begin + bvh_.links_[at.first_child].count_below;
      open.push_back(at.first_child);
      open.push_back(at.first_child + 1);
    }
    // Not swapped: insertion, which spreads objects wider, finds its memory again.
    bvh_.objects_.assign(ordered.begin(), ordered.end());
    bvh_.free_capacities_.clear();
  }

  /// Children were made after their parents.
  void set_boxes() {
    for (std::size_t node = bvh_.nodes_.size(); node-- > 0;) {
      bvh_.set_box(static_cast<Bvh::NodeIndex>(node));
    }
  }

  Bvh& bvh_;
  BvhBuildMemory& memory_;
  std::vector<Item>& items_;
  std::vector<Range>& open_;
};

Bvh::Bvh(const Limits& limits)
    : limits_(limits), build_memory_(std::make_unique<BvhBuildMemory>()) {
  limits_.leaf_objects = std::max(limits_.leaf_objects, 1U);
  clear_tree();
}

Bvh::~Bvh() = default;

void Bvh::build(std::span<const Aabb> boxes) {
  places_.assign(boxes.size(), {});
  unplaced_.clear();
  moved_.clear();
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    Place& place = places_[object];
    place.box = boxes[object];
    if (place.box.valid()) {
      place.node = root;
    } else {
      place.node = in_unplaced;
      place.unplaced = static_cast<std::uint32_t>(unplaced_.size());
      unplaced_.push_back(object);
    }
  }
  build_tree();
}

void Bvh::build_tree() {
  clear_tree();
  std::vector<Item>& items = build_memory_->items;
  items.clear();
  items.reserve(places_.size());
  for (ObjectId object = 0; object < places_.size(); ++object) {
    const Place& place = places_[object];
    if (place.node < in_unplaced) items.push_back({place.box, place.box.center(), object});
  }
  BvhBuilder builder(*this, *build_memory_);
  switch (limits_.build) {
    case Build::top_down:
      builder.from_ranges(false);
      break;
    case Build::packed:
      builder.from_ranges(true);
      break;
    case Build::bottom_up:
      builder.bottom_up();
      break;
    case Build::incremental:
      builder.incremental();
      break;
  }
  runs_intact_ = true;
  if (limits_.motion != Motion::rebuild) *build_memory_ = {};
}

std::size_t Bvh::bytes() const {
  const auto size = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  return size(nodes_) + size(links_) + size(leaves_) + size(objects_) + size(places_) +
         size(unplaced_) + size(free_pairs_) + size(free_capacities_) + size(moved_) +
         size(queue_) + size(stack_) + size(shared_) + build_memory_->bytes();
}

}  // namespace vislab
