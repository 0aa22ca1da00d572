#include "common/raster/masked_depth.h"

#include <algorithm>
#include <bit>

#include "common/raster/setup_kernel.h"
#include "common/raster/tile_store.h"

namespace vislab {
namespace {

constexpr std::uint64_t all_pixels = ~std::uint64_t{0};

/// Pixels [x0, x1) x [y0, y1) of a tile, within 0 … tile_size.
std::uint64_t rectangle_mask(int x0, int y0, int x1, int y1) {
  const std::uint64_t row = (0xFFULL >> static_cast<unsigned>(tile_size - (x1 - x0)))
                            << static_cast<unsigned>(x0);
  const std::uint64_t rows = row * 0x0101010101010101ULL;
  const std::uint64_t from = all_pixels << static_cast<unsigned>(tile_size * y0);
  const std::uint64_t to = all_pixels >> static_cast<unsigned>(tile_size * (tile_size - y1));
  return rows & from & to;
}

}  // namespace

struct MaskedDepth::Work {
  std::vector<ClusterDraw> clusters;
  SetupScratch scratch;
  std::vector<PartialTile> partial;
  std::vector<TileCoverage> coverage;
};

MaskedDepth::MaskedDepth(const Viewport& size, const RasterOptions& options, LayerMerge merge)
    : options_(options),
      merge_(merge),
      window_(Camera{}, size),
      tiles_x_((size.width + tile_size - 1) / tile_size),
      tiles_y_((size.height + tile_size - 1) / tile_size),
      work_(std::make_unique<Work>()) {
  check_buffer_size(size);
  const auto tiles = static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_);
  reference_.resize(tiles);
  working_.resize(tiles);
  mask_.resize(tiles);
  outside_.resize(tiles);
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const int x = static_cast<int>(tile) % tiles_x_ * tile_size;
    const int y = static_cast<int>(tile) / tiles_x_ * tile_size;
    outside_[tile] = ~rectangle_mask(0, 0, std::min(tile_size, size.width - x),
                                     std::min(tile_size, size.height - y));
  }
}
MaskedDepth::~MaskedDepth() = default;
MaskedDepth::MaskedDepth(MaskedDepth&&) noexcept = default;
MaskedDepth& MaskedDepth::operator=(MaskedDepth&&) noexcept = default;

void MaskedDepth::begin(const Camera& camera) {
  window_ = WindowTransform(camera, window_.viewport());
  std::ranges::fill(reference_, static_cast<float>(window_.nearness(camera.lens.far_m)));
  std::ranges::fill(mask_, std::uint64_t{0});
}

std::size_t MaskedDepth::draw(std::span<const RasterDraw> draws) {
  Work& work = *work_;
  work.clusters.clear();
  find_clusters(ClusterPlanes(window_), draws, work.clusters);
  SetupScratch& scratch = work.scratch;
  scratch.drawn = 0;
  const RasterDraw* rows_of = nullptr;
  WindowRows rows;
  for (const ClusterDraw& cluster : work.clusters) {
    if (cluster.draw != rows_of) rows = window_.mesh(*cluster.draw->transform);
    rows_of = cluster.draw;
    transform_cluster(window_, rows, cluster, scratch, options_.setup.coverage, nullptr);
    set_up_cluster(window_, options_.setup, false, rows, cluster, scratch);
    finish_blocks(scratch);
    for (std::size_t i = 0; i < scratch.block_count; ++i) {
      for (std::size_t lane = 0; lane < TriangleBlock::lanes; ++lane) draw(scratch.blocks[i], lane);
    }
    scratch.block_count = 0;
  }
  return scratch.drawn;
}

