// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/frustum/box_kernel.cpp"
#include "algorithms/frustum/box_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::frustum_culling::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using FloatVector = hn::Vec<Floats>;
constexpr std::size_t lanes = HWY_MIN(HWY_LANES(float), 16);
constexpr std::size_t vectors_in_block = block_size / lanes;

/// The rows of the corner that is farthest along the normal, or nearest.
struct Corner {
  const float* x;
  const float* y;
  const float* z;
};

HWY_INLINE Corner p_vertex(const FilterPlane& plane, const BoxBlock& block) {
  return {block.rows[plane.x >= 0.0F ? BoxBlock::max_x : BoxBlock::min_x].data(),
          block.rows[plane.y >= 0.0F ? BoxBlock::max_y : BoxBlock::min_y].data(),
          block.rows[plane.z >= 0.0F ? BoxBlock::max_z : BoxBlock::min_z].data()};
}

HWY_INLINE Corner n_vertex(const FilterPlane& plane, const BoxBlock& block) {
  return {block.rows[plane.x >= 0.0F ? BoxBlock::min_x : BoxBlock::max_x].data(),
          block.rows[plane.y >= 0.0F ? BoxBlock::min_y : BoxBlock::max_y].data(),
          block.rows[plane.z >= 0.0F ? BoxBlock::min_z : BoxBlock::max_z].data()};
}

struct PlaneVectors {
  FloatVector x, y, z, d;

  explicit HWY_INLINE PlaneVectors(const FilterPlane& plane)
      : x(hn::Set(Floats(), plane.x)),
        y(hn::Set(Floats(), plane.y)),
        z(hn::Set(Floats(), plane.z)),
        d(hn::Set(Floats(), plane.d)) {}

  HWY_INLINE FloatVector value(const Corner& corner, std::size_t lane) const {
    const Floats f;
    return hn::MulAdd(x, hn::Load(f, corner.x + lane),
                      hn::MulAdd(y, hn::Load(f, corner.y + lane),
                                 hn::MulAdd(z, hn::Load(f, corner.z + lane), d)));
  }
};

HWY_INLINE std::uint64_t bits_of(hn::Mask<Floats> mask) {
  return simd::HWY_NAMESPACE::mask_bits(Floats(), mask);
}

/// The least values of a block's boxes over some planes, in registers.
class LeastValues {
 public:
  /// To be called for the first plane.
  HWY_INLINE void start(const FilterPlane& plane, const BoxBlock& block) {
    const PlaneVectors p(plane);
    const Corner corner = p_vertex(plane, block);
    for (std::size_t v = 0; v < vectors_in_block; ++v) least_[v] = p.value(corner, v * lanes);
  }
  HWY_INLINE void add(const FilterPlane& plane, const BoxBlock& block) {
    const PlaneVectors p(plane);
    const Corner corner = p_vertex(plane, block);
    for (std::size_t v = 0; v < vectors_in_block; ++v) {
      least_[v] = hn::Min(least_[v], p.value(corner, v * lanes));
    }
  }
  HWY_INLINE BoxWord word() const {
    const auto margin = hn::Set(Floats(), 1.0F);
    std::uint64_t kept = 0;
    auto all_decided = hn::Gt(hn::Abs(least_[0]), margin);
    for (std::size_t v = 0; v < vectors_in_block; ++v) {
      kept |= bits_of(hn::Gt(least_[v], margin)) << (v * lanes);
      all_decided = hn::And(all_decided, hn::Gt(hn::Abs(least_[v]), margin));
    }
    if (hn::AllTrue(Floats(), all_decided)) return {kept, 0};
    std::uint64_t decided = 0;
    for (std::size_t v = 0; v < vectors_in_block; ++v) {
      decided |= bits_of(hn::Gt(hn::Abs(least_[v]), margin)) << (v * lanes);
    }
    return {kept, ~decided};
  }

 private:
  FloatVector least_[vectors_in_block];
};

void test_all(std::span<const FilterPlane> planes, std::span<const BoxBlock> blocks,
              std::span<BoxWord> words) {
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    LeastValues values;
    values.start(planes[0], blocks[b]);
    for (std::size_t i = 1; i < planes.size(); ++i) values.add(planes[i], blocks[b]);
    words[b] = values.word();
  }
}

