#include "common/judge/region_truth.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/random.h"
#include "common/judge/ray_scene.h"
#include "common/scene/error.h"
#include "common/scene/frame.h"
#include "common/scene/quake_world.h"

namespace vislab {
namespace {

/// Viewpoints keep this far from the planes of their region where it is wide enough.
constexpr double margin_m = 1e-2;
constexpr double least_margin_m = 2e-5;
constexpr int tries = 400;
/// Regions may lie this far apart, and what a ray hits in front of them.
constexpr double gap_m = 2e-3;

struct RayHit {
  ObjectId object = none_id;
  glm::dvec3 from{0.0}, to{0.0};
};

bool inside(const ConvexRegion& region, const glm::dvec3& point, double margin) {
  return std::ranges::all_of(
      region.planes, [&](const Plane& plane) { return plane.signed_distance(point) >= margin; });
}

/// Evenly on the sphere, without functions that differ between machines (Marsaglia 1972).
glm::dvec3 direction(Random& random) {
  for (;;) {
    const double x = random.uniform(-1.0, 1.0);
    const double y = random.uniform(-1.0, 1.0);
    const double s = x * x + y * y;
    if (s >= 1.0) continue;
    const double root = 2.0 * std::sqrt(1.0 - s);
    return {x * root, y * root, 1.0 - 2.0 * s};
  }
}

/// Does the segment keep within the cells, but for gaps?
bool stays_inside(const Scene& scene, const glm::dvec3& from, const glm::dvec3& to) {
  const double length = glm::length(to - from);
  std::vector<std::pair<double, double>> parts;  // metres along the segment
  for (const Cell& cell : scene.cells) {
    for (const ConvexRegion& region : cell.regions) {
      double begin = 0.0;
      double end = length;
      for (const Plane& plane : region.planes) {
        const double a = plane.signed_distance(from) + gap_m / 4.0;
        const double b = plane.signed_distance(to) + gap_m / 4.0;
        if (a < 0.0 && b < 0.0) begin = length + 1.0;
        if (a < 0.0 && b >= 0.0) begin = std::max(begin, length * a / (a - b));
        if (a >= 0.0 && b < 0.0) end = std::min(end, length * a / (a - b));
        if (begin > end) break;
      }
      if (begin <= end) parts.emplace_back(begin, end);
    }
  }
  std::ranges::sort(parts);
  double reached = 0.0;
  for (const auto& [begin, end] : parts) {
    if (begin > reached + gap_m) break;
    reached = std::max(reached, end);
  }
  return reached >= length - gap_m;
}

/// Takes the objects that a culler emits.
class SetSink : public DrawSink {
 public:
  explicit SetSink(const Scene& scene) : scene_(&scene) {}
  void everything() override {
    for (ObjectId object = 0; object < scene_->object_count(); ++object) ids.push_back(object);
  }
  void objects(std::span<const ObjectId> emitted) override {
    ids.insert(ids.end(), emitted.begin(), emitted.end());
  }
  void ranges(std::span<const TriangleRange> emitted) override {
    for (const TriangleRange& range : emitted) ids.push_back(range.object);
  }
  void flush() override {}

  std::vector<ObjectId> ids;

 private:
  const Scene* scene_;
};

double ratio(std::uint64_t over, std::uint64_t seen) {
  return seen == 0 ? 0.0 : static_cast<double>(over) / static_cast<double>(seen);
}

}  // namespace

double RegionVerdict::over() const { return ratio(unseen, seen); }

double RegionVerdict::over_points() const {
  return ratio(kept_by_points - std::min(kept_by_points, seen_by_points), seen_by_points);
}

struct RegionJudge::Impl {
  Impl(const Scene& of, const RegionSettings& given)
      : scene(&of), settings(given), state(of), rays(of), arena(given.threads) {}

