// Probes of visibility by rays.
//
// Idea: single rays through the window, at places and with a tracer that the settings name; what
//   they meet first is seen. Where several triangles are asked for, rays are cast again past those
//   that were met, as long as something lies at the same depth.
// Guarantee: none; how far the answer depends on the settings is what it is for.
// Cost: about 0.3 microseconds a ray, more for every triangle beyond the first; 4 bytes a triangle.
// Limits: one thread; a frame is traced once and its answer kept.
// Source: Embree's issues 181 (rays through vertices), 188 (two hits on an edge) and 423
// (instruction sets); Good 1953, "The population frequencies of species".
#include "common/judge/ray_probes.h"

#include <algorithm>
#include <map>

#include "common/judge/pass_filter.h"
#include "common/judge/path_truth.h"
#include "common/judge/samples.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

/// Depths along a ray that differ by less than this, relative to the smaller, are one.
constexpr float same_depth = 1e-6F;

/// The triangles that a ray has met already.
struct Met {
  const std::vector<TriangleId>* triangles;
  bool operator()(TriangleId triangle) const {
    return std::ranges::find(*triangles, triangle) != triangles->end();
  }
};

/// Window positions, eight at a time. Those beyond the window's border are to be left out.
std::vector<EightPositions> positions_of(const RaySampling& sampling, const Viewport& viewport) {
  std::vector<EightPositions> all;
  if (sampling.aim == RaySampling::Aim::jittered) {
    const JitteredSamples jittered(viewport, sampling.samples, sampling.seed);
    const int columns = (viewport.width + tile_width - 1) / tile_width;
    const int rows = (viewport.height + tile_height - 1) / tile_height;
    const auto packets = static_cast<std::size_t>(jittered.packets_per_tile());
    all.resize(packets * columns * rows);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        jittered.tile(x, y, &all[packets * (static_cast<std::size_t>(y) * columns + x)]);
      }
    }
    return all;
  }
  std::size_t count = 0;
  for (double y = sampling.offset_y_px; y < viewport.height; y += sampling.every_px) {
    for (double x = sampling.offset_x_px; x < viewport.width; x += sampling.every_px) {
      if (count % 8 == 0) all.emplace_back().x.fill(viewport.width);
      all.back().x[count % 8] = x;
      all.back().y[count % 8] = y;
      ++count;
    }
  }
  if (count % 8 != 0) std::fill(&all.back().y[count % 8], all.back().y.end(), viewport.height);
  return all;
}

class SceneProbe : public RayProbe {
 public:
  SceneProbe(const Scene& scene, const RaySampling& sampling)
      : scene_(&scene),
        sampling_(sampling),
        rays_(scene, {sampling.robust, sampling.instruction_set}),
        truth_(scene, {}) {}

  const RayFindings& look(const Frame& frame) override {
    const auto [entry, is_new] = frames_.try_emplace(frame.index);
    if (is_new) trace(frame, entry->second);
    return entry->second.findings;
  }
  std::span<const ObjectId> visible_objects(std::uint64_t frame_index) const override {
    return frames_.at(frame_index).parts.objects;
  }
  std::span<const TriangleRange> visible_triangles(std::uint64_t frame_index) const override {
    return frames_.at(frame_index).parts.triangles;
  }

 private:
  struct Looked {
    RayFindings findings;
    SeenParts parts;
  };

  void trace(const Frame& frame, Looked& looked) {
    rays_.follow(frame.objects);
    counts_.assign(scene_->triangle_count(), 0);
    const RayMaker maker(frame.camera, frame.viewport, scene_->origin());
    const std::vector<EightPositions> positions = positions_of(sampling_, frame.viewport);
    std::vector<glm::dvec2> window_px;
    std::vector<TriangleId> named;  // by ray, of a lattice
    for (const EightPositions& eight : positions) {
      EightVectors varying;
      maker.vary({&eight, 1}, &varying);
      for (int lane = 0; lane < 8; ++lane) {
        if (eight.x[lane] >= frame.viewport.width || eight.y[lane] >= frame.viewport.height) {
          continue;
        }
        const TriangleId first =
            cast(maker, {varying.x[lane], varying.y[lane], varying.z[lane]}, looked.findings);
        if (sampling_.aim != RaySampling::Aim::lattice) continue;
        window_px.push_back(eight[lane]);
        named.push_back(first);
      }
    }
    if (!named.empty()) {
      const std::vector<RayCaster::Hit> truth = truth_.cast(frame, window_px, nullptr);
      for (std::size_t i = 0; i < named.size(); ++i) {
        looked.findings.other += truth[i].triangle != named[i] ? 1 : 0;
      }
    }
    std::vector<TriangleId> seen;
    for (TriangleId id = 0; id < counts_.size(); ++id) {
      if (counts_[id] == 0) continue;
      seen.push_back(id);
      looked.findings.seen_once += counts_[id] == 1 ? 1 : 0;
    }
    looked.findings.triangles = seen.size();
    looked.parts = seen_parts(*scene_, seen);
  }

  /// Counts what the ray meets; the triangle that it meets first.
  TriangleId cast(const RayMaker& maker, const glm::vec3& varying, RayFindings& findings) {
    const glm::vec3 from = maker.orthographic() ? varying : maker.common();
    const glm::vec3 along = maker.orthographic() ? maker.common() : varying;
    ++findings.rays;
    met_.clear();
    float farthest = maker.far_distance();
    for (;;) {
      RTCRayHit ray{};
      ray.ray.org_x = from.x;
      ray.ray.org_y = from.y;
      ray.ray.org_z = from.z;
      ray.ray.dir_x = along.x;
      ray.ray.dir_y = along.y;
      ray.ray.dir_z = along.z;
      ray.ray.tnear = maker.near_distance();
      ray.ray.tfar = farthest;
      ray.ray.mask = 0xFFFFFFFFU;
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      PassContext<Met> context{{}, &rays_, {&met_}};
      rtcInitIntersectContext(&context.embree);
      if (!met_.empty()) context.embree.filter = pass_filter<Met>;
      rtcIntersect1(rays_.handle(), &context.embree, &ray);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
      const TriangleId triangle =
          rays_.triangle_of(ray.hit.geomID, ray.hit.primID, ray.hit.instID[0]);
      if (met_.empty()) farthest = ray.ray.tfar * (1.0F + same_depth);
      met_.push_back(triangle);
      ++counts_[triangle];
      if (!sampling_.every_nearest) break;
    }
    if (met_.empty()) return none_id;
    ++findings.hits;
    findings.ties += met_.size() > 1 ? 1 : 0;
    return met_.front();
  }

  const Scene* scene_;
  RaySampling sampling_;
  RayScene rays_;
  RayCaster truth_;
  std::vector<std::uint32_t> counts_;  // scratch, by triangle: rays that met it first
  std::vector<TriangleId> met_;        // scratch, by one ray
  std::map<std::uint64_t, Looked> frames_;
};

void require_range(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError("rays, " + std::string(name) + ": " + std::to_string(value) +
                   " is out of range; " + std::to_string(low) + " to " + std::to_string(high) +
                   " is right");
}

}  // namespace

std::unique_ptr<RayProbe> make_ray_probe(const Scene& scene, const RaySampling& sampling) {
  require_range("samples", sampling.samples, 1, 4096);
  require_range("every_px", sampling.every_px, 1, 4096);
  require_range("offset_x_px", sampling.offset_x_px, 0.0, sampling.every_px);
  require_range("offset_y_px", sampling.offset_y_px, 0.0, sampling.every_px);
  return std::make_unique<SceneProbe>(scene, sampling);
}

}  // namespace vislab