void MaskedDepth::draw(const TriangleBlock& block, std::size_t lane) {
  constexpr std::size_t edges = PartialTile::edge_count;
  const int x0 = block.x0[lane], x1 = block.x1[lane];
  const int y0 = block.y0[lane], y1 = block.y1[lane];
  if (x0 >= x1 || y0 >= y1) return;
  constexpr int last = tile_size - 1;
  TileSteps steps;
  std::array<double, edges> least, most;  // in a tile, from its lower left pixel's
  for (std::size_t e = 0; e < edges; ++e) {
    const double a = block.a[e][lane], b = block.b[e][lane];
    steps.a[e] = static_cast<std::int32_t>(a);
    steps.b[e] = static_cast<std::int32_t>(b);
    least[e] = std::min(0.0, last * a) + std::min(0.0, last * b);
    most[e] = std::max(0.0, last * a) + std::max(0.0, last * b);
  }
  steps.x = block.step_x[lane];
  steps.y = block.step_y[lane];
  // Rounding is monotone: these are what the pixels of a tile have at least and at most.
  const float low = std::min(0.0F, steps.x * last) + std::min(0.0F, steps.y * last);
  const float high = std::max(0.0F, steps.x * last) + std::max(0.0F, steps.y * last);
  Work& work = *work_;
  work.partial.clear();
  for (int y = y0; y < y1; ++y) {
    const int up = (y - y0) * tile_size;
    const float value_up = steps.y * static_cast<float>(up);
    for (int x = x0; x < x1; ++x) {
      const int along = (x - x0) * tile_size;
      const auto tile = static_cast<std::size_t>(y) * static_cast<std::size_t>(tiles_x_) +
                        static_cast<std::size_t>(x);
      const float value = (block.nearness[lane] + steps.x * static_cast<float>(along)) + value_up;
      if (!(value + high > reference_[tile])) continue;
      bool touched = true, whole = true;
      std::array<double, edges> corner;
      for (std::size_t e = 0; e < edges; ++e) {
        corner[e] = block.c[e][lane] + block.a[e][lane] * along + block.b[e][lane] * up;
        touched = touched && corner[e] + most[e] >= 0.0;
        whole = whole && corner[e] + least[e] >= 0.0;
      }
      if (!touched) continue;
      if (whole) {
        add_whole(tile, value + low);
        continue;
      }
      PartialTile& partial = work.partial.emplace_back();
      for (std::size_t e = 0; e < edges; ++e) {
        partial.edge[e] = static_cast<std::int32_t>(
            std::clamp(corner[e], -PartialTile::greatest_edge, PartialTile::greatest_edge));
      }
      partial.nearness = value;
      partial.tile = static_cast<std::uint32_t>(tile);
    }
  }
  if (work.coverage.size() < work.partial.size()) work.coverage.resize(work.partial.size());
  const std::span<TileCoverage> coverage(work.coverage.data(), work.partial.size());
  if (scalar_) {
    cover_tiles_scalar(steps, work.partial, coverage);
  } else {
    cover_tiles(steps, work.partial, coverage);
  }
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    if (coverage[i].mask != 0) add(work.partial[i].tile, coverage[i].mask, coverage[i].farthest);
  }
}

void MaskedDepth::add_whole(std::size_t tile, float nearness) {
  if (!(nearness > reference_[tile])) return;
  reference_[tile] = nearness;
  if (mask_[tile] != 0 && !(working_[tile] > nearness)) mask_[tile] = 0;
}

void MaskedDepth::add(std::size_t tile, std::uint64_t mask, float nearness) {
  const float reference = reference_[tile];
  if (!(nearness > reference)) return;
  std::uint64_t before = mask_[tile];
  float working = working_[tile];
  if (before != 0) {
    if (merge_ == LayerMerge::distance) {
      if (nearness - working > working - reference) before = 0;
    } else {
      const auto volume = [&](std::uint64_t covered, float value) {
        return static_cast<float>(std::popcount(covered)) * (value - reference);
      };
      const float joined = volume(before | mask, std::min(working, nearness));
      const float replaced = volume(mask, nearness);
      const float left = volume(before, working);
      if (left > joined && left >= replaced) return;
      if (replaced > joined) before = 0;
    }
  }
  working = before == 0 ? nearness : std::min(working, nearness);
  before |= mask;
  if ((before | outside_[tile]) == all_pixels) {
    reference_[tile] = working;
    before = 0;
  }
  working_[tile] = working;
  mask_[tile] = before;
}

bool MaskedDepth::hides(const BoxWindow& box) const {
  for (int y = box.y0 / tile_size; y * tile_size < box.y1; ++y) {
    for (int x = box.x0 / tile_size; x * tile_size < box.x1; ++x) {
      const auto tile = static_cast<std::size_t>(y) * static_cast<std::size_t>(tiles_x_) +
                        static_cast<std::size_t>(x);
      if (reference_[tile] > box.nearness) continue;
      if (mask_[tile] == 0 || !(working_[tile] > box.nearness)) return false;
      const int left = x * tile_size, below = y * tile_size;
      const std::uint64_t asked =
          rectangle_mask(std::max(box.x0 - left, 0), std::max(box.y0 - below, 0),
                         std::min(box.x1 - left, tile_size), std::min(box.y1 - below, tile_size));
      if ((asked & ~mask_[tile]) != 0) return false;
    }
  }
  return true;
}

bool MaskedDepth::hides(const Aabb& box) const {
  BoxWindow place;
  switch (project_box(window_, box, options_.setup.coverage, place)) {
    case BoxPlace::outside:
      return true;
    case BoxPlace::undecided:
      return false;
    case BoxPlace::inside:
      break;
  }
  return hides(place);
}

float MaskedDepth::nearness(int x, int y) const {
  const auto tile = static_cast<std::size_t>(y / tile_size) * static_cast<std::size_t>(tiles_x_) +
                    static_cast<std::size_t>(x / tile_size);
  const auto bit = static_cast<unsigned>(y % tile_size * tile_size + x % tile_size);
  return ((mask_[tile] >> bit) & 1U) != 0 ? working_[tile] : reference_[tile];
}

std::size_t MaskedDepth::bytes() const {
  return (reference_.capacity() + working_.capacity()) * sizeof(float) +
         (mask_.capacity() + outside_.capacity()) * sizeof(std::uint64_t) + sizeof(Work) +
         work_->clusters.capacity() * sizeof(ClusterDraw) +
         work_->scratch.blocks.capacity() * sizeof(TriangleBlock) +
         work_->partial.capacity() * sizeof(PartialTile) +
         work_->coverage.capacity() * sizeof(TileCoverage);
}

}  // namespace vislab
