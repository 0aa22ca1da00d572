// Normal masks: what a look-up takes against a plane test and against reading alone, and what share
// of the back faces they find in views of different width; whole cullers, building and memory.
#include <cmath>
#include <optional>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/masked_mesh.h"
#include "algorithms/backface/plane_kernel.h"
#include "common/culler/visible_set.h"
#include "experiments/bench/backface/cases.h"
#include "experiments/bench/backface/costs.h"
#include "experiments/bench/backface/normals_field.h"
#include "experiments/bench/backface/streaming_read.h"
#include "experiments/bench/backface/world_contests.h"

namespace vislab {
namespace {

using namespace backface_culling;

constexpr std::uint32_t copies = 16;
constexpr int source_n = 16;
constexpr int source_sectors = 8;

/// 16 times the 1,002,252 triangles of the sphere with high bumps, seen by one of its world's eyes,
/// and what is known of them: their classes, their planes, and which are back faces.
class ManyTriangles {
 public:
  ManyTriangles() : masks_(DirectionCube(source_n), source_sectors), marker_(masks_) {
    const auto world = FacingWorld::of("high");
    constexpr std::size_t eye = 20;
    Mesh mesh = world->mesh();
    one_copy_ = static_cast<std::uint32_t>(mesh.triangles.size());
    is_back_.assign(world->back(eye).begin(), world->back(eye).end());
    mesh.triangles.reserve(std::size_t{copies} * one_copy_);
    for (std::uint32_t i = 1; i < copies; ++i) {
      mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(),
                            mesh.triangles.begin() + one_copy_);
    }
    frame_ = MeshFrame(mesh);
    camera_ = world->camera(eye);
    eye_ = eye_in_mesh(camera_, glm::dmat4x3(1.0), frame_);
    classes_ = MaskedMesh(mesh, frame_, masks_.cube());
    planes_.emplace(mesh, frame_);
    back_.resize(words_of(count()));
    // The mask of the whole view, which holds the sphere.
    masks_.start(camera_, 0);
    masks_.select(glm::dmat3(1.0));
    const auto first = static_cast<std::uint8_t>(SectorLines::lines_beyond);
    const auto last = static_cast<std::uint8_t>(first + source_sectors);
    const std::uint16_t number = masks_.number_of({first, last, first, last});
    view_mask_ = masks_.masks()[number];
  }

  std::uint32_t count() const { return copies * one_copy_; }

  /// One mask for all.
  void look_up_all() {
    look_up(view_mask_, classes_.offsets(), classes_.bits(), count(), back_.data());
  }
  /// What backface.normal_mask does in a frame, masks and sectors included.
  void mark_by_sectors() {
    masks_.reset();
    masks_.start(camera_, 0);
    marker_.start(classes_, frame_, camera_, glm::dmat4x3(1.0));
    marker_.mark(0, count(), back_.data());
  }
  /// What backface.polygon does.
  void test_planes() { mark_behind(*planes_, plane_test(*eye_, frame_), 0, count(), back_.data()); }
  void read() { sum_ = streaming_read(classes_.offsets(), classes_.bits(), count() / 128 * 128); }

  /// Are the triangles of the last answer all seen from behind, and is it a good part of them?
  bool is_right() const {
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < count(); ++i) {
      if ((back_[i / 64] >> (i % 64) & 1) == 0) continue;
      const std::uint32_t original = i % one_copy_;
      if ((is_back_[original / 64] >> (original % 64) & 1) == 0) return false;
      ++found;
    }
    return found > count() / 8;
  }
  bool sum_is_right() const {
    std::uint64_t sum = 0;
    const auto add = [&](const std::uint8_t* bytes) {
      for (std::size_t i = 0; i < count() / 128 * 128; ++i) {
        sum += std::uint64_t{bytes[i]} << (8 * (i % 8));
      }
    };
    add(classes_.offsets());
    add(classes_.bits());
    return sum == sum_;
  }

 private:
  ViewMasks masks_;
  MaskMarker marker_;
  std::uint32_t one_copy_ = 0;
  MeshFrame frame_;
  Camera camera_;
  std::optional<MeshEye> eye_;
  MaskedMesh classes_;
  std::optional<PlaneArrays> planes_;
  BackMask view_mask_;
  std::vector<std::uint64_t> is_back_;  // bits of one copy
  std::vector<std::uint64_t> back_;
  std::uint64_t sum_ = 0;
};

enum class Against { planes, reading };

class LookUpContest : public Contest {
 public:
  LookUpContest(std::shared_ptr<ManyTriangles> triangles, bool sectors, Against against)
      : triangles_(std::move(triangles)), sectors_(sectors), against_(against) {}

