#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/spatial/wide_bvh.h"

namespace vislab {
namespace {

constexpr std::uint32_t width = BoxBlock::width;

/// A point that most centres are near, whatever few of them do: medians of a sample.
glm::vec3 middle_of(std::span<const Aabb> boxes) {
  constexpr std::size_t sample_size = 256;
  const std::size_t stride = boxes.size() / sample_size + 1;
  std::array<std::array<float, sample_size>, 3> sample;
  std::size_t count = 0;
  for (std::size_t i = 0; i < boxes.size(); i += stride) {
    if (!boxes[i].valid()) continue;
    const glm::dvec3 center = boxes[i].center();
    for (int axis = 0; axis < 3; ++axis) {
      sample[static_cast<std::size_t>(axis)][count] = static_cast<float>(center[axis]);
    }
    ++count;
  }
  glm::vec3 middle(0.0F);
  if (count == 0) return middle;
  for (int axis = 0; axis < 3; ++axis) {
    auto& values = sample[static_cast<std::size_t>(axis)];
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(values.begin(), half, values.begin() + static_cast<std::ptrdiff_t>(count));
    middle[axis] = *half;
  }
  return middle;
}

/// How far from `origin` the tree is to reach: four times as far as what is in, a power of two.
/// One object in 64 may be left out, if that shortens the reach to less than a 64th: float's margin
/// grows with the reach.
float reach_of(std::span<const Aabb> boxes, const glm::vec3& origin) {
  // Counts by the biased exponent of the farthest coordinate: e is for less than 2^(e - 126), the
  // last for what is not finite.
  constexpr std::size_t not_finite = 255;
  std::array<std::size_t, not_finite + 1> counts{};
  for (const Aabb& box : boxes) {
    const glm::vec3 far = glm::max(glm::abs(box.min - origin), glm::abs(box.max - origin));
    const bool ordered = glm::all(glm::lessThanEqual(box.min, box.max));
    const float reach = std::max({far.x, far.y, far.z});
    ++counts[ordered ? std::bit_cast<std::uint32_t>(reach) >> 23U : not_finite];
  }
  const std::size_t total = boxes.size() - counts[not_finite];
  std::size_t exponent = not_finite - 1;
  while (exponent > 0 && counts[exponent] == 0) --exponent;
  std::size_t beyond = 0;
  std::size_t shorter = exponent;
  while (shorter > 0) {
    beyond += counts[shorter];
    if (beyond > total / 64) break;
    --shorter;
  }
  if (shorter + 6 < exponent) exponent = shorter;
  // Twice the reach is still finite.
  return std::ldexp(1.0F, std::min(static_cast<int>(exponent) - 126 + 2, 126));
}

}  // namespace

/// Builds the nodes of one hierarchy. Friend of WideBvh.
class WideBvhBuilder {
 public:
  explicit WideBvhBuilder(WideBvh& bvh)
      : bvh_(bvh), object_counts_(bvh.tree_counts_), open_(bvh.sources_) {}

  /// Objects lie in items_ (median) or already in objects_ (Z curve), as leaves of eight.
  void packed(bool medians) {
    medians_ = medians;
    const auto count = static_cast<std::uint32_t>(bvh_.objects_.size());
    bvh_.nodes_.emplace_back();
    bvh_.node_parent_.push_back(0);
    std::uint64_t below_child = width;
    while (below_child * width < count) below_child *= width;
    fill_packed(0, 0, count, static_cast<std::uint32_t>(below_child));
  }

  void collapse(const SpatialStructure& tree, std::span<const Aabb> boxes) {
    tree_ = &tree;
    boxes_ = boxes;
    count_objects();
    bvh_.objects_.resize(object_counts_[SpatialStructure::root]);
    bvh_.nodes_.emplace_back();
    bvh_.node_parent_.push_back(0);
    open_.assign(1, {0, SpatialStructure::root, 0});
    while (!open_.empty()) {
      const Source next = open_.back();
      open_.pop_back();
      fill_collapsed(next);
    }
  }

