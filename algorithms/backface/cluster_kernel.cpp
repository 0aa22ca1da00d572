// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/cluster_kernel.cpp"
#include "algorithms/backface/cluster_kernel.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::backface_culling::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t width = ClusterBlock::width;
using Floats = hn::CappedTag<float, width>;
using FloatVector = hn::Vec<Floats>;

struct EyeVectors {
  FloatVector x, y, z, limit;
  bool perspective;

  explicit HWY_INLINE EyeVectors(const ClusterEye& eye)
      : x(hn::Set(Floats(), eye.position.x)),
        y(hn::Set(Floats(), eye.position.y)),
        z(hn::Set(Floats(), eye.position.z)),
        limit(hn::Set(Floats(), eye.limit)),
        perspective(eye.perspective) {}
};

HWY_INLINE std::uint32_t bits_of(hn::Mask<Floats> mask) {
  return simd::HWY_NAMESPACE::mask_bits(Floats(), mask);
}

/// The ways from the origins of some lanes to the eye, and the extreme values along them.
struct Ways {
  FloatVector x, y, z;

  HWY_INLINE Ways(const EyeVectors& eye, const ClusterBlock& block, std::size_t lane)
      : x(eye.x), y(eye.y), z(eye.z) {
    if (!eye.perspective) return;
    const Floats f;
    x = hn::Sub(x, hn::Load(f, block.origin[0].data() + lane));
    y = hn::Sub(y, hn::Load(f, block.origin[1].data() + lane));
    z = hn::Sub(z, hn::Load(f, block.origin[2].data() + lane));
  }

  /// if(way; negative, positive).way
  HWY_INLINE FloatVector value(const std::array<ClusterBlock::Row, 3>& negative,
                               const std::array<ClusterBlock::Row, 3>& positive,
                               std::size_t lane) const {
    const Floats f;
    const auto chosen = [&](FloatVector way, std::size_t axis) HWY_ATTR {
      return hn::Mul(
          hn::IfThenElse(hn::Gt(way, hn::Zero(f)), hn::Load(f, positive[axis].data() + lane),
                         hn::Load(f, negative[axis].data() + lane)),
          way);
    };
    return hn::Add(hn::Add(chosen(x, 0), chosen(y, 1)), chosen(z, 2));
  }
};

HWY_INLINE hn::Mask<Floats> is_back(const Ways& ways, const EyeVectors& eye,
                                    const ClusterBlock& block, std::size_t lane) {
  FloatVector value = ways.value(block.low, block.high, lane);
  if (eye.perspective) value = hn::Sub(value, hn::Load(Floats(), block.back.data() + lane));
  return hn::Lt(value, hn::Neg(eye.limit));
}

HWY_INLINE std::uint32_t back_lanes(const EyeVectors& eye, const ClusterBlock& block) {
  std::uint32_t back = 0;
  for (std::size_t lane = 0; lane < width; lane += hn::Lanes(Floats())) {
    back |= bits_of(is_back(Ways(eye, block, lane), eye, block, lane)) << lane;
  }
  return back;
}

void find_in_blocks(std::span<const ClusterBlock> blocks, const ClusterEye& eye,
                    std::span<std::uint64_t> back) {
  const EyeVectors eye_vectors(eye);
  for (std::size_t word = 0; word * 4 < blocks.size(); ++word) {
    const std::span<const ClusterBlock> four =
        blocks.subspan(word * 4, std::min<std::size_t>(4, blocks.size() - word * 4));
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < four.size(); ++i) {
      bits |= std::uint64_t{back_lanes(eye_vectors, four[i])} << (i * width);
    }
    back[word] = bits;
  }
}

