#include "algorithms/frustum/flat_boxes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

namespace vislab::frustum_culling {
namespace {

constexpr std::uint64_t all_bits = ~std::uint64_t{0};

/// Fewer boxes are done before a second thread has woken up.
constexpr std::size_t parallel_boxes = std::size_t{1} << 18;
/// Blocks whose boxes make one BoxBlock; threads share the work in multiples of it.
constexpr std::size_t blocks_in_share = block_size;

/// Frames that must have gained from an order before the boxes are ordered again.
constexpr int frames_before_reorder = 256;
constexpr double surface_before_reorder = 2.0;

std::size_t blocks_for(std::size_t count) { return (count + block_size - 1) / block_size; }

float reach_of(const Aabb& box, const glm::vec3& origin) {
  const glm::vec3 low = glm::abs(box.min - origin);
  const glm::vec3 high = glm::abs(box.max - origin);
  const glm::vec3 both = glm::max(low, high);
  return std::max({both.x, both.y, both.z});
}

void fill_with_nan(std::vector<BoxBlock>& blocks) {
  for (BoxBlock& block : blocks) {
    for (auto& row : block.rows) row.fill(std::numeric_limits<float>::quiet_NaN());
  }
}

}  // namespace

FlatBoxes::FlatBoxes(Order order, int threads)
    : order_(order), threads_(threads), arena_(threads) {}

void FlatBoxes::build(std::span<const Aabb> boxes) {
  is_shown_.assign(boxes.size(), 1);
  arrange(boxes);
}

void FlatBoxes::arrange(std::span<const Aabb> boxes) {
  const std::size_t block_count = blocks_for(boxes.size());
  choose_origin(boxes);
  choose_order(boxes);
  blocks_.resize(block_count);
  fill_with_nan(blocks_);
  shown_.assign(block_count, 0);
  strays_.assign(block_count, 0);
  stray_count_ = 0;
  shown_count_ = 0;
  for (std::size_t slot = 0; slot < boxes.size(); ++slot) {
    place(slot, boxes[object_at_[slot]]);
    set_shown(object_at_[slot], is_shown_[object_at_[slot]] != 0);
  }
  // The rest of the last block has some box of it, so that there is no NaN without a stray.
  for (std::size_t slot = boxes.size(); slot < block_count * block_size; ++slot) {
    for (auto& row : blocks_.back().rows) {
      row[slot % block_size] = row[(boxes.size() - 1) % block_size];
    }
  }
  words_.resize(block_count);
  kept_.resize(block_count);
  strays_at_build_ = stray_count_;
  frames_since_build_ = 0;
  if (order_ == Order::ids) return;
  const std::size_t shares = blocks_for(block_count);
  block_boxes_.resize(shares);
  fill_with_nan(block_boxes_);
  states_.resize(shares * block_size);
  dirty_.assign(block_count, 0);
  dirty_list_.clear();
  dirty_list_.reserve(block_count);
  surface_ = 0.0;
  for (std::size_t block = 0; block < block_count; ++block) {
    enclose(block);
    surface_ += surface_of(block);
  }
  surface_at_build_ = surface_;
}

void FlatBoxes::choose_origin(std::span<const Aabb> boxes) {
  // The middle of a sample, and a reach that leaves out what lies far outside of the rest: the
  // margin of all grows with it.
  constexpr std::size_t sample_size = 1024;
  const std::size_t stride = boxes.size() / sample_size + 1;
  const auto sample = [&](auto&& value_of) {
    scratch_.clear();
    for (std::size_t i = 0; i < boxes.size(); i += stride) {
      if (boxes[i].valid()) scratch_.push_back(value_of(boxes[i]));
    }
  };
  const auto rank = [&](std::size_t index) {
    std::ranges::nth_element(scratch_, scratch_.begin() + static_cast<std::ptrdiff_t>(index));
    return scratch_[index];
  };
  origin_ = glm::vec3(0.0F);
  extent_ = 1.0F;
  for (int axis = 0; axis < 3; ++axis) {
    sample([axis](const Aabb& box) { return box.min[axis] * 0.5F + box.max[axis] * 0.5F; });
    if (scratch_.empty()) return;
    origin_[axis] = rank(scratch_.size() / 2);
  }
  sample([&](const Aabb& box) { return reach_of(box, origin_); });
  const float usual = rank(scratch_.size() - 1 - scratch_.size() / 64);
  const float limit = 8.0F * usual;
  float reach = 0.0F;
  for (const Aabb& box : boxes) {
    const float of_box = reach_of(box, origin_);
    if (of_box <= limit) reach = std::max(reach, of_box);
  }
  // Twice as far, so that what moves stays within.
  constexpr float greatest = std::numeric_limits<float>::max();
  extent_ = std::min(2.0F * reach, greatest);
}

void FlatBoxes::choose_order(std::span<const Aabb> boxes) {
  object_at_.assign(blocks_for(boxes.size()) * block_size, 0);
  slot_of_.resize(boxes.size());
  if (order_ == Order::ids) {
    for (ObjectId object = 0; object < boxes.size(); ++object) object_at_[object] = object;
  } else {
    centers_.resize(boxes.size());
    // Strays go to the end, so that few blocks have them.
    std::size_t regular = 0;
    std::size_t strays = boxes.size();
    for (ObjectId object = 0; object < boxes.size(); ++object) {
      const Aabb& box = boxes[object];
      const glm::vec3 center = box.min * 0.5F + box.max * 0.5F;
      if (box.valid() && reach_of(box, origin_) <= extent_) {
        centers_[regular++] = {{center.x, center.y, center.z}, object};
      } else {
        centers_[--strays] = {{}, object};
      }
    }
    split(0, regular);
    for (std::size_t slot = 0; slot < boxes.size(); ++slot) {
      object_at_[slot] = centers_[slot].object;
    }
  }
  for (std::uint32_t slot = 0; slot < boxes.size(); ++slot) slot_of_[object_at_[slot]] = slot;
}

void FlatBoxes::split(std::size_t first, std::size_t last) {
  if (last - first <= block_size) return;
  std::array<float, 3> low = centers_[first].at;
  std::array<float, 3> high = low;
  for (std::size_t i = first; i < last; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], centers_[i].at[axis]);
      high[axis] = std::max(high[axis], centers_[i].at[axis]);
    }
  }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
  }
  const std::size_t middle = first + blocks_for(last - first) / 2 * block_size;
  const auto at = [&](std::size_t i) { return centers_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last), [longest](const Center& a, const Center& b) {
    return a.at[longest] < b.at[longest] || (a.at[longest] == b.at[longest] && a.object < b.object);
  });
  split(first, middle);
  split(middle, last);
}