 private:
  using Source = WideBvh::Source;

  /// Adds the children of `node`: `inner` nodes, then `leaves` leaves.
  void add_children(std::uint32_t node, std::uint32_t inner, std::uint32_t leaves) {
    WideNode& at = bvh_.nodes_[node];
    at.inner_count = inner;
    at.child_count = inner + leaves;
    at.first_inner = static_cast<std::uint32_t>(bvh_.nodes_.size());
    at.first_leaf = static_cast<std::uint32_t>(bvh_.leaf_parent_.size());
    for (std::uint32_t lane = 0; lane < inner; ++lane) {
      bvh_.node_parent_.push_back(node * width + lane);
    }
    for (std::uint32_t lane = inner; lane < inner + leaves; ++lane) {
      bvh_.leaf_parent_.push_back(node * width + lane);
    }
    bvh_.nodes_.resize(bvh_.nodes_.size() + inner);
    bvh_.first_place_.resize(bvh_.leaf_parent_.size());
  }

  /// `below_child`: 8^k objects for each child but the last.
  void fill_packed(std::uint32_t node, std::uint32_t begin, std::uint32_t end,
                   std::uint32_t below_child) {
    const std::uint32_t children = (end - begin + below_child - 1) / below_child;
    if (medians_) divide(begin, end, children, below_child);
    const bool leaves = below_child == width;
    add_children(node, leaves ? 0 : children, leaves ? children : 0);
    for (std::uint32_t lane = 0; lane <= children; ++lane) {
      bvh_.nodes_[node].first[lane] = std::min(begin + lane * below_child, end);
    }
    for (std::uint32_t lane = 0; lane < children; ++lane) {
      const std::uint32_t first = bvh_.nodes_[node].first[lane];
      if (leaves) {
        bvh_.first_place_[bvh_.nodes_[node].first_leaf + lane] = first;
      } else {
        fill_packed(bvh_.nodes_[node].first_inner + lane, first, bvh_.nodes_[node].first[lane + 1],
                    below_child / width);
      }
    }
  }

  /// Halves the items until each child has its own.
  void divide(std::uint32_t begin, std::uint32_t end, std::uint32_t children,
              std::uint32_t below_child) {
    if (children < 2) return;
    const std::uint32_t left = children / 2;
    const std::uint32_t middle = begin + left * below_child;
    const auto first = bvh_.items_.begin();
    Aabb centers;
    for (std::uint32_t i = begin; i < end; ++i) centers.extend(bvh_.items_[i].center);
    const glm::dvec3 size = centers.half_size();
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    // Ids decide between equal centres: every library's nth_element then finds the same halves.
    std::nth_element(first + begin, first + middle, first + end,
                     [axis](const WideBvh::Item& a, const WideBvh::Item& b) {
                       return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis]
                                                               : a.object < b.object;
                     });
    divide(begin, middle, left, below_child);
    divide(middle, end, children - left, below_child);
  }