template <bool with_mixed>
HWY_INLINE void walk_down(std::span<const ClusterTreeNode> tree, const ClusterEye& eye,
                          TreeAnswer& answer) {
  // First in, first out: what is to be visited is known long before, and can be fetched.
  constexpr std::size_t fetch_ahead = 4;
  constexpr std::size_t cache_line = 64;
  answer.nodes_tested = answer.back_count = answer.mixed_count = 0;
  if (tree.empty()) return;
  const EyeVectors eye_vectors(eye);
  std::uint32_t* pending = answer.pending.data();
  std::uint32_t* back_end = answer.back.data();
  std::uint32_t* mixed_end = answer.mixed.data();
  std::size_t pending_count = 0;
  pending[pending_count++] = 0;
  std::size_t at = 0;
  for (; at < pending_count; ++at) {
    if (at + fetch_ahead < pending_count) {
      const char* bytes = reinterpret_cast<const char*>(&tree[pending[at + fetch_ahead]]);
      for (std::size_t i = 0; i < sizeof(ClusterTreeNode); i += cache_line) {
        hwy::Prefetch(bytes + i);
      }
    }
    const std::uint32_t index = pending[at];
    const ClusterTreeNode& node = tree[index];
    std::uint32_t back = 0;
    if (!with_mixed && node.only_clusters) {
      back = back_lanes(eye_vectors, node.children);
    } else {
      std::uint32_t front = 0;
      for (std::size_t lane = 0; lane < width; lane += hn::Lanes(Floats())) {
        const Ways ways(eye_vectors, node.children, lane);
        back |= bits_of(is_back(ways, eye_vectors, node.children, lane)) << lane;
        FloatVector value = ways.value(node.children.high, node.children.low, lane);
        if (eye.perspective) {
          value = hn::Sub(value, hn::Load(Floats(), node.front.data() + lane));
        }
        front |= bits_of(hn::Gt(value, eye_vectors.limit)) << lane;
      }
      std::uint32_t mixed = ((1U << node.count) - 1) & ~(back | front);
      for (; mixed != 0; mixed &= mixed - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(mixed));
        const std::uint32_t child = node.node[lane];
        pending[pending_count] = child;
        pending_count += child != 0 ? 1 : 0;
        if (with_mixed) {
          *mixed_end = index * static_cast<std::uint32_t>(width) + lane;
          mixed_end += child == 0 ? 1 : 0;
        }
      }
    }
    for (; back != 0; back &= back - 1) {
      *back_end++ = index * static_cast<std::uint32_t>(width) +
                    static_cast<std::uint32_t>(std::countr_zero(back));
    }
  }
  answer.nodes_tested = at;
  answer.back_count = static_cast<std::size_t>(back_end - answer.back.data());
  if (with_mixed) answer.mixed_count = static_cast<std::size_t>(mixed_end - answer.mixed.data());
}

void walk(std::span<const ClusterTreeNode> tree, const ClusterEye& eye, TreeAnswer& answer) {
  walk_down<false>(tree, eye, answer);
}
void walk_with_mixed(std::span<const ClusterTreeNode> tree, const ClusterEye& eye,
                     TreeAnswer& answer) {
  walk_down<true>(tree, eye, answer);
}

}  // namespace
}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

HWY_EXPORT(find_in_blocks);
HWY_EXPORT(walk);
HWY_EXPORT(walk_with_mixed);

void ClusterBlock::set(std::size_t lane, const ClusterBound& bound) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto row = static_cast<std::size_t>(axis);
    origin[row][lane] = bound.origin[axis];
    low[row][lane] = bound.low[axis];
    high[row][lane] = bound.high[axis];
  }
  back[lane] = bound.back;
}

void TreeAnswer::reserve(std::size_t nodes) {
  pending.resize(std::max(pending.size(), nodes + 1));
  back.resize(std::max(back.size(), nodes * ClusterBlock::width));
  // Where none is mixed the walk writes one too many.
  mixed.resize(std::max(mixed.size(), nodes * ClusterBlock::width + 1));
}

void find_back(std::span<const ClusterBlock> blocks, const ClusterEye& eye,
               std::span<std::uint64_t> back) {
  HWY_DYNAMIC_DISPATCH(find_in_blocks)(blocks, eye, back);
}

void find_back(std::span<const ClusterTreeNode> tree, const ClusterEye& eye, TreeAnswer& answer) {
  HWY_DYNAMIC_DISPATCH(walk)(tree, eye, answer);
}

void find_back_and_mixed(std::span<const ClusterTreeNode> tree, const ClusterEye& eye,
                         TreeAnswer& answer) {
  HWY_DYNAMIC_DISPATCH(walk_with_mixed)(tree, eye, answer);
}

}  // namespace vislab::backface_culling
#endif  // HWY_ONCE
