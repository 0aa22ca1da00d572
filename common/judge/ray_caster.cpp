// Truth by ray casting.
//
// Idea: one ray a sample, in packets of eight neighbouring samples, traced by Embree's robust
// kernels; the triangles hit are written as ids (set C) or counted (set J).
// Guarantee: the first triangle along the ray through the sample, except within rounding of edges,
// where a neighbour may be hit (robust kernels leave hardly any leak along edges, but some through
// vertices: samples must not be aimed at vertices), and among triangles at equal depth.
// Cost: about 0.1 microseconds a ray and thread; 8 bytes for each triangle of the scene and thread.
// Limits: float vertices relative to the scene's origin.
// Source: Wald et al., "Embree: a kernel framework for efficient CPU ray tracing", 2014.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstring>

#include "common/judge/clear_hits.h"
#include "common/judge/pass_filter.h"
#include "common/judge/ray_scene.h"
#include "common/judge/samples.h"
#include "common/judge/truth.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

struct Counts {
  std::uint32_t hits = 0;
  std::uint32_t clear_hits = 0;
};

/// What one thread works with.
struct Worker {
  std::vector<Counts> counts;  // by triangle
  ClearHits clear_hits;
};

/// All rays of a tile: the pixel centres, then set J.
class TileRays {
 public:
  TileRays(const RayMaker& maker, const JitteredSamples& jittered)
      : maker_(&maker),
        jittered_(&jittered),
        positions_(1 + jittered.packets_per_tile()),
        varying_(positions_.size()) {}

  void start(int tile_x, int tile_y) {
    positions_[0] = pixel_centres(tile_x, tile_y);
    jittered_->tile(tile_x, tile_y, &positions_[1]);
    maker_->vary(positions_, varying_.data());
  }
  std::size_t packet_count() const { return positions_.size(); }
  const EightPositions& positions(std::size_t packet) const { return positions_[packet]; }
  const EightVectors& varying(std::size_t packet) const { return varying_[packet]; }

 private:
  const RayMaker* maker_;
  const JitteredSamples* jittered_;
  std::vector<EightPositions> positions_;
  std::vector<EightVectors> varying_;
};

/// Eight rays, ready to be aimed again and again.
struct alignas(64) Packet {
  RTCRayHit8 rays;
  alignas(32) std::array<int, 8> active;

  explicit Packet(const RayMaker& maker) : maker_(&maker) {
    RTCRay8& ray = rays.ray;
    const bool orthographic = maker.orthographic();
    std::fill_n(orthographic ? ray.dir_x : ray.org_x, 8, maker.common().x);
    std::fill_n(orthographic ? ray.dir_y : ray.org_y, 8, maker.common().y);
    std::fill_n(orthographic ? ray.dir_z : ray.org_z, 8, maker.common().z);
    std::fill_n(rays.ray.tnear, 8, maker.near_distance());
    std::fill_n(rays.ray.time, 8, 0.0F);
    std::fill_n(rays.ray.mask, 8, 0xFFFFFFFFU);
    std::fill_n(rays.ray.id, 8, 0U);
    std::fill_n(rays.ray.flags, 8, 0U);
    active.fill(-1);
  }

