#include "common/spatial/wide_bvh_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/spatial/wide_bvh_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cstring>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t width = BoxBlock::width;
using Floats = hn::CappedTag<float, width>;
using Ids = hn::CappedTag<std::uint32_t, width>;

/// A plane, and where its p-vertex lies in a block (its n-vertex is at the other end).
struct PlaneReader {
  float x, y, z, d;
  std::size_t p_x, p_y, p_z;  // floats from the block's start
  std::size_t n_x, n_y, n_z;
};

PlaneReader reader_of(const FilterPlane& plane) {
  constexpr std::size_t to_max = 3 * width;
  PlaneReader reader{plane.x, plane.y, plane.z, plane.d, 0, width, 2 * width, 0, width, 2 * width};
  (plane.x >= 0.0F ? reader.p_x : reader.n_x) += to_max;
  (plane.y >= 0.0F ? reader.p_y : reader.n_y) += to_max;
  (plane.z >= 0.0F ? reader.p_z : reader.n_z) += to_max;
  return reader;
}

struct BlockSides {
  std::uint32_t outside = 0;                               // bit by lane
  std::uint32_t crossing = 0;                              // bit by lane: is anything in crossed?
  alignas(32) std::array<std::uint32_t, width> crossed{};  // by lane: planes not surely inside of
};

class Walk {
 public:
  Walk(const WideBvhView& tree, const FrustumFilter& filter, const WideBvh::QueryOptions& options,
       std::uint32_t shortest_run, WideSelection& out)
      : tree_(tree), options_(options), shortest_run_(shortest_run), out_(out) {
    for (const FilterPlane& plane : filter.planes()) planes_[plane_count_++] = reader_of(plane);
    loose_ = out.loose.data();
  }

