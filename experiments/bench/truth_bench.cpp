// Truth end to end against the bare ray tracer: what making rays, writing ids, counting the
// histogram and telling clear hits apart cost on top of tracing. The same rays, tree, threads and
// packets.
#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstring>

#include "common/judge/samples.h"
#include "common/judge/truth.h"
#include "common/scene/library.h"
#include "experiments/bench/bench.h"

namespace vislab {
namespace {

constexpr Viewport viewport{512, 512};
constexpr int threads = 2;

/// All rays of a frame, kept, and nothing done with what they hit but to keep it. Perspective
/// cameras, and scenes without changes.
class BareTracer {
 public:
  BareTracer(const Scene& scene, const Camera& camera, const TruthSettings& settings)
      : maker_(camera, viewport, scene.origin()), arena_(threads) {
    build(scene);
    const JitteredSamples jittered(viewport, settings.jitter_per_pixel, settings.seed);
    std::vector<EightPositions> positions(1 + jittered.packets_per_tile());
    std::vector<EightVectors> directions(positions.size());
    for (int y = 0; y < viewport.height / tile_height; ++y) {
      for (int x = 0; x < viewport.width / tile_width; ++x) {
        positions[0] = pixel_centres(x, y);
        jittered.tile(x, y, &positions[1]);
        maker_.vary(positions, directions.data());
        for (const EightVectors& eight : directions) packets_.push_back({eight, {}});
      }
    }
  }
  ~BareTracer() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareTracer(const BareTracer&) = delete;
  BareTracer& operator=(const BareTracer&) = delete;

  void trace() {
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, packets_.size(), packets_in_block),
                        [&](const tbb::blocked_range<std::size_t>& range) { trace(range); });
    });
  }

  std::size_t ray_count() const { return packets_.size() * 8; }

  /// Which triangles were hit at the pixel centres, and how often in set J.
  FrameTruth truth(std::size_t triangle_count) const {
    FrameTruth truth;
    truth.ids.resize(static_cast<std::size_t>(viewport.width) * viewport.height);
    std::vector<std::uint32_t> counts(triangle_count);
    const std::size_t packets_in_tile = packets_.size() * 8 / truth.ids.size();
    constexpr std::size_t columns = viewport.width / tile_width;
    for (std::size_t i = 0; i < packets_.size(); ++i) {
      const std::size_t tile = i / packets_in_tile;
      for (std::size_t lane = 0; lane < 8; ++lane) {
        const unsigned id = packets_[i].hit[lane];
        if (i % packets_in_tile == 0) {
          const std::size_t x = tile % columns * tile_width + lane % tile_width;
          const std::size_t y = tile / columns * tile_height + lane / tile_width;
          truth.ids[y * viewport.width + x] = id;
        } else if (id != none_id) {
          ++counts[id];
        }
      }
    }
    for (std::uint32_t id = 0; id < counts.size(); ++id) {
      if (counts[id] > 0) truth.hits.push_back({id, counts[id], 0});
    }
    return truth;
  }

 private:
  static constexpr std::size_t packets_in_block = 64;

  struct Packet {
    EightVectors directions;
    std::array<unsigned, 8> hit;
  };

  void trace(const tbb::blocked_range<std::size_t>& range) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(32) std::array<int, 8> active;
    active.fill(-1);
    RTCRayHit8 rays{};
    std::fill_n(rays.ray.org_x, 8, maker_.common().x);
    std::fill_n(rays.ray.org_y, 8, maker_.common().y);
    std::fill_n(rays.ray.org_z, 8, maker_.common().z);
    std::fill_n(rays.ray.tnear, 8, maker_.near_distance());
    std::fill_n(rays.ray.mask, 8, 0xFFFFFFFFU);
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      Packet& packet = packets_[i];
      std::memcpy(rays.ray.dir_x, packet.directions.x.data(), sizeof(float) * 8);
      std::memcpy(rays.ray.dir_y, packet.directions.y.data(), sizeof(float) * 8);
      std::memcpy(rays.ray.dir_z, packet.directions.z.data(), sizeof(float) * 8);
      std::fill_n(rays.ray.tfar, 8, maker_.far_distance());
      std::fill_n(rays.hit.geomID, 8, RTC_INVALID_GEOMETRY_ID);
      std::fill_n(rays.hit.primID, 8, none_id);
      rtcIntersect8(active.data(), scene_, &context, &rays);
      std::memcpy(packet.hit.data(), rays.hit.primID, sizeof packet.hit);
    }
  }

  void build(const Scene& scene) {
    device_ = rtcNewDevice("isa=avx2");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    std::vector<glm::vec3> vertices;
    std::vector<glm::uvec3> triangles;
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      const Mesh& mesh = scene.mesh_of(object);
      const auto base = static_cast<unsigned>(vertices.size());
      for (const glm::vec3& p : mesh.positions) {
        vertices.emplace_back(scene.objects[object].transform * glm::dvec4(p, 1.0) -
                              scene.origin());
      }
      for (const glm::uvec3& t : mesh.triangles) triangles.push_back(t + base);
    }
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertex_buffer = rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), vertices.size());
    std::copy(vertices.begin(), vertices.end(), static_cast<glm::vec3*>(vertex_buffer));
    void* index_buffer = rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), triangles.size());
    std::copy(triangles.begin(), triangles.end(), static_cast<glm::uvec3*>(index_buffer));
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, 0);
    rtcReleaseGeometry(geometry);
    tbb::task_arena one_thread(1);
    one_thread.execute([&] { rtcJoinCommitScene(scene_); });
  }

  RayMaker maker_;
  tbb::task_arena arena_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<Packet> packets_;
};

class TruthContest : public Contest {
 public:
  explicit TruthContest(const std::string& name)
      : loaded_(load_scene(name, folders())),
        path_(load_path(loaded_.default_path, loaded_.scene, viewport, 2, folders())),
        state_(loaded_.scene),
        caster_(loaded_.scene, settings_),
        bare_(loaded_.scene, path_.frames.front().camera, settings_) {
    frame_.viewport = viewport;
    frame_.camera = path_.frames.front().camera;
    frame_.objects = state_.view();
  }

  void ours() override { truth_ = caster_.trace(frame_); }
  void theirs() override { bare_.trace(); }
  bool equal() override {
    const FrameTruth bare = bare_.truth(loaded_.scene.triangle_count());
    return bare.ids == truth_.ids &&
           std::ranges::equal(bare.hits, truth_.hits, [](const auto& a, const auto& b) {
             return a.triangle == b.triangle && a.hits == b.hits;
           });
  }
  double work() const override { return static_cast<double>(bare_.ray_count()) * 1e-6; }

 private:
  static DataFolders folders() {
    const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
    return {data, data / "cache"};
  }

  TruthSettings settings_{.jitter_per_pixel = 16, .seed = 1, .threads = threads};
  LoadedScene loaded_;
  Path path_;
  SceneState state_;
  RayCaster caster_;
  BareTracer bare_;
  Frame frame_;
  FrameTruth truth_;
};

}  // namespace
}  // namespace vislab

int main(int argc, char** argv) {
  std::vector<vislab::BenchCase> cases;
  for (const char* scene : {"dragon", "hares_56", "city", "oa_dm2"}) {
    cases.push_back({"truth", scene, "Mray/s", "bare rtcIntersect8",
                     [scene] { return std::make_unique<vislab::TruthContest>(scene); }});
  }
  return vislab::run_benchmarks(argc, argv, cases);
}
