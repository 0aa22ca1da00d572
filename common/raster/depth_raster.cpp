#include "common/raster/depth_raster.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "common/raster/covered_area.h"
#include "common/raster/setup_kernel.h"
#include "common/raster/tile_kernel.h"

namespace vislab {
namespace {

/// Blocks that are drawn at once: they stay in the innermost caches.
constexpr std::size_t blocks_at_once = 8;
/// Fewer are drawn in the order that they come in.
constexpr std::size_t clusters_to_sort = 16;
/// Clusters that a task of a thread sets up.
constexpr std::size_t clusters_at_once = 64;

/// Nearest first, about: what is drawn later then is dropped by the headers of tiles. One pass over
/// bins whose width is a sixteenth of their depth.
void sort_near_first(float least_depth, std::vector<ClusterDraw>& clusters,
                     std::vector<ClusterDraw>& sorted) {
  constexpr std::uint32_t bins = 512;
  constexpr int dropped_bits = 19;
  const auto bits_of = [](float depth) { return std::bit_cast<std::uint32_t>(depth); };
  const std::uint32_t base = bits_of(least_depth) >> dropped_bits;
  const auto bin = [&](const ClusterDraw& cluster) {
    const float depth = least_depth + std::max(cluster.beyond_near, 0.0F);
    return std::min((bits_of(depth) >> dropped_bits) - base, bins - 1);
  };
  std::array<std::uint32_t, bins> first{};
  for (const ClusterDraw& cluster : clusters) ++first[bin(cluster)];
  std::uint32_t sum = 0;
  for (std::uint32_t& count : first) count = std::exchange(sum, sum + count);
  sorted.resize(clusters.size());
  for (const ClusterDraw& cluster : clusters) sorted[first[bin(cluster)]++] = cluster;
  clusters.swap(sorted);
}

/// The window's rows for a draw, which many clusters may share.
class Rows {
 public:
  explicit Rows(const WindowTransform& window) : window_(window) {}
  const WindowRows& of(const RasterDraw& draw) {
    if (&draw != draw_) rows_ = window_.mesh(*draw.transform);
    draw_ = &draw;
    return rows_;
  }

 private:
  const WindowTransform& window_;
  const RasterDraw* draw_ = nullptr;
  WindowRows rows_;
};

}  // namespace

struct DepthRaster::Work {
  explicit Work(int threads) : arena(threads), parts(1) {}