  /// `varying` as RayMaker::vary gives it.
  void aim(const EightVectors& varying) {
    RTCRay8& ray = rays.ray;
    const bool orthographic = maker_->orthographic();
    std::memcpy(orthographic ? ray.org_x : ray.dir_x, varying.x.data(), sizeof varying.x);
    std::memcpy(orthographic ? ray.org_y : ray.dir_y, varying.y.data(), sizeof varying.y);
    std::memcpy(orthographic ? ray.org_z : ray.dir_z, varying.z.data(), sizeof varying.z);
    if (!any_hit_) return;
    std::fill_n(ray.tfar, 8, maker_->far_distance());
    std::fill_n(rays.hit.geomID, 8, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(rays.hit.instID[0], 8, RTC_INVALID_GEOMETRY_ID);
  }

  void trace(const RayScene& scene, RTCIntersectContext& context) {
    rtcIntersect8(active.data(), scene.handle(), &context, &rays);
    unsigned all_bits = RTC_INVALID_GEOMETRY_ID;
    for (int lane = 0; lane < 8; ++lane) all_bits &= rays.hit.geomID[lane];
    any_hit_ = all_bits != RTC_INVALID_GEOMETRY_ID;
  }

  /// Switches off the rays of tiles that stick out of the image.
  void activate_inside(const EightPositions& window_px, const Viewport& viewport) {
    for (int lane = 0; lane < 8; ++lane) {
      const bool inside =
          (window_px.x[lane] < viewport.width) & (window_px.y[lane] < viewport.height);
      active[lane] = inside ? -1 : 0;
    }
  }

  /// Lanes that are not active keep what aim() wrote, which is no hit.
  bool hit(int lane) const { return rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; }

  bool any_hit() const { return any_hit_; }

  float depth_offset() const { return static_cast<float>(maker_->depth_offset()); }

  /// All lanes hit the same triangle, or none does.
  bool uniform() const {
    unsigned difference = 0;
    for (int lane = 0; lane < 8; ++lane) {
      difference |= (rays.hit.geomID[lane] ^ rays.hit.geomID[0]) |
                    (rays.hit.primID[lane] ^ rays.hit.primID[0]) |
                    (rays.hit.instID[0][lane] ^ rays.hit.instID[0][0]);
    }
    return difference == 0;
  }

  TriangleId triangle(int lane, const RayScene& scene) const {
    if (!hit(lane)) return none_id;
    return scene.triangle_of(rays.hit.geomID[lane], rays.hit.primID[lane],
                             rays.hit.instID[0][lane]);
  }

 private:
  const RayMaker* maker_;
  bool any_hit_ = true;  // in the last trace, so that results must be cleared before the next
};

/// Counts the hits of a packet of set J.
void count(Packet& packet, const EightPositions& positions, const RayScene& scene, Worker& worker) {
  const RTCHit8& hit = packet.rays.hit;
  float* const depth = packet.rays.ray.tfar;
  for (int lane = 0; lane < 8; ++lane) depth[lane] += packet.depth_offset();
  if (packet.uniform()) {
    const TriangleId triangle = packet.triangle(0, scene);
    Counts& counts = worker.counts[triangle];
    counts.hits += 8;
    counts.clear_hits += worker.clear_hits.count_clear(triangle, hit.u, hit.v, depth, positions);
    return;
  }
  for (int lane = 0; lane < 8; ++lane) {
    if (!packet.hit(lane)) continue;
    const TriangleId triangle = packet.triangle(lane, scene);
    Counts& counts = worker.counts[triangle];
    ++counts.hits;
    counts.clear_hits += worker.clear_hits.is_clear(triangle, hit.u[lane], hit.v[lane], depth[lane],
                                                    positions[lane]);
  }
}

struct NotKept {
  const std::vector<std::uint8_t>* kept;  // by triangle
  bool operator()(TriangleId triangle) const { return (*kept)[triangle] == 0; }
};

RTCIntersectContext coherent_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

const TruthSettings& checked(const TruthSettings& settings) {
  if (settings.jitter_per_pixel < 1 || settings.jitter_per_pixel > 4096) {
    throw InputError("truth, jitter_per_pixel: " + std::to_string(settings.jitter_per_pixel) +
                     " is out of range; 1 to 4096 is right");
  }
  if (settings.threads < 1 || settings.threads > 1024) {
    throw InputError("truth, threads: " + std::to_string(settings.threads) +
                     " is out of range; 1 to 1024 is right");
  }
  return settings;
}

}  // namespace

struct RayCaster::Impl {
  const Scene& scene;
  TruthSettings settings;
  RayScene rays;
  tbb::task_arena arena;
  std::vector<Worker> workers;

  Impl(const Scene& s, const TruthSettings& t)
      : scene(s), settings(checked(t)), rays(s), arena(t.threads), workers(t.threads) {}

  /// Calls f(row, worker) for every row of tiles, on all threads.
  template <typename Function>
  void for_each_tile_row(const Viewport& viewport, Function&& f) {
    const int rows = (viewport.height + tile_height - 1) / tile_height;
    for_each(static_cast<std::size_t>(rows),
             [&](std::size_t row, Worker& worker) { f(static_cast<int>(row), worker); });
  }