  /// A viewpoint that float coordinates relative to the scene's origin tell exactly.
  std::optional<glm::dvec3> viewpoint(const Cell& cell, Random& random) const {
    std::vector<double> volume_to;  // of boxes, summed
    double sum = 0.0;
    for (const ConvexRegion& region : cell.regions) {
      const glm::dvec3 size = 2.0 * region.bounds.half_size();
      volume_to.push_back(sum += size.x * size.y * size.z);
    }
    for (const double margin : {margin_m, least_margin_m}) {
      for (int i = 0; i < tries; ++i) {
        const double at = random.uniform(0.0, sum);
        const std::size_t chosen =
            static_cast<std::size_t>(std::ranges::upper_bound(volume_to, at) - volume_to.begin());
        if (chosen >= cell.regions.size()) break;
        const ConvexRegion& region = cell.regions[chosen];
        glm::dvec3 point(0.0);
        for (int axis = 0; axis < 3; ++axis) {
          point[axis] = random.uniform(region.bounds.min[axis], region.bounds.max[axis]);
        }
        point = scene->origin() + glm::dvec3(glm::vec3(point - scene->origin()));
        if (inside(region, point, margin)) return point;
      }
    }
    return std::nullopt;
  }

  RayHit cast(const glm::dvec3& from, const glm::dvec3& towards) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const glm::vec3 origin(from - scene->origin());
    const glm::vec3 along(towards);
    RTCRayHit ray{};
    ray.ray.org_x = origin.x;
    ray.ray.org_y = origin.y;
    ray.ray.org_z = origin.z;
    ray.ray.dir_x = along.x;
    ray.ray.dir_y = along.y;
    ray.ray.dir_z = along.z;
    ray.ray.tnear = 0.0F;
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = 0xFFFFFFFFU;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(rays.handle(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const TriangleId triangle = rays.triangle_of(ray.hit.geomID, ray.hit.primID, ray.hit.instID[0]);
    return {scene->object_of(triangle), from,
            from + glm::dvec3(along) * static_cast<double>(ray.ray.tfar)};
  }

  /// Calls visit(viewpoint number, hit) for all rays of a cell that hit something. Gives the number
  /// of viewpoints.
  template <typename Visit>
  std::uint32_t for_each_hit(CellId cell, Visit&& visit) const {
    Random random(Random(settings.seed + cell * 0xD1B54A32D192ED03ULL).bits());
    for (std::uint32_t i = 0; i < settings.viewpoints; ++i) {
      const std::optional<glm::dvec3> point = viewpoint(scene->cells[cell], random);
      if (!point) return i;
      for (std::uint32_t k = 0; k < settings.rays; ++k) {
        const RayHit hit = cast(*point, direction(random));
        if (hit.object != none_id) visit(i, hit);
      }
    }
    return settings.viewpoints;
  }

  template <typename Function>
  void each(std::size_t count, Function&& f) {
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, f); });
  }

  const Scene* scene;
  RegionSettings settings;
  SceneState state;
  RayScene rays;
  tbb::task_arena arena;
};

RegionJudge::RegionJudge(const Scene& scene, const RegionSettings& settings) {
  if (settings.viewpoints < 1 || settings.rays < 1 || settings.threads < 1) {
    throw InputError("region truth needs at least one viewpoint, one ray and one thread");
  }
  impl_ = std::make_unique<Impl>(scene, settings);
  impl_->rays.follow(impl_->state.view());
}

RegionJudge::~RegionJudge() = default;

std::vector<CellTruth> RegionJudge::trace(std::span<const CellId> cells) {
  std::vector<CellTruth> truth(cells.size());
  struct Scratch {
    std::vector<std::uint32_t> rays;  // by object
    std::vector<std::uint32_t> last;  // by object: the viewpoint that saw it last, + 1
    std::vector<ObjectId> seen;
  };
  tbb::enumerable_thread_specific<Scratch> scratches;
  impl_->each(cells.size(), [&](std::size_t index) {
    Scratch& scratch = scratches.local();
    scratch.rays.resize(impl_->scene->object_count(), 0);
    scratch.last.assign(impl_->scene->object_count(), 0);
    CellTruth& cell = truth[index];
    cell.cell = cells[index];
    cell.viewpoints = impl_->for_each_hit(cell.cell, [&](std::uint32_t point, const RayHit& hit) {
      if (scratch.rays[hit.object]++ == 0) scratch.seen.push_back(hit.object);
      if (scratch.last[hit.object] != point + 1) ++cell.seen_by_points;
      scratch.last[hit.object] = point + 1;
    });
    std::ranges::sort(scratch.seen);
    for (const ObjectId object : scratch.seen) {
      cell.seen.push_back({object, scratch.rays[object]});
      scratch.rays[object] = 0;
    }
    scratch.seen.clear();
  });
  return truth;
}