  /// Objects at and below each node of the tree. Trees can be deep: no recursion.
  void count_objects() {
    object_counts_.assign(tree_->nodes().size(), 0);
    std::vector<std::uint32_t>& order = bvh_.tree_order_;
    order.assign(1, SpatialStructure::root);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const SpatialNode& at = tree_->nodes()[order[i]];
      for (std::uint32_t child = 0; child < at.child_count; ++child) {
        order.push_back(at.first_child + child);
      }
    }
    while (!order.empty()) {
      const std::uint32_t node = order.back();
      order.pop_back();
      const SpatialNode& at = tree_->nodes()[node];
      auto count = static_cast<std::uint32_t>(std::ranges::count_if(
          tree_->objects_at(node), [&](ObjectId object) { return bvh_.fits(boxes_[object]); }));
      for (std::uint32_t child = 0; child < at.child_count; ++child) {
        count += object_counts_[at.first_child + child];
      }
      object_counts_[node] = count;
    }
  }

  double half_area(std::uint32_t node) const {
    const Aabb& box = tree_->nodes()[node].box;
    if (box.empty()) return 0.0;
    const glm::dvec3 size = box.half_size();
    return size.x * size.y + size.y * size.z + size.z * size.x;
  }

  /// Writes the objects of a small subtree from `place` on; returns the place behind them.
  std::uint32_t put_objects(std::uint32_t node, std::uint32_t place) {
    if (object_counts_[node] == 0) return place;
    for (const ObjectId object : tree_->objects_at(node)) {
      if (bvh_.fits(boxes_[object])) bvh_.objects_[place++] = object;
    }
    const SpatialNode& at = tree_->nodes()[node];
    for (std::uint32_t i = 0; i < at.child_count; ++i) {
      place = put_objects(at.first_child + i, place);
    }
    return place;
  }

  /// Opens the largest descendant until there are eight that are leaves or too many for one.
  void fill_collapsed(const Source& source) {
    std::array<std::uint32_t, width> open{source.tree_node};
    std::size_t count = 1;
    while (count < width) {
      std::size_t best = count;
      for (std::size_t i = 0; i < count; ++i) {
        if (object_counts_[open[i]] <= width) continue;
        if (best == count || half_area(open[i]) > half_area(open[best])) best = i;
      }
      if (best == count) break;
      const SpatialNode& at = tree_->nodes()[open[best]];
      if (at.child_count == 0) throw std::logic_error("wide BVH: a leaf has more than 8 objects");
      if (count - 1 + at.child_count > width) break;
      std::copy(open.begin() + best + 1, open.begin() + count, open.begin() + best);
      --count;
      for (std::uint32_t i = 0; i < at.child_count; ++i) open[count++] = at.first_child + i;
    }
    // Nodes first, then leaves, each in their order.
    std::array<std::uint32_t, width> children{};
    std::uint32_t child_count = 0;
    const auto take = [&](auto&& wanted) {
      for (std::size_t i = 0; i < count; ++i) {
        if (wanted(object_counts_[open[i]])) children[child_count++] = open[i];
      }
    };
    take([](std::uint32_t objects) { return objects > width; });
    const std::uint32_t inner = child_count;
    take([](std::uint32_t objects) { return objects > 0 && objects <= width; });
    add_children(source.node, inner, child_count - inner);
    WideNode& at = bvh_.nodes_[source.node];
    std::uint32_t place = source.first_place;
    for (std::uint32_t lane = 0; lane < child_count; ++lane) {
      at.first[lane] = place;
      if (lane < inner) {
        open_.push_back({at.first_inner + lane, children[lane], place});
        place += object_counts_[children[lane]];
      } else {
        bvh_.first_place_[at.first_leaf + lane - inner] = place;
        place = put_objects(children[lane], place);
      }
    }
    at.first[child_count] = place;
  }

  WideBvh& bvh_;
  bool medians_ = false;
  const SpatialStructure* tree_ = nullptr;
  std::span<const Aabb> boxes_;
  std::vector<std::uint32_t>& object_counts_;  // by node of the tree
  std::vector<Source>& open_;
};

void WideBvh::start(std::span<const Aabb> boxes, bool forget) {
  if (forget) {
    state_.assign(boxes.size(), present);
  } else {
    for (std::uint8_t& state : state_) state &= present;
  }
  origin_ = middle_of(boxes);
  limit_ = reach_of(boxes, origin_);
  nodes_.clear();
  node_parent_.clear();
  leaf_parent_.clear();
  first_place_.clear();
  objects_.clear();
  apart_.clear();
  apart_changed_ = false;
  absent_count_ = 0;
  slot_.assign(boxes.size(), nowhere);
  // Memory for everything that later changes might need.
  objects_.reserve(boxes.size() + width);
  apart_.reserve(boxes.size());
}

