// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/cluster_planes.cpp"
#include "algorithms/backface/cluster_planes.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::backface_culling::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Block = ClusterPlanes::Block;
using Part = ClusterPlanes::Part;
using Floats = hn::CappedTag<float, ClusterPlanes::width>;

HWY_INLINE std::uint64_t bits_of(hn::Mask<Floats> mask) {
  return simd::HWY_NAMESPACE::mask_bits(Floats(), mask);
}

void mark_parts(const Block* blocks, std::span<const Part> parts,
                std::span<const std::uint32_t> first_part, std::span<const std::uint32_t> clusters,
                const PlaneTest& test, const RunList& runs, std::uint64_t* bits) {
  constexpr std::size_t fetch_ahead = 4;
  constexpr std::uint32_t most_fetched = 8;  // blocks
  const Floats f;
  const auto eye_x = hn::Set(f, test.x);
  const auto eye_y = hn::Set(f, test.y);
  const auto eye_z = hn::Set(f, test.z);
  const auto eye_w = hn::Set(f, test.w);
  const auto limit = hn::Set(f, -test.limit);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (i + fetch_ahead < clusters.size()) {
      const std::uint32_t soon = first_part[clusters[i + fetch_ahead]];
      const std::uint32_t end = std::min(parts[soon].block + most_fetched, parts[soon + 1].block);
      for (std::uint32_t block = parts[soon].block; block < end; ++block) {
        hwy::Prefetch(&blocks[block].row[0]);
        hwy::Prefetch(&blocks[block].row[2]);
      }
    }
    const std::uint32_t end = first_part[clusters[i] + 1];
    for (std::uint32_t part = first_part[clusters[i]]; part < end; ++part) {
      std::uint64_t behind = 0;
      std::uint32_t shift = 0;
      for (std::uint32_t b = parts[part].block; b < parts[part + 1].block; ++b) {
        const Block& block = blocks[b];
        for (std::size_t lane = 0; lane < ClusterPlanes::width; lane += hn::Lanes(f)) {
          // No fused multiply-add: it would round differently where there is one.
          const auto xy = hn::Add(hn::Mul(hn::Load(f, block.row[0].data() + lane), eye_x),
                                  hn::Mul(hn::Load(f, block.row[1].data() + lane), eye_y));
          const auto zd = hn::Add(hn::Mul(hn::Load(f, block.row[2].data() + lane), eye_z),
                                  hn::Mul(hn::Load(f, block.row[3].data() + lane), eye_w));
          behind |= bits_of(hn::Lt(hn::Add(xy, zd), limit)) << shift;
          shift += static_cast<std::uint32_t>(hn::Lanes(f));
        }
      }
      if (behind != 0) runs.mark_chosen(parts[part].run, parts[part + 1].run, behind, bits);
    }
  }
}

}  // namespace
}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

HWY_EXPORT(mark_parts);

ClusterPlanes::ClusterPlanes(const Mesh& mesh, const MeshFrame& frame,
                             const TriangleClusters& clusters)
    : first_triangle_(clusters.first) {
  constexpr std::size_t most = 64;  // triangles of a part
  RunList::check(mesh.triangles.size());
  blocks_.reserve(mesh.triangles.size() / width + clusters.count());
  const auto here = [&] { return Part{static_cast<std::uint32_t>(blocks_.size()), runs_.size()}; };
  for (std::uint32_t cluster = 0; cluster < clusters.count(); ++cluster) {
    first_part_.push_back(static_cast<std::uint32_t>(parts_.size()));
    std::span<const std::uint32_t> rest = clusters.of(cluster);
    while (!rest.empty()) {
      const auto part = rest.first(std::min(most, rest.size()));
      parts_.push_back(here());
      runs_.append(part);
      for (std::size_t i = 0; i < part.size(); ++i) {
        if (i % width == 0) blocks_.emplace_back();
        const std::array<float, 4> plane = rounded_plane(mesh, frame, part[i]);
        for (std::size_t row = 0; row < 4; ++row) blocks_.back().row[row][i % width] = plane[row];
      }
      rest = rest.subspan(part.size());
    }
  }
  first_part_.push_back(static_cast<std::uint32_t>(parts_.size()));
  parts_.push_back(here());
  blocks_.shrink_to_fit();
  parts_.shrink_to_fit();
  first_part_.shrink_to_fit();
  runs_.shrink();
}

void ClusterPlanes::mark(std::span<const std::uint32_t> clusters, const PlaneTest& test,
                         std::uint64_t* bits) const {
  HWY_DYNAMIC_DISPATCH(mark_parts)
  (blocks_.data(), parts_, first_part_, clusters, test, runs_, bits);
}

std::size_t ClusterPlanes::bytes() const {
  return blocks_.capacity() * sizeof(Block) + parts_.capacity() * sizeof(Part) +
         (first_part_.capacity() + first_triangle_.capacity()) * sizeof(std::uint32_t) +
         runs_.bytes();
}

}  // namespace vislab::backface_culling
#endif  // HWY_ONCE