  tbb::task_arena arena;
  std::vector<ClusterDraw> clusters, sorted;
  std::vector<SetupScratch> parts;
  std::vector<ColumnPlaces> places;
};

DepthRaster::DepthRaster(const Viewport& size, const RasterOptions& options)
    : options_(options),
      window_(Camera{}, size),
      rays_(window_, options.setup.coverage),
      tiles_(size, options.ids),
      work_(std::make_unique<Work>(std::max(1, options.threads))) {}
DepthRaster::~DepthRaster() = default;
DepthRaster::DepthRaster(DepthRaster&&) noexcept = default;
DepthRaster& DepthRaster::operator=(DepthRaster&&) noexcept = default;

void DepthRaster::begin(const Camera& camera) {
  window_ = WindowTransform(camera, window_.viewport());
  rays_ = PixelRays(window_, options_.setup.coverage);
  tiles_.clear(static_cast<float>(window_.nearness(camera.lens.far_m)));
}

void DepthRaster::collect_clusters(std::span<const RasterDraw> draws) {
  std::vector<ClusterDraw>& clusters = work_->clusters;
  clusters.clear();
  find_clusters(ClusterPlanes(window_), draws, clusters);
  // With ids the first drawn keeps a tie.
  if (!options_.ids && clusters.size() >= clusters_to_sort) {
    const auto near_m = static_cast<float>(std::max(window_.camera().lens.near_m, 1e-3));
    sort_near_first(near_m, clusters, work_->sorted);
  }
}

std::size_t DepthRaster::draw(std::span<const RasterDraw> draws) {
  collect_clusters(draws);
  const std::vector<ClusterDraw>& clusters = work_->clusters;
  if (options_.threads > 1 && clusters.size() > clusters_at_once) return draw_parallel(draws);
  SetupScratch& scratch = work_->parts.front();
  scratch.drawn = 0;
  Rows rows(window_);
  for (const ClusterDraw& cluster : clusters) {
    const WindowRows& r = rows.of(*cluster.draw);
    transform_cluster(window_, r, cluster, scratch, options_.setup.coverage, nullptr);
    set_up_cluster(window_, options_.setup, options_.ids, r, cluster, scratch);
    if (scratch.block_count > blocks_at_once) draw_set_up();
  }
  draw_set_up();
  return scratch.drawn;
}

void DepthRaster::draw_counted(std::span<const RasterDraw> draws, std::span<std::uint64_t> samples,
                               std::span<std::uint64_t> outlines_px) {
  std::ranges::fill(samples, 0);
  std::ranges::fill(outlines_px, 0);
  collect_clusters(draws);
  SetupScratch& scratch = work_->parts.front();
  Rows rows(window_);
  const auto next_lane = [&] {
    return TriangleBlock::lanes * (scratch.block_count - (scratch.lane > 0 ? 1 : 0)) + scratch.lane;
  };
  for (const ClusterDraw& cluster : work_->clusters) {
    const WindowRows& r = rows.of(*cluster.draw);
    transform_cluster(window_, r, cluster, scratch, options_.setup.coverage, nullptr);
    const std::size_t first = next_lane();
    set_up_cluster(window_, options_.setup, options_.ids, r, cluster, scratch);
    std::int64_t area = 0;
    std::int64_t outlines = 0;
    for (std::size_t lane = first; lane < next_lane(); ++lane) {
      const TriangleBlock& block = scratch.blocks[lane / TriangleBlock::lanes];
      area += covered_area(block, lane % TriangleBlock::lanes, viewport());
      outlines += outline(block, lane % TriangleBlock::lanes, viewport());
    }
    // Areas until all clusters of a draw, which need not follow each other, are drawn.
    const auto place = static_cast<std::size_t>(cluster.draw - draws.data());
    samples[place] += static_cast<std::uint64_t>(area);
    if (!outlines_px.empty()) outlines_px[place] += static_cast<std::uint64_t>(outlines);
    if (scratch.block_count > blocks_at_once) draw_set_up();
  }
  draw_set_up();
  for (std::uint64_t& count : samples) count = samples_of_area(static_cast<std::int64_t>(count));
  for (std::uint64_t& count : outlines_px) count /= std::uint64_t{outline_units};
}

void DepthRaster::draw_set_up() {
  SetupScratch& scratch = work_->parts.front();
  finish_blocks(scratch);
  draw_blocks({scratch.blocks.data(), scratch.block_count}, tiles_, {});
  scratch.block_count = 0;
}

std::size_t DepthRaster::draw_parallel(std::span<const RasterDraw>) {
  const std::vector<ClusterDraw>& clusters = work_->clusters;
  const std::size_t count = (clusters.size() + clusters_at_once - 1) / clusters_at_once;
  if (work_->parts.size() < count) work_->parts.resize(count);
  std::vector<SetupScratch>& parts = work_->parts;
  work_->arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t part) {
      SetupScratch& scratch = parts[part];
      scratch.drawn = 0;
      scratch.block_count = 0;
      Rows rows(window_);
      const std::size_t end = std::min(clusters.size(), (part + 1) * clusters_at_once);
      for (std::size_t i = part * clusters_at_once; i < end; ++i) {
        const WindowRows& r = rows.of(*clusters[i].draw);
        transform_cluster(window_, r, clusters[i], scratch, options_.setup.coverage, nullptr);
        set_up_cluster(window_, options_.setup, options_.ids, r, clusters[i], scratch);
      }
      finish_blocks(scratch);
    });
    // Every thread has rows of tiles of its own, and draws all triangles into them in order.
    tbb::parallel_for(0, options_.threads, [&](int index) {
      for (std::size_t part = 0; part < count; ++part) {
        const SetupScratch& scratch = parts[part];
        draw_blocks({scratch.blocks.data(), scratch.block_count}, tiles_,
                    {index, options_.threads});
      }
    });
  });
  std::size_t drawn = 0;
  for (std::size_t part = 0; part < count; ++part) {
    drawn += parts[part].drawn;
    parts[part].block_count = 0;
  }
  return drawn;
}