  template <typename Function>
  void for_each(std::size_t count, Function&& f) {
    arena.execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count),
                        [&](const tbb::blocked_range<std::size_t>& range) {
                          Worker& worker = workers[tbb::this_task_arena::current_thread_index()];
                          for (std::size_t i = range.begin(); i != range.end(); ++i) f(i, worker);
                        });
    });
  }

  void collect(FrameTruth& truth);
};

RayCaster::RayCaster(const Scene& scene, const TruthSettings& settings)
    : impl_(std::make_unique<Impl>(scene, settings)) {}

RayCaster::~RayCaster() = default;

const Scene& RayCaster::scene() const { return impl_->scene; }

std::string RayCaster::engine() { return ray_engine(); }

FrameTruth RayCaster::trace(const Frame& frame) {
  Impl& self = *impl_;
  const Viewport viewport = frame.viewport;
  const RayMaker maker(frame.camera, viewport, self.scene.origin());
  const JitteredSamples jittered(viewport, self.settings.jitter_per_pixel, self.settings.seed);
  self.rays.follow(frame.objects);
  for (Worker& worker : self.workers) {
    worker.counts.resize(self.scene.triangle_count());
    worker.clear_hits.start(frame, self.scene);
  }
  FrameTruth truth;
  truth.viewport = viewport;
  const std::size_t pixels = static_cast<std::size_t>(viewport.width) * viewport.height;
  truth.ids.resize(pixels);
  truth.jittered_samples = pixels * self.settings.jitter_per_pixel;

  self.for_each_tile_row(viewport, [&](int tile_y, Worker& worker) {
    RTCIntersectContext context = coherent_context();
    Packet packet(maker);
    TileRays tile(maker, jittered);
    for (int tile_x = 0; tile_x * tile_width < viewport.width; ++tile_x) {
      tile.start(tile_x, tile_y);
      const bool sticks_out = (tile_x + 1) * tile_width > viewport.width ||
                              (tile_y + 1) * tile_height > viewport.height;
      packet.active.fill(-1);
      for (std::size_t p = 0; p < tile.packet_count(); ++p) {
        packet.aim(tile.varying(p));
        if (sticks_out) packet.activate_inside(tile.positions(p), viewport);
        packet.trace(self.rays, context);
        if (p > 0) {
          if (packet.any_hit()) count(packet, tile.positions(p), self.rays, worker);
          continue;
        }
        for (int lane = 0; lane < 8; ++lane) {
          if (packet.active[lane] == 0) continue;
          const std::size_t x = tile_x * tile_width + lane % tile_width;
          const std::size_t y = tile_y * tile_height + lane / tile_width;
          truth.ids[y * viewport.width + x] = packet.triangle(lane, self.rays);
        }
      }
    }
  });
  self.collect(truth);
  return truth;
}

void RayCaster::Impl::collect(FrameTruth& truth) {
  // Blocks in order, so that the list does not depend on who finishes first.
  constexpr std::size_t block_size = 1U << 16U;
  const std::size_t count = scene.triangle_count();
  std::vector<std::vector<TriangleHits>> blocks((count + block_size - 1) / block_size);
  for_each(blocks.size(), [&](std::size_t block, Worker&) {
    const std::size_t end = std::min(count, (block + 1) * block_size);
    for (std::size_t i = block * block_size; i < end; ++i) {
      TriangleHits sum{static_cast<TriangleId>(i)};
      for (Worker& worker : workers) {
        Counts& counts = worker.counts[i];
        if (counts.hits == 0) continue;
        sum.hits += counts.hits;
        sum.clear_hits += counts.clear_hits;
        counts = {};
      }
      if (sum.hits > 0) blocks[block].push_back(sum);
    }
  });
  for (const std::vector<TriangleHits>& block : blocks) {
    truth.hits.insert(truth.hits.end(), block.begin(), block.end());
  }
}