  HWY_ATTR void run() {
    const std::uint32_t all_planes = (1U << plane_count_) - 1;
    // First in, first out: what is to be visited is known long before, and can be fetched.
    std::vector<WideSelection::Pending>& pending = out_.pending;
    std::vector<WideSelection::PendingLeaf>& leaves = out_.pending_leaves;
    pending.assign(1, {0, all_planes});
    leaves.clear();
    for (std::size_t i = 0; i < pending.size(); ++i) {
      if (i + fetch_ahead < pending.size()) fetch(&tree_.nodes[pending[i + fetch_ahead].node]);
      const WideNode& node = tree_.nodes[pending[i].node];
      BlockSides sides;
      test_children(node.boxes, pending[i].planes, sides);
      const std::uint32_t open = ((1U << node.child_count) - 1) & ~sides.outside;
      for (std::uint32_t inside = open & ~sides.crossing; inside != 0;) {
        const auto begin = static_cast<std::uint32_t>(std::countr_zero(inside));
        const auto length = static_cast<std::uint32_t>(std::countr_one(inside >> begin));
        take(node.first[begin], node.first[begin + length]);
        inside &= ~(((1U << length) - 1) << begin);
      }
      for (std::uint32_t lanes = open & sides.crossing; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
        const std::uint32_t planes = options_.masking ? sides.crossed[lane] : all_planes;
        if (lane < node.inner_count) {
          pending.push_back({node.first_inner + lane, planes});
        } else if (options_.keep_intersecting) {
          take(node.first[lane], node.first[lane + 1]);
        } else {
          leaves.push_back({node.first_leaf + lane - node.inner_count, node.first[lane],
                            node.first[lane + 1] - node.first[lane], planes});
        }
      }
    }
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      if (i + fetch_ahead < leaves.size()) {
        fetch(&tree_.leaves[leaves[i + fetch_ahead].leaf]);
        hwy::Prefetch(tree_.objects + leaves[i + fetch_ahead].first);
      }
      test_objects(tree_.leaves[leaves[i].leaf], leaves[i]);
    }
    out_.loose_count = static_cast<std::size_t>(loose_ - out_.loose.data());
  }

 private:
  /// How many visits ahead memory is asked for.
  static constexpr std::size_t fetch_ahead = 8;

  template <typename Block>
  static void fetch(const Block* block) {
    constexpr std::size_t cache_line = 64;
    const char* bytes = reinterpret_cast<const char*>(block);
    for (std::size_t at = 0; at < sizeof(Block); at += cache_line) hwy::Prefetch(bytes + at);
  }

  /// Value of a plane at one corner of each box.
  static HWY_ATTR hn::Vec<Floats> value(const PlaneReader& plane, const float* x, const float* y,
                                        const float* z) {
    const Floats d;
    const auto sum_z = hn::MulAdd(hn::Set(d, plane.z), hn::Load(d, z), hn::Set(d, plane.d));
    const auto sum_yz = hn::MulAdd(hn::Set(d, plane.y), hn::Load(d, y), sum_z);
    return hn::MulAdd(hn::Set(d, plane.x), hn::Load(d, x), sum_yz);
  }

  static HWY_ATTR std::uint32_t bits_of(hn::Mask<Floats> mask) {
    return simd::HWY_NAMESPACE::mask_bits(Floats(), mask);
  }

  HWY_ATTR void test_children(const BoxBlock& block, std::uint32_t planes, BlockSides& sides) {
    const Floats d;
    const Ids du;
    ++out_.blocks_tested;
    out_.plane_tests += static_cast<std::uint64_t>(std::popcount(planes));
    for (std::size_t lane = 0; lane < width; lane += hn::Lanes(d)) {
      const float* boxes = block.bounds[0].data() + lane;
      auto outside = hn::MaskFromVec(hn::Zero(d));
      auto crossed = hn::Zero(du);
      for (std::uint32_t rest = planes; rest != 0; rest &= rest - 1) {
        const auto index = static_cast<std::size_t>(std::countr_zero(rest));
        const PlaneReader& plane = planes_[index];
        const auto far_value =
            value(plane, boxes + plane.p_x, boxes + plane.p_y, boxes + plane.p_z);
        const auto near_value =
            value(plane, boxes + plane.n_x, boxes + plane.n_y, boxes + plane.n_z);
        outside = hn::Or(outside, hn::Lt(far_value, hn::Set(d, -1.0F)));
        const auto not_inside = hn::Not(hn::Gt(near_value, hn::Set(d, 1.0F)));
        crossed = hn::Or(
            crossed, hn::IfThenElseZero(hn::RebindMask(du, not_inside), hn::Set(du, 1U << index)));
      }
      sides.outside |= bits_of(outside) << lane;
      const auto crossing = hn::RebindMask(d, hn::Ne(crossed, hn::Zero(du)));
      sides.crossing |= bits_of(crossing) << lane;
      hn::Store(crossed, du, sides.crossed.data() + lane);
    }
  }

  /// The objects of one leaf.
  HWY_ATTR void test_objects(const BoxBlock& block, const WideSelection::PendingLeaf& leaf) {
    const Floats d;
    const Ids du;
    ++out_.blocks_tested;
    out_.plane_tests += static_cast<std::uint64_t>(std::popcount(leaf.planes));
    for (std::size_t lane = 0; lane < leaf.count; lane += hn::Lanes(d)) {
      const float* boxes = block.bounds[0].data() + lane;
      // Lanes that may be kept, and those of them that surely are.
      auto open = hn::FirstN(d, leaf.count - lane);
      auto sure = open;
      for (std::uint32_t rest = leaf.planes; rest != 0; rest &= rest - 1) {
        const PlaneReader& plane = planes_[static_cast<std::size_t>(std::countr_zero(rest))];
        const auto far_value =
            value(plane, boxes + plane.p_x, boxes + plane.p_y, boxes + plane.p_z);
        open = hn::AndNot(hn::Lt(far_value, hn::Set(d, -1.0F)), open);
        sure = hn::And(sure, hn::Gt(far_value, hn::Set(d, 1.0F)));
      }
      const auto keep = hn::And(open, sure);
      const ObjectId* ids = tree_.objects + leaf.first + lane;
      loose_ += hn::CompressStore(hn::LoadU(du, ids), hn::RebindMask(du, keep), du, loose_);
      for (std::uint32_t rest = bits_of(hn::AndNot(sure, open)); rest != 0; rest &= rest - 1) {
        out_.undecided.push_back(ids[std::countr_zero(rest)]);
      }
    }
  }

  void take(std::uint32_t begin, std::uint32_t end) {
    if (end - begin >= shortest_run_) {
      out_.places.push_back({begin, end});
      return;
    }
    std::memcpy(loose_, tree_.objects + begin, (end - begin) * sizeof(ObjectId));
    loose_ += end - begin;
  }

  WideBvhView tree_;
  std::array<PlaneReader, 6> planes_{};
  std::size_t plane_count_ = 0;
  WideBvh::QueryOptions options_;
  std::uint32_t shortest_run_;
  WideSelection& out_;
  ObjectId* loose_;
};

void walk(const WideBvhView& tree, const FrustumFilter& filter,
          const WideBvh::QueryOptions& options, std::uint32_t shortest_run, WideSelection& out) {
  Walk(tree, filter, options, shortest_run, out).run();
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(walk);

void walk_wide_bvh(const WideBvhView& tree, const FrustumFilter& filter,
                   const WideBvh::QueryOptions& options, std::uint32_t shortest_run,
                   WideSelection& out) {
  HWY_DYNAMIC_DISPATCH(walk)(tree, filter, options, shortest_run, out);
}

}  // namespace vislab
#endif