void WideBvh::finish_build(std::span<const Aabb> boxes) {
  const auto placed = static_cast<std::uint32_t>(objects_.size());
  const std::size_t leaf_count = leaf_parent_.size();
  BoxBlock empty;
  for (std::size_t i = 0; i < 6; ++i) {
    const float nothing = std::numeric_limits<float>::max();
    empty.bounds[i].fill(i < 3 ? nothing : -nothing);
  }
  leaves_.assign(leaf_count, empty);
  absent_bits_.assign(placed / 64 + 1, 0);
  for (WideNode& node : nodes_) node.boxes = empty;
  for (std::uint32_t leaf = 0; leaf < leaf_count; ++leaf) {
    const std::uint32_t parent = leaf_parent_[leaf];
    const std::uint32_t end = nodes_[parent / width].first[parent % width + 1];
    for (std::uint32_t place = first_place_[leaf]; place < end; ++place) {
      const ObjectId object = objects_[place];
      slot_[object] = leaf * width + (place - first_place_[leaf]);
      write_box(object, boxes[object]);
      if ((state_[object] & present) == 0) set_absent_bit(object, true);
    }
  }
  objects_.resize(placed + width, none_id);  // kernels read eight at once
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    if (slot_[object] != nowhere) continue;
    state_[object] |= apart | listed_apart;
    apart_.push_back(object);
  }
  dirty_leaves_.assign(leaf_count / 64 + 1, 0);
  dirty_nodes_.assign(nodes_.size() / 64 + 1, 0);
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) {
    dirty_leaves_[leaf / 64] |= std::uint64_t{1} << (leaf % 64);
  }
  area_ = 0.0;
  refit();
  // With those that are absent: when they are shown where they are, nothing has decayed.
  area_when_built_ = area_;
  if (absent_count_ == 0) return;
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    if (slot_[object] == nowhere || (state_[object] & present) != 0) continue;
    write_absent(object);
    dirty_leaves_[slot_[object] / width / 64] |= std::uint64_t{1} << (slot_[object] / width % 64);
  }
  refit();
}

void WideBvh::build(std::span<const Aabb> boxes, Order order) {
  start(boxes, true);
  pack(boxes, order);
}

void WideBvh::rebuild(std::span<const Aabb> boxes, Order order) {
  start(boxes, false);
  pack(boxes, order);
}

void WideBvh::pack(std::span<const Aabb> boxes, Order order) {
  items_.clear();
  Aabb centers;
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    if (!fits(boxes[object])) continue;
    // Relative to the origin no sum of two overflows.
    const glm::vec3 center = ((boxes[object].min - origin_) + (boxes[object].max - origin_)) * 0.5F;
    items_.push_back({center, object});
    centers.extend(center);
  }
  if (order == Order::morton) {
    const MortonGrid grid(centers);
    keys_.clear();
    for (const Item& item : items_) keys_.push_back({grid.code(item.center), item.object});
    sort_by_code(keys_, key_scratch_);
    for (const MortonKey& key : keys_) objects_.push_back(key.index);
    WideBvhBuilder(*this).packed(false);
  } else {
    objects_.resize(items_.size());
    WideBvhBuilder(*this).packed(true);
    for (std::size_t i = 0; i < items_.size(); ++i) objects_[i] = items_[i].object;
  }
  finish_build(boxes);
}

void WideBvh::build(std::span<const Aabb> boxes, const SpatialStructure& tree) {
  start(boxes, true);
  collapse(boxes, tree);
}

void WideBvh::rebuild(std::span<const Aabb> boxes, const SpatialStructure& tree) {
  start(boxes, false);
  collapse(boxes, tree);
}

void WideBvh::collapse(std::span<const Aabb> boxes, const SpatialStructure& tree) {
  WideBvhBuilder(*this).collapse(tree, boxes);
  finish_build(boxes);
}

}  // namespace vislab