std::vector<RayCaster::Hit> RayCaster::cast(const Frame& frame,
                                            std::span<const glm::dvec2> window_px,
                                            const VisibleSet* kept) {
  Impl& self = *impl_;
  const RayMaker maker(frame.camera, frame.viewport, self.scene.origin());
  self.rays.follow(frame.objects);
  std::vector<std::uint8_t> is_kept;
  if (kept != nullptr) {
    is_kept.resize(self.scene.triangle_count());
    for (const VisibleSet::Run& run : kept->runs()) {
      std::fill_n(is_kept.begin() + run.first, run.count, std::uint8_t{1});
    }
  }
  std::vector<Hit> hits(window_px.size());
  self.for_each((window_px.size() + 7) / 8, [&](std::size_t i, Worker&) {
    PassContext<NotKept> context{coherent_context(), &self.rays, {&is_kept}};
    if (kept != nullptr) context.embree.filter = pass_filter<NotKept>;
    Packet packet(maker);
    EightPositions positions;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const std::size_t sample = i * 8 + lane;
      packet.active[lane] = sample < window_px.size() ? -1 : 0;
      const glm::dvec2 p = window_px[std::min(sample, window_px.size() - 1)];
      positions.x[lane] = p.x;
      positions.y[lane] = p.y;
    }
    EightVectors varying;
    maker.vary({&positions, 1}, &varying);
    packet.aim(varying);
    packet.trace(self.rays, context.embree);
    for (int lane = 0; lane < 8; ++lane) {
      if (!packet.hit(lane)) continue;
      hits[i * 8 + lane] = {packet.triangle(lane, self.rays),
                            packet.rays.ray.tfar[lane] + maker.depth_offset()};
    }
  });
  return hits;
}

std::vector<RayCaster::Sample> RayCaster::jittered_hits(const Frame& frame,
                                                        std::span<const TriangleId> triangles) {
  Impl& self = *impl_;
  const Viewport viewport = frame.viewport;
  const RayMaker maker(frame.camera, viewport, self.scene.origin());
  const JitteredSamples jittered(viewport, self.settings.jitter_per_pixel, self.settings.seed);
  self.rays.follow(frame.objects);
  std::vector<std::uint8_t> wanted(self.scene.triangle_count());
  const int columns = (viewport.width + tile_width - 1) / tile_width;
  const int rows = (viewport.height + tile_height - 1) / tile_height;
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(columns) * rows);
  for (const TriangleId id : triangles) {
    wanted[id] = 1;
    const WindowTriangle triangle(frame.camera, viewport, self.rays.triangle(id));
    if (triangle.empty()) continue;
    // A pixel more on every side, for the rounding of rays and vertices.
    const glm::dvec2 limit(viewport.width - 1, viewport.height - 1);
    const glm::ivec2 first(glm::clamp(triangle.min() - 1.0, glm::dvec2(0.0), limit));
    const glm::ivec2 last(glm::clamp(triangle.max() + 1.0, glm::dvec2(0.0), limit));
    for (int y = first.y / tile_height; y <= last.y / tile_height; ++y) {
      auto* row = &covered[static_cast<std::size_t>(y) * columns];
      std::fill(row + first.x / tile_width, row + last.x / tile_width + 1, std::uint8_t{1});
    }
  }
  std::vector<std::vector<Sample>> found(rows);
  self.for_each_tile_row(viewport, [&](int tile_y, Worker&) {
    RTCIntersectContext context = coherent_context();
    Packet packet(maker);
    TileRays tile(maker, jittered);
    for (int tile_x = 0; tile_x < columns; ++tile_x) {
      if (covered[static_cast<std::size_t>(tile_y) * columns + tile_x] == 0) continue;
      tile.start(tile_x, tile_y);
      for (std::size_t p = 1; p < tile.packet_count(); ++p) {
        packet.aim(tile.varying(p));
        packet.activate_inside(tile.positions(p), viewport);
        packet.trace(self.rays, context);
        for (int lane = 0; lane < 8; ++lane) {
          const TriangleId triangle = packet.triangle(lane, self.rays);
          if (triangle != none_id && wanted[triangle] != 0) {
            found[tile_y].push_back({tile.positions(p)[lane], triangle});
          }
        }
      }
    }
  });
  std::vector<Sample> samples;
  for (const std::vector<Sample>& row : found)
    samples.insert(samples.end(), row.begin(), row.end());
  return samples;
}

}  // namespace vislab
