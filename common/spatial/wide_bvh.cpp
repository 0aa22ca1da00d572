#include "common/spatial/wide_bvh.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>
#include <string>

#include "common/spatial/wide_bvh_kernel.h"

namespace vislab {
namespace {

constexpr std::uint32_t width = BoxBlock::width;
/// A lane without a box. Finite, so that no product with a plane is NaN: such a lane is outside of
/// every plane.
constexpr float nothing = std::numeric_limits<float>::max();
/// Shorter runs are copied: handing over a span costs a call.
constexpr std::uint32_t shortest_run = 8;

bool test_bit(const std::vector<std::uint64_t>& bits, std::uint32_t index) {
  return (bits[index >> 6U] >> (index & 63U) & 1U) != 0;
}

void set_bit(std::vector<std::uint64_t>& bits, std::uint32_t index) {
  bits[index >> 6U] |= std::uint64_t{1} << (index & 63U);
}

/// The first place from `place` on, below `end`, whose bit is `wanted`; else `end`.
std::uint32_t next_bit(const std::vector<std::uint64_t>& bits, std::uint32_t place,
                       std::uint32_t end, bool wanted) {
  while (place < end) {
    const std::uint64_t word = wanted ? bits[place >> 6U] : ~bits[place >> 6U];
    const std::uint64_t rest = word >> (place & 63U);
    if (rest != 0) return std::min(end, place + static_cast<std::uint32_t>(std::countr_zero(rest)));
    place = (place | 63U) + 1;
  }
  return end;
}

/// Half the surface of a lane's box, metres squared.
double half_area(const BoxBlock& block, std::uint32_t lane) {
  glm::dvec3 size;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    size[axis] =
        static_cast<double>(block.bounds[a + 3][lane]) - static_cast<double>(block.bounds[a][lane]);
    if (size[axis] < 0.0) return 0.0;
  }
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

float smallest(const std::array<float, width>& values) {
  std::array<float, 4> pairs;
  for (std::size_t i = 0; i < 4; ++i) pairs[i] = std::min(values[i], values[i + 4]);
  return std::min(std::min(pairs[0], pairs[1]), std::min(pairs[2], pairs[3]));
}

float largest(const std::array<float, width>& values) {
  std::array<float, 4> pairs;
  for (std::size_t i = 0; i < 4; ++i) pairs[i] = std::max(values[i], values[i + 4]);
  return std::max(std::max(pairs[0], pairs[1]), std::max(pairs[2], pairs[3]));
}

[[noreturn]] void broken(const std::string& what) { throw std::logic_error("wide BVH: " + what); }

}  // namespace

bool WideBvh::fits(const Aabb& box) const {
  const glm::vec3 low = box.min - origin_;
  const glm::vec3 high = box.max - origin_;
  // Written so that NaN does not fit.
  return glm::all(glm::lessThanEqual(box.min, box.max)) &&
         glm::all(glm::greaterThanEqual(low, glm::vec3(-limit_))) &&
         glm::all(glm::lessThanEqual(high, glm::vec3(limit_)));
}

void WideBvh::write_box(ObjectId object, const Aabb& box) {
  const std::uint32_t slot = slot_[object];
  auto& bounds = leaves_[slot / width].bounds;
  const std::uint32_t lane = slot % width;
  const glm::vec3 low = box.min - origin_;
  const glm::vec3 high = box.max - origin_;
  bounds[0][lane] = low.x;
  bounds[1][lane] = low.y;
  bounds[2][lane] = low.z;
  bounds[3][lane] = high.x;
  bounds[4][lane] = high.y;
  bounds[5][lane] = high.z;
}

void WideBvh::write_absent(ObjectId object) {
  const std::uint32_t slot = slot_[object];
  auto& bounds = leaves_[slot / width].bounds;
  for (std::size_t i = 0; i < 6; ++i) bounds[i][slot % width] = i < 3 ? nothing : -nothing;
}

void WideBvh::set_absent_bit(ObjectId object, bool absent) {
  const std::uint32_t slot = slot_[object];
  const std::uint32_t place = first_place_[slot / width] + slot % width;
  if (test_bit(absent_bits_, place) == absent) return;
  absent_bits_[place >> 6U] ^= std::uint64_t{1} << (place & 63U);
  absent_count_ += absent ? 1 : -1;
}

void WideBvh::place(ObjectId object, const Aabb& box) {
  std::uint8_t& state = state_[object];
  const bool in_tree = slot_[object] != nowhere;
  if (in_tree) set_bit(dirty_leaves_, slot_[object] / width);
  if (in_tree && fits(box)) {
    write_box(object, box);
    if ((state & apart) != 0) {
      state &= static_cast<std::uint8_t>(~apart);
      apart_changed_ = true;
      set_absent_bit(object, false);
    }
    return;
  }
  if ((state & apart) != 0) return;
  state |= apart;
  if ((state & listed_apart) == 0) {
    state |= listed_apart;
    apart_.push_back(object);
  }
  if (in_tree) {
    write_absent(object);
    set_absent_bit(object, true);
  }
}

void WideBvh::move(ObjectId object, const Aabb& box) {
  if ((state_[object] & present) == 0) return;
  // The plain case first: it is all that most movers need.
  if (slot_[object] != nowhere && (state_[object] & apart) == 0 && fits(box)) {
    write_box(object, box);
    set_bit(dirty_leaves_, slot_[object] / width);
    return;
  }
  place(object, box);
}

void WideBvh::set_present(ObjectId object, const Aabb& box, bool is_present) {
  std::uint8_t& state = state_[object];
  if (((state & present) != 0) == is_present) return;
  state ^= present;
  if (is_present) {
    if (slot_[object] != nowhere) set_absent_bit(object, (state & apart) != 0);
    place(object, box);
  } else if (slot_[object] != nowhere) {
    write_absent(object);
    set_absent_bit(object, true);
    set_bit(dirty_leaves_, slot_[object] / width);
  }
}

void WideBvh::refit_child(const BoxBlock& block, std::uint32_t parent_lane) {
  BoxBlock& parent = nodes_[parent_lane / width].boxes;
  const std::uint32_t lane = parent_lane % width;
  area_ -= half_area(parent, lane);
  for (std::size_t i = 0; i < 3; ++i) {
    parent.bounds[i][lane] = smallest(block.bounds[i]);
    parent.bounds[i + 3][lane] = largest(block.bounds[i + 3]);
  }
  area_ += half_area(parent, lane);
  set_bit(dirty_nodes_, parent_lane / width);
}

void WideBvh::refit() {
  for (std::size_t word = 0; word < dirty_leaves_.size(); ++word) {
    for (std::uint64_t bits = dirty_leaves_[word]; bits != 0; bits &= bits - 1) {
      const auto leaf =
          static_cast<std::uint32_t>(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
      refit_child(leaves_[leaf], leaf_parent_[leaf]);
    }
    dirty_leaves_[word] = 0;
  }
  // Parents stand before their children: from the back, each is mended before it is read.
  for (std::size_t word = dirty_nodes_.size(); word-- > 0;) {
    while (dirty_nodes_[word] != 0) {
      const auto bit = static_cast<std::size_t>(std::bit_width(dirty_nodes_[word])) - 1;
      dirty_nodes_[word] &= ~(std::uint64_t{1} << bit);
      const std::size_t node = word * 64 + bit;
      if (node != 0) refit_child(nodes_[node].boxes, node_parent_[node]);
    }
  }
  if (!apart_changed_) return;
  std::erase_if(apart_, [&](ObjectId object) {
    if ((state_[object] & apart) != 0) return false;
    state_[object] &= static_cast<std::uint8_t>(~listed_apart);
    return true;
  });
  apart_changed_ = false;
}

double WideBvh::decay() const { return area_when_built_ > 0.0 ? area_ / area_when_built_ : 1.0; }

void WideBvh::take_present(std::uint32_t begin, std::uint32_t end, WideSelection& out) const {
  while (begin < end) {
    begin = next_bit(absent_bits_, begin, end, false);
    const std::uint32_t stop = next_bit(absent_bits_, begin, end, true);
    if (stop - begin >= shortest_run) {
      out.runs.emplace_back(objects_.data() + begin, stop - begin);
    } else {
      for (std::uint32_t place = begin; place < stop; ++place) {
        out.loose[out.loose_count++] = objects_[place];
      }
    }
    begin = stop;
  }
}

void WideBvh::query(const Frustum& frustum, std::span<const Aabb> boxes,
                    const QueryOptions& options, WideSelection& out) const {
  out.runs.clear();
  out.places.clear();
  out.undecided.clear();
  if (out.loose.size() < state_.size() + width) reserve(out);
  walk_wide_bvh({nodes_.data(), leaves_.data(), objects_.data()},
                FrustumFilter(frustum, origin_, limit_), options,
                absent_count_ == 0 ? shortest_run : 0, out);
  for (const WideSelection::Places& run : out.places) {
    if (absent_count_ == 0) {
      out.runs.emplace_back(objects_.data() + run.begin, run.end - run.begin);
    } else {
      take_present(run.begin, run.end, out);
    }
  }
  const auto decide = [&](ObjectId object) {
    const bool outside = std::ranges::any_of(
        frustum.span(), [&](const Plane& plane) { return surely_outside(plane, boxes[object]); });
    if (!outside) out.loose[out.loose_count++] = object;
  };
  out.undecided_tests += out.undecided.size() + apart_.size();
  for (const ObjectId object : out.undecided) decide(object);
  for (const ObjectId object : apart_) {
    if ((state_[object] & present) != 0) decide(object);
  }
  if (out.loose_count > 0) out.runs.emplace_back(out.loose.data(), out.loose_count);
}

void WideBvh::reserve(WideSelection& out) const {
  const std::size_t objects = state_.size();
  out.loose.resize(objects + width);
  // Long runs have that many objects, or, while there are absent ones, end at a node's border.
  out.runs.reserve(objects / shortest_run + 1);
  out.places.reserve(nodes_.size() * width);
  out.pending.reserve(nodes_.size());
  out.pending_leaves.reserve(leaves_.size());
  out.undecided.reserve(objects);
}

std::size_t WideSelection::bytes() const {
  const auto size = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  return size(runs) + size(pending) + size(pending_leaves) + size(places) + size(undecided) +
         size(loose);
}

std::size_t WideBvh::bytes() const {
  const auto size = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  return size(nodes_) + size(leaves_) + size(objects_) + size(first_place_) + size(node_parent_) +
         size(leaf_parent_) + size(slot_) + size(state_) + size(absent_bits_) + size(apart_) +
         size(dirty_leaves_) + size(dirty_nodes_) + size(items_) + size(keys_) +
         size(key_scratch_) + size(tree_counts_) + size(tree_order_) + size(sources_);
}

void WideBvh::audit(std::span<const Aabb> boxes) const {
  std::vector<std::uint32_t> times_seen(boxes.size());
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    const WideNode& at = nodes_[node];
    for (std::uint32_t lane = 0; lane < at.child_count; ++lane) {
      const bool is_leaf = lane >= at.inner_count;
      const std::uint32_t child =
          is_leaf ? at.first_leaf + lane - at.inner_count : at.first_inner + lane;
      const std::uint32_t here = static_cast<std::uint32_t>(node) * width + lane;
      const std::uint32_t parent = (is_leaf ? leaf_parent_ : node_parent_)[child];
      if (parent != here) broken("a child does not know its parent");
      const BoxBlock& below = is_leaf ? leaves_[child] : nodes_[child].boxes;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at.boxes.bounds[axis][lane] > smallest(below.bounds[axis]) ||
            at.boxes.bounds[axis + 3][lane] < largest(below.bounds[axis + 3])) {
          broken("node " + std::to_string(node) + " does not hold its child " +
                 std::to_string(lane));
        }
      }
      for (std::uint32_t place = at.first[lane]; is_leaf && place < at.first[lane + 1]; ++place) {
        const ObjectId object = objects_[place];
        ++times_seen[object];
        if (slot_[object] != child * width + (place - at.first[lane])) {
          broken("object " + std::to_string(object) + " is not where it thinks");
        }
      }
    }
  }
  for (const ObjectId object : apart_) {
    if (slot_[object] == nowhere) ++times_seen[object];
  }
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    const std::string name = "object " + std::to_string(object);
    if (times_seen[object] != 1) broken(name + " is lost, or more than once in");
    const std::uint32_t slot = slot_[object];
    if (slot == nowhere) continue;
    const bool here = (state_[object] & present) != 0 && (state_[object] & apart) == 0;
    const std::uint32_t place = first_place_[slot / width] + slot % width;
    if (test_bit(absent_bits_, place) == here) broken(name + " is marked wrongly");
    const auto& bounds = leaves_[slot / width].bounds;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const float low = here ? boxes[object].min[axis] - origin_[axis] : nothing;
      const float high = here ? boxes[object].max[axis] - origin_[axis] : -nothing;
      if (bounds[a][slot % width] != low || bounds[a + 3][slot % width] != high) {
        broken("the leaf does not have the box of " + name);
      }
    }
  }
}

}  // namespace vislab