void FlatBoxes::place(std::size_t slot, const Aabb& box) {
  const std::size_t lane = slot % block_size;
  const std::uint64_t bit = std::uint64_t{1} << lane;
  std::uint64_t& strays = strays_[slot / block_size];
  const bool regular = box.valid() && reach_of(box, origin_) <= extent_;
  if ((strays & bit) != 0) --stray_count_;
  if (!regular) ++stray_count_;
  strays = regular ? strays & ~bit : strays | bit;
  auto& rows = blocks_[slot / block_size].rows;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<int>(axis);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    rows[BoxBlock::min_x + axis][lane] = regular ? box.min[a] - origin_[a] : nan;
    rows[BoxBlock::max_x + axis][lane] = regular ? box.max[a] - origin_[a] : nan;
  }
}

void FlatBoxes::set_shown(ObjectId object, bool shown) {
  const std::size_t slot = slot_of_[object];
  const std::uint64_t bit = std::uint64_t{1} << (slot % block_size);
  std::uint64_t& word = shown_[slot / block_size];
  if ((word & bit) != 0) --shown_count_;
  if (shown) ++shown_count_;
  word = shown ? word | bit : word & ~bit;
  is_shown_[object] = shown ? 1 : 0;
}

void FlatBoxes::enclose(std::size_t block) {
  BoxBlock& outer = block_boxes_[block / block_size];
  const std::size_t lane = block % block_size;
  if (strays_[block] == 0) {
    enclose_block(blocks_[block], outer, lane);
  } else {
    for (auto& row : outer.rows) row[lane] = std::numeric_limits<float>::quiet_NaN();
  }
}

double FlatBoxes::surface_of(std::size_t block) const {
  if (strays_[block] != 0) return 0.0;
  const BoxBlock& outer = block_boxes_[block / block_size];
  std::array<double, 3> side{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    side[axis] = static_cast<double>(outer.rows[BoxBlock::max_x + axis][block % block_size]) -
                 outer.rows[BoxBlock::min_x + axis][block % block_size];
  }
  return 2.0 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]);
}

void FlatBoxes::update(std::span<const Aabb> boxes, const Changes& changes) {
  ++frames_since_build_;
  for (const ObjectId object : changes.hidden) set_shown(object, false);
  for (const ObjectId object : changes.shown) set_shown(object, true);
  for (const ObjectId object : changes.moved) {
    const std::size_t slot = slot_of_[object];
    const std::size_t block = slot / block_size;
    if (order_ == Order::groups && dirty_[block] == 0) {
      dirty_[block] = 1;
      dirty_list_.push_back(static_cast<std::uint32_t>(block));
      surface_ -= surface_of(block);
    }
    place(slot, boxes[object]);
  }
  if (blocks_.empty()) return;
  // The last object's box may be what fills the last block up.
  const std::size_t last = slot_of_.size() - 1;
  for (auto& row : blocks_.back().rows) {
    for (std::size_t lane = last % block_size + 1; lane < block_size; ++lane) {
      row[lane] = row[last % block_size];
    }
  }
  for (const std::uint32_t block : dirty_list_) {
    enclose(block);
    surface_ += surface_of(block);
    dirty_[block] = 0;
  }
  dirty_list_.clear();
  const bool strayed = stray_count_ > strays_at_build_ + block_size + boxes.size() / 64;
  const bool widened = order_ == Order::groups &&
                       surface_ > surface_before_reorder * surface_at_build_ &&
                       frames_since_build_ >= frames_before_reorder;
  if (strayed || widened) arrange(boxes);
}