void test_some(std::span<const FilterPlane> planes, std::span<const BoxBlock> blocks,
               std::span<const BlockState> states, std::span<BoxWord> words) {
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    std::uint32_t left = states[b];
    if (left == outside_block) {
      words[b] = {};
    } else if (left == 0) {
      words[b] = {~std::uint64_t{0}, 0};
    } else {
      LeastValues values;
      values.start(planes[hwy::Num0BitsBelowLS1Bit_Nonzero32(left)], blocks[b]);
      for (left &= left - 1; left != 0; left &= left - 1) {
        values.add(planes[hwy::Num0BitsBelowLS1Bit_Nonzero32(left)], blocks[b]);
      }
      words[b] = values.word();
    }
  }
}

void test_outer(std::span<const FilterPlane> planes, std::span<const BoxBlock> boxes,
                std::span<BlockState> states) {
  using Bits = hn::RebindToSigned<Floats>;
  const Floats f;
  const Bits bits;
  const auto margin = hn::Set(f, 1.0F);
  const auto below = hn::Set(f, -1.0F);
  const auto outside = hn::Set(bits, outside_block);
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    HWY_ALIGN std::int32_t state[block_size];
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const PlaneVectors p(planes[i]);
      const Corner far = p_vertex(planes[i], boxes[b]);
      const Corner near = n_vertex(planes[i], boxes[b]);
      const auto bit = hn::Set(bits, static_cast<std::int32_t>(1U << i));
      for (std::size_t lane = 0; lane < block_size; lane += lanes) {
        auto now = i == 0 ? hn::Zero(bits) : hn::Load(bits, state + lane);
        const auto is_outside = hn::RebindMask(bits, hn::Lt(p.value(far, lane), below));
        const auto is_inside = hn::RebindMask(bits, hn::Gt(p.value(near, lane), margin));
        now = hn::Or(now, hn::IfThenZeroElse(is_inside, bit));
        now = hn::Or(now, hn::IfThenElseZero(is_outside, outside));
        hn::Store(now, bits, state + lane);
      }
    }
    for (std::size_t lane = 0; lane < block_size; ++lane) {
      const auto value = static_cast<BlockState>(state[lane]);
      states[b * block_size + lane] = (value & outside_block) != 0 ? outside_block : value;
    }
  }
}

void enclose(const BoxBlock& block, BoxBlock& outer, std::size_t lane) {
  const Floats f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* lows = block.rows[BoxBlock::min_x + axis].data();
    const float* highs = block.rows[BoxBlock::max_x + axis].data();
    auto low = hn::Load(f, lows);
    auto high = hn::Load(f, highs);
    for (std::size_t l = lanes; l < block_size; l += lanes) {
      low = hn::Min(low, hn::Load(f, lows + l));
      high = hn::Max(high, hn::Load(f, highs + l));
    }
    outer.rows[BoxBlock::min_x + axis][lane] = hn::GetLane(hn::MinOfLanes(f, low));
    outer.rows[BoxBlock::max_x + axis][lane] = hn::GetLane(hn::MaxOfLanes(f, high));
  }
}

}  // namespace vislab::frustum_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::frustum_culling {

HWY_EXPORT(test_all);
HWY_EXPORT(test_some);
HWY_EXPORT(test_outer);
HWY_EXPORT(enclose);

void test_boxes(std::span<const FilterPlane> planes, std::span<const BoxBlock> blocks,
                std::span<BoxWord> words) {
  HWY_DYNAMIC_DISPATCH(test_all)(planes, blocks, words);
}

void test_boxes(std::span<const FilterPlane> planes, std::span<const BoxBlock> blocks,
                std::span<const BlockState> states, std::span<BoxWord> words) {
  HWY_DYNAMIC_DISPATCH(test_some)(planes, blocks, states, words);
}

void test_block_boxes(std::span<const FilterPlane> planes, std::span<const BoxBlock> boxes,
                      std::span<BlockState> states) {
  HWY_DYNAMIC_DISPATCH(test_outer)(planes, boxes, states);
}

void enclose_block(const BoxBlock& block, BoxBlock& outer, std::size_t lane) {
  HWY_DYNAMIC_DISPATCH(enclose)(block, outer, lane);
}

}  // namespace vislab::frustum_culling
#endif  // HWY_ONCE