  void ours() override {
    for (int i = 0; i < passes; ++i) {
      if (sectors_) {
        triangles_->mark_by_sectors();
      } else {
        triangles_->look_up_all();
      }
    }
  }
  void theirs() override {
    for (int i = 0; i < passes; ++i) {
      if (against_ == Against::planes) {
        triangles_->test_planes();
      } else {
        triangles_->read();
      }
    }
  }
  bool equal() override {
    ours();
    const bool right = triangles_->is_right();
    theirs();
    return right &&
           (against_ == Against::planes ? triangles_->is_right() : triangles_->sum_is_right());
  }
  /// Millions of triangles.
  double work() const override { return passes * 1e-6 * triangles_->count(); }

 private:
  /// One pass takes a millisecond, which is less than what a busy system takes away at a time.
  static constexpr int passes = 8;

  std::shared_ptr<ManyTriangles> triangles_;
  bool sectors_;
  Against against_;
};

/// Share of the back faces that the culler leaves out of a field of normals; equal: nothing else.
Measurement share_found(double fov_deg, int sectors) {
  const NormalsField field = normals_field(fov_deg, 24, 1000, 5);
  const SceneState state(field.scene);
  const Frame frame{0, field.camera, {512, 512}, state.view(), 0.0};
  Registry registry;
  register_all_cullers(registry);
  const auto culler =
      registry.make("backface.normal_mask[n=16,sectors=" + std::to_string(sectors) + "]");
  culler->build(field.scene, {});
  RecordingSink sink;
  sink.start(field.scene, frame);
  culler->cull(frame, Candidates::everything(), sink);
  std::vector<bool> kept(field.scene.triangle_count(), false);
  for (const TriangleRange& range : sink.emitted()) {
    for (std::uint32_t i = 0; i < range.count; ++i) {
      kept[field.scene.first_triangle(range.object) + range.first + i] = true;
    }
  }
  std::uint64_t back = 0;
  std::uint64_t found = 0;
  bool right = field.scene.meshes[0].solid;
  for (ObjectId object = 0; object < field.scene.object_count(); ++object) {
    const Mesh& mesh = field.scene.mesh_of(object);
    const MeshFrame mesh_frame(mesh);
    const std::optional<MeshEye> eye =
        eye_in_mesh(field.camera, field.scene.objects[object].transform, mesh_frame);
    const double limit = behind_limit(*eye, mesh_frame);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      // The limit is 1e-10 of the distance or less; none of these planes passes the eye so near.
      const double side = glm::dot(scaled_plane(mesh, mesh_frame, i), eye->position);
      const bool left_out = !kept[field.scene.first_triangle(object) + i];
      back += side < -limit ? 1 : 0;
      found += left_out ? 1 : 0;
      right = right && std::abs(side) > limit && (!left_out || side < -limit);
    }
  }
  return {static_cast<double>(found) / static_cast<double>(back), right};
}

}  // namespace

void add_mask_cases(std::vector<BenchCase>& cases) {
  const std::string bench = "backface.normal_mask";
  // Cases share their triangles as long as one of them is at hand.
  const auto shared = std::make_shared<std::weak_ptr<ManyTriangles>>();
  const auto triangles = [shared] {
    std::shared_ptr<ManyTriangles> made = shared->lock();
    if (!made) {
      made = std::make_shared<ManyTriangles>();
      *shared = made;
    }
    return made;
  };
  for (const bool sectors : {false, true}) {
    const std::string name = sectors ? "16M triangles, 8 x 8 sectors" : "16M triangles";
    const auto contest = [&](const char* against, Against way, double most) {
      cases.push_back({bench,
                       name,
                       "Mtriangle/s",
                       against,
                       [=] { return std::make_unique<LookUpContest>(triangles(), sectors, way); },
                       {},
                       Bar::at_most(most)});
    };
    contest("backface.polygon", Against::planes, 1.0 / 3.0);
    contest("streaming read", Against::reading, 3.0);
  }
  for (const std::string world : {"sphere", "low", "high"}) {
    cases.push_back({bench, world + ", to ranges", "share", "backface.polygon", [=] {
                       return std::make_unique<CullersContest>(world, bench, "backface.polygon");
                     }});
    add_costs(cases, bench, world);
  }
  for (const int fov_deg : {30, 45, 60, 90, 120}) {
    for (const int sectors : {1, 4, 8}) {
      const std::string side = std::to_string(sectors);
      BenchCase share;
      share.bench = bench;
      share.name = std::to_string(fov_deg) + " degrees, " +
                   (sectors == 1 ? "1 sector" : side + " x " + side + " sectors");
      share.unit = "share";
      share.measure = [=] { return share_found(fov_deg, sectors); };
      cases.push_back(share);
    }
  }
}

}  // namespace vislab