std::size_t DepthRaster::draw_visible(std::span<const RasterDraw> draws,
                                      std::span<std::uint8_t> hidden) {
  std::vector<ClusterDraw>& clusters = work_->clusters;
  clusters.clear();
  find_clusters(ClusterPlanes(window_), draws, clusters);
  SetupScratch& scratch = work_->parts.front();
  scratch.drawn = 0;
  Rows rows(window_);
  std::ranges::fill(hidden, std::uint8_t{1});
  for (const ClusterDraw& cluster : clusters) {
    const WindowRows& r = rows.of(*cluster.draw);
    ClusterWindow where;
    transform_cluster(window_, r, cluster, scratch, options_.setup.coverage, &where);
    if (where.place == BoxPlace::outside) continue;
    if (where.place == BoxPlace::inside && hides(where.window)) continue;
    hidden[static_cast<std::size_t>(cluster.draw - draws.data())] = 0;
    draw_cluster(cluster, r);
  }
  return scratch.drawn;
}

void DepthRaster::draw_cluster(const ClusterDraw& cluster, const WindowRows& rows) {
  SetupScratch& scratch = work_->parts.front();
  set_up_cluster(window_, options_.setup, options_.ids, rows, cluster, scratch);
  draw_set_up();
}

std::size_t DepthRaster::draw_visible(std::span<const RasterDraw> draws,
                                      std::span<const BoxColumns> boxes,
                                      std::span<const std::uint32_t> order,
                                      std::span<std::uint8_t> hidden) {
  std::vector<ColumnPlaces>& places = work_->places;
  places.resize(boxes.size());
  const ColumnView view(window_, options_.setup.coverage);
  for (std::size_t i = 0; i < boxes.size(); ++i) place_columns(view, boxes[i], places[i]);
  const ClusterPlanes planes(window_);
  SetupScratch& scratch = work_->parts.front();
  scratch.drawn = 0;
  for (const std::uint32_t i : order) {
    const std::size_t column = i % BoxColumns::width;
    const BoxColumns& box = boxes[i / BoxColumns::width];
    const ColumnPlaces& place = places[i / BoxColumns::width];
    hidden[i] = 1;
    if (((place.undecided | box.always) >> column & 1U) == 0) {
      if ((place.inside >> column & 1U) == 0 || hides(place.window(column))) continue;
    }
    hidden[i] = 0;
    const RasterDraw& draw = draws[i];
    std::vector<ClusterDraw>& clusters = work_->clusters;
    clusters.clear();
    if (const auto of_mesh = draw.mesh->clusters(); of_mesh.size() == 1) {
      // Its box is the draw's.
      if (draw.count > 0) clusters.push_back({&draw, of_mesh.data(), draw.first, draw.count, 0.0F});
    } else {
      find_clusters(planes, {&draw, 1}, clusters);
    }
    if (clusters.empty()) continue;
    const WindowRows rows = window_.mesh(*draw.transform);
    for (const ClusterDraw& cluster : clusters) {
      transform_cluster(window_, rows, cluster, scratch, options_.setup.coverage, nullptr);
      draw_cluster(cluster, rows);
    }
  }
  return scratch.drawn;
}

float DepthRaster::nearness(int x, int y) const {
  return tiles_.nearness(tiles_.index(x / tile_size, y / tile_size), x % tile_size, y % tile_size);
}

std::uint32_t DepthRaster::id(int x, int y) const {
  return tiles_.id(tiles_.index(x / tile_size, y / tile_size), x % tile_size, y % tile_size);
}

std::size_t DepthRaster::bytes() const {
  std::size_t bytes =
      tiles_.bytes() + sizeof(Work) +
      (work_->clusters.capacity() + work_->sorted.capacity()) * sizeof(ClusterDraw) +
      work_->parts.capacity() * sizeof(SetupScratch) +
      work_->places.capacity() * sizeof(ColumnPlaces);
  for (const SetupScratch& part : work_->parts) {
    bytes += part.blocks.capacity() * sizeof(TriangleBlock);
  }
  return bytes;
}

}  // namespace vislab