std::span<const std::uint64_t> FlatBoxes::cull(const Frustum& frustum,
                                               std::span<const Aabb> boxes) {
  const FrustumFilter filter(frustum, origin_, extent_);
  if (threads_ == 1 || boxes.size() < parallel_boxes) {
    plane_tests_ += cull_blocks(frustum, filter, boxes, 0, blocks_.size());
    return kept_;
  }
  using Range = tbb::blocked_range<std::size_t>;
  const Range shares(0, blocks_for(blocks_.size()), 4);
  plane_tests_ += arena_.execute([&] {
    return tbb::parallel_reduce(
        shares, std::uint64_t{0},
        [&](const Range& range, std::uint64_t tests) {
          return tests + cull_blocks(frustum, filter, boxes, range.begin() * blocks_in_share,
                                     std::min(range.end() * blocks_in_share, blocks_.size()));
        },
        std::plus<>());
  });
  return kept_;
}

/// Blocks `first` to `last`, where `first` begins a share. Returns the number of plane tests.
std::uint64_t FlatBoxes::cull_blocks(const Frustum& frustum, const FrustumFilter& filter,
                                     std::span<const Aabb> boxes, std::size_t first,
                                     std::size_t last) {
  const auto planes = filter.planes();
  const std::size_t count = last - first;
  const std::span<const BoxBlock> blocks = std::span(blocks_).subspan(first, count);
  const std::span<BoxWord> words = std::span(words_).subspan(first, count);
  std::uint64_t tests = 0;
  if (order_ == Order::ids) {
    test_boxes(planes, blocks, words);
    tests = count * block_size * planes.size();
  } else {
    const std::size_t shares = blocks_for(count);
    const std::span<BlockState> states =
        std::span(states_).subspan(first, shares * blocks_in_share);
    test_block_boxes(planes, std::span(block_boxes_).subspan(first / blocks_in_share, shares),
                     states);
    test_boxes(planes, blocks, states.first(count), words);
    tests = count * planes.size();
    for (std::size_t b = 0; b < count; ++b) {
      tests +=
          block_size * static_cast<unsigned>(std::popcount<BlockState>(states[b] & ~outside_block));
    }
  }
  for (std::size_t b = 0; b < count; ++b) {
    std::uint64_t kept = words[b].kept & shown_[first + b];
    const std::uint64_t undecided = words[b].undecided & shown_[first + b];
    if (undecided != 0) kept |= resolve(frustum, boxes, first + b, undecided);
    kept_[first + b] = kept;
  }
  return tests;
}

/// Those of the undecided boxes of a block that the double test keeps.
std::uint64_t FlatBoxes::resolve(const Frustum& frustum, std::span<const Aabb> boxes,
                                 std::size_t block, std::uint64_t undecided) const {
  std::uint64_t kept = 0;
  for (std::uint64_t left = undecided; left != 0; left &= left - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(left));
    const Aabb& box = boxes[object_at_[block * block_size + lane]];
    const bool outside = std::ranges::any_of(
        frustum.span(), [&](const Plane& plane) { return surely_outside(plane, box); });
    if (!outside) kept |= std::uint64_t{1} << lane;
  }
  return kept;
}

std::size_t FlatBoxes::bytes() const {
  return (blocks_.capacity() + block_boxes_.capacity()) * sizeof(BoxBlock) +
         words_.capacity() * sizeof(BoxWord) +
         (shown_.capacity() + strays_.capacity() + kept_.capacity()) * sizeof(std::uint64_t) +
         (object_at_.capacity() + slot_of_.capacity() + dirty_list_.capacity()) *
             sizeof(std::uint32_t) +
         centers_.capacity() * sizeof(Center) + scratch_.capacity() * sizeof(float) +
         is_shown_.capacity() + states_.capacity() + dirty_.capacity();
}

std::size_t select_ids(std::span<const std::uint64_t> words, std::span<const ObjectId> ids,
                       ObjectId* out) {
  ObjectId* const start = out;
  for (std::size_t w = 0; w < words.size(); ++w) {
    const ObjectId* const block = ids.data() + w * block_size;
    if (words[w] == all_bits) {
      out = std::copy_n(block, block_size, out);
      continue;
    }
    for (std::uint64_t left = words[w]; left != 0; left &= left - 1) {
      *out++ = block[std::countr_zero(left)];
    }
  }
  return static_cast<std::size_t>(out - start);
}

}  // namespace vislab::frustum_culling