RegionVerdict RegionJudge::judge(std::span<const CellTruth> truth,
                                 const std::function<std::vector<ObjectId>(CellId)>& set_of) {
  RegionVerdict verdict;
  struct Missed {
    CellId cell;
    std::vector<ObjectId> objects;
  };
  std::vector<Missed> missed;
  for (const CellTruth& cell : truth) {
    if (cell.viewpoints == 0) continue;
    const std::vector<ObjectId> set = set_of(cell.cell);
    ++verdict.cells;
    verdict.viewpoints += cell.viewpoints;
    std::uint64_t both = 0;
    Missed here{cell.cell, {}};
    for (const ObjectRays& seen : cell.seen) {
      verdict.hits += seen.rays;
      if (std::ranges::binary_search(set, seen.object)) {
        ++both;
      } else {
        here.objects.push_back(seen.object);
      }
    }
    verdict.kept += set.size();
    verdict.unseen += set.size() - both;
    verdict.seen += cell.seen.size();
    verdict.kept_by_points += set.size() * cell.viewpoints;
    verdict.seen_by_points += cell.seen_by_points;
    if (!here.objects.empty()) missed.push_back(std::move(here));
  }
  verdict.rays = verdict.viewpoints * impl_->settings.rays;

  std::vector<std::vector<RayHit>> lost(missed.size());
  impl_->each(missed.size(), [&](std::size_t index) {
    impl_->for_each_hit(missed[index].cell, [&](std::uint32_t, const RayHit& hit) {
      if (std::ranges::binary_search(missed[index].objects, hit.object)) {
        lost[index].push_back(hit);
      }
    });
  });
  for (std::size_t index = 0; index < missed.size(); ++index) {
    for (const RayHit& hit : lost[index]) {
      if (!stays_inside(*impl_->scene, hit.from, hit.to)) {
        ++verdict.strays;
        continue;
      }
      ++verdict.misses;
      if (verdict.witnesses.size() < 16) {
        verdict.witnesses.push_back({missed[index].cell, hit.object, hit.from, hit.to});
      }
    }
  }
  return verdict;
}

std::vector<CellId> reachable_cells(const Scene& scene) {
  const QuakeWorld* world = scene.quake.get();
  std::vector<std::uint8_t> reached(scene.cells.size(), world == nullptr ? 1 : 0);
  if (world != nullptr && !world->cell_of_leaf.empty()) {
    std::vector<std::vector<CellId>> beside(scene.cells.size());
    for (const Portal& portal : scene.portals) beside[portal.from].push_back(portal.to);
    std::vector<CellId> open;
    const auto reach = [&](CellId cell) {
      if (cell == none_id || reached[cell] != 0) return;
      reached[cell] = 1;
      open.push_back(cell);
    };
    for (const QuakePlace& place : world->places) reach(world->cell_of_leaf[place.leaf]);
    while (!open.empty()) {
      const CellId cell = open.back();
      open.pop_back();
      for (const CellId next : beside[cell]) reach(next);
    }
  }
  std::vector<CellId> cells;
  for (CellId cell = 0; cell < reached.size(); ++cell) {
    if (reached[cell] != 0) cells.push_back(cell);
  }
  return cells;
}

std::optional<std::vector<ObjectId>> region_set(ICuller& culler, CellId cell, const Scene& scene) {
  SetSink sink(scene);
  if (!culler.region(cell, sink)) return std::nullopt;
  std::ranges::sort(sink.ids);
  sink.ids.erase(std::unique(sink.ids.begin(), sink.ids.end()), sink.ids.end());
  return std::move(sink.ids);
}

}  // namespace vislab
