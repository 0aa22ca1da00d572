// Every frustum culler that calls itself conservative, held to exact arithmetic on boxes and
// triangles made to break it: whatever it leaves out is outside of the frustum.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "algorithms/all_cullers.h"
#include "common/culler/visible_set.h"
#include "tests/geometry/adversarial_boxes.h"
#include "tests/geometry/exact_judge.h"

namespace vislab {
namespace {

using test::adversarial_box;
using test::adversarial_camera;
using test::description_of;
using test::ExactJudge;
using test::random_vector;
using test::touching_box;
using test::touching_camera;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int camera_count = 160;  // the cullers take ten times as long
#else
constexpr int camera_count = 4'100;
#endif
constexpr int boxes_per_camera = 250;
/// Where the camera is moved to boxes of its world, to touch them as nearly as double allows.
constexpr std::uint64_t touches_per_camera = 5;
/// Most variants are given each so manieth world only, and in these the camera turns too.
constexpr int part = 20;

/// What a variant's volumes are made of.
enum class Volumes { boxes, meshes };

struct Variant {
  std::string spec;
  int every = 1;  // only each so manieth world
  Volumes volumes = Volumes::boxes;
};

/// The defaults and the main choices see every world, the others a part.
std::vector<Variant> object_variants() {
  std::vector<Variant> variants{{"frustum.flat"},         {"frustum.flat[kernel=scalar]"},
                                {"frustum.bvh"},          {"frustum.bvh[layout=binary]"},
                                {"frustum.octree"},       {"frustum.two_step"},
                                {"frustum.loose_octree"}, {"frustum.loose_octree[overlap=0]"},
                                {"frustum.bsp"}};
  const auto add = [&](const std::string& culler, std::initializer_list<const char*> choices) {
    for (const char* choice : choices) variants.push_back({culler + "[" + choice + "]", part});
  };
  add("frustum.flat", {"early_out=off", "test=corners", "test=exact", "test=sphere",
                       "intersecting=refine", "test=corners,intersecting=refine"});
  add("frustum.bvh",
      {"build=top_down", "build=bottom_up", "build=incremental", "motion=rebuild", "motion=enlarge",
       "motion=reinsert", "layout=binary,build=top_down", "layout=binary,build=bottom_up",
       "layout=binary,build=incremental", "layout=binary,motion=rebuild", "masking=false",
       "layout=binary,leaf_size=1", "intersecting=keep", "test=exact", "test=sphere"});
  add("frustum.octree", {"leaf_size=4", "leaf_size=1,depth=12", "test=exact"});
  add("frustum.two_step",
      {"leaf_size=4", "leaf_size=1,nodes=inner,depth=10", "intersecting=refine"});
  add("frustum.loose_octree",
      {"leaf_size=0", "overlap=0,leaf_size=0", "overlap=0.5,leaf_size=1,depth=16"});
  add("frustum.bsp", {"straddlers=node", "straddlers=both", "straddlers=node,leaf_size=2",
                      "straddlers=both,leaf_size=2", "straddlers=centre,leaf_size=1",
                      "split=midpoint,leaf_size=2", "split=median,leaf_size=2"});
  for (const char* culler : {"frustum.flat", "frustum.bvh", "frustum.octree", "frustum.two_step",
                             "frustum.loose_octree", "frustum.bsp"}) {
    add(culler, {"plane_coherence=true", "motion_coherence=true", "octant=true", "meta=sphere",
                 "meta=box", "plane_coherence=true,motion_coherence=true,octant=true,meta=sphere"});
    for (const char* choice : {"test=sphere,sphere=farthest", "test=sphere,sphere=ritter",
                               "test=obb", "test=dual", "test=dual,sphere=ritter"}) {
      variants.push_back({std::string(culler) + "[" + choice + "]", part, Volumes::meshes});
    }
  }
  return variants;
}

std::vector<Variant> triangle_variants() {
  return {{"frustum.polygon"},
          {"frustum.mesh_octree"},
          {"frustum.mesh_octree[leaf_size=8]"},
          {"frustum.mesh_octree[leaf_size=1,depth=12]"}};
}

/// All points within 1 of the origin along each axis.
Mesh unit_cube() {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                (corner & 4) != 0 ? 1 : -1);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Would a scene take an object that is placed so? `least_volume` is that of the box in terms of a
/// box that has the same edges at right angles.
bool fits_a_scene(const OrientedBox& box, double least_volume) {
  const glm::dmat3& axes = box.half_axes;
  double greatest = 0.0;
  for (int i = 0; i < 3; ++i) {
    greatest += std::abs(box.center[i]) + glm::length(axes[i]);
  }
  const double lengths = glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]);
  return greatest < 0.1 * max_scene_coordinate_m && lengths > 1e-30 &&
         std::abs(glm::determinant(axes)) > least_volume * lengths;
}

/// Boxes of any orientation around the given ones, as objects; a unit cube near to the camera for
/// those that no scene takes.
Scene scene_of(Random& random, const Camera& camera, const std::vector<Aabb>& boxes) {
  Scene scene;
  scene.meshes = {unit_cube()};
  for (const Aabb& box : boxes) {
    OrientedBox placed = touching_box(random, camera, box);
    if (!fits_a_scene(placed, 1e-6)) {
      placed = {camera.pose.eye + random_vector(random, 10.0), glm::dmat3(1.0)};
    }
    const glm::dmat3& axes = placed.half_axes;
    scene.objects.push_back({0, {axes[0], axes[1], axes[2], placed.center}, none_id});
  }
  scene.finish();
  return scene;
}

/// Turned about its own up or right.
Camera turned(Random& random, Camera camera) {
  const double angle = random.uniform(-1.0, 1.0) * (random.below(2) == 0 ? 0.05 : 3.0);
  Pose& pose = camera.pose;
  glm::dvec3& side = random.below(2) == 0 ? pose.right : pose.up;
  const glm::dvec3 before = side;
  side = std::cos(angle) * before + std::sin(angle) * pose.back;
  pose.back = std::cos(angle) * pose.back - std::sin(angle) * before;
  return camera;
}

/// Moves the mesh so that it touches a plane from outside as nearly as double allows.
void touch_a_plane(Random& random, const Camera& camera, const Mesh& mesh,
                   glm::dmat4x3& transform) {
  const Frustum frustum = frustum_of(camera);
  const Plane& plane =
      frustum.planes[random.below(static_cast<std::uint64_t>(frustum.plane_count))];
  double farthest = -std::numeric_limits<double>::infinity();
  for (const glm::vec3& position : mesh.positions) {
    farthest = std::max(farthest, plane.signed_distance(transform * glm::dvec4(position, 1.0)));
  }
  const double nudge = random.uniform(-1.0, 1.0) * 0x1p-52 * glm::length(transform[3]);
  transform[3] -= plane.normal * (farthest + nudge);
}

/// What the exact judge says of the objects before one camera; asked only once of each.
class Verdicts {
 public:
  /// `placed` is empty where an object is all of its box.
  Verdicts(const Camera& camera, std::span<const Aabb> boxes, std::span<const Object> placed)
      : judge_(camera), boxes_(boxes), placed_(placed), verdicts_(boxes.size(), Verdict::open) {}

  bool outside(ObjectId object) {
    Verdict& verdict = verdicts_[object];
    if (verdict == Verdict::open) {
      verdict = is_outside(object) ? Verdict::outside : Verdict::touching;
    }
    return verdict == Verdict::outside;
  }

 private:
  enum class Verdict { open, outside, touching };

  bool is_outside(ObjectId object) const {
    if (!placed_.empty()) {
      const glm::dmat4x3& transform = placed_[object].transform;
      const OrientedBox box{transform[3], glm::dmat3(transform[0], transform[1], transform[2])};
      if (judge_.outside_of_a_plane(box)) return true;
    } else if (judge_.outside_of_a_plane(boxes_[object])) {
      return true;
    }
    return judge_.disjoint(boxes_[object]);
  }

  ExactJudge judge_;
  std::span<const Aabb> boxes_;
  std::span<const Object> placed_;
  std::vector<Verdict> verdicts_;
};

/// A camera that touches an object.
struct Touch {
  ObjectId object = 0;
  Camera camera;
  std::unique_ptr<Verdicts> verdicts;
};

class CullerExactness : public testing::Test {
 protected:
  struct Counts {
    std::uint64_t offered = 0;
    std::uint64_t left_out = 0;
  };

  CullerExactness() { register_all_cullers(registry_); }

  std::unique_ptr<ICuller> built(const Variant& variant, const Scene& scene) const {
    std::unique_ptr<ICuller> culler = registry_.make(variant.spec);
    EXPECT_EQ(culler->info().guarantee, Guarantee::conservative) << variant.spec;
    BuildContext context;
    context.cullers = &registry_;
    culler->build(scene, context);
    culler->reset(1);
    return culler;
  }

  /// Per triangle of the scene: is it kept?
  const std::vector<bool>& kept(ICuller& culler, const Scene& scene, const Frame& frame,
                                const Changes& changes) {
    culler.update(frame, changes);
    sink_.start(scene, frame);
    culler.cull(frame, Candidates::everything(), sink_);
    kept_.assign(scene.triangle_count(), false);
    for (const TriangleRange& range : sink_.emitted()) {
      const auto first = kept_.begin() + scene.first_triangle(range.object) + range.first;
      std::fill(first, first + range.count, true);
    }
    return kept_;
  }

  void judge_objects(const Variant& variant, ICuller& culler, const Scene& scene,
                     const Frame& frame, const Changes& changes, std::span<const ObjectId> judged,
                     Verdicts& verdicts, Counts& counts) {
    const std::vector<bool>& keeps = kept(culler, scene, frame, changes);
    for (const ObjectId object : judged) {
      ++counts.offered;
      if (keeps[scene.first_triangle(object)]) continue;
      ++counts.left_out;
      EXPECT_TRUE(verdicts.outside(object))
          << variant.spec << " leaves out object " << object << " in frame " << frame.index << "\n"
          << description_of(frame.camera, frame.objects.bounds[object]);
    }
  }

  static void print(const Variant& variant, const Counts& counts, const char* what) {
    std::cout << variant.spec << ": " << counts.offered << ' ' << what << ", " << counts.left_out
              << " left out\n";
    EXPECT_GT(counts.left_out, 0U) << variant.spec;
  }

  Registry registry_;
  RecordingSink sink_;
  std::vector<bool> kept_;
};

TEST_F(CullerExactness, ConservativeCullersLeaveOutOnlyBoxesThatAreOutsideInExactArithmetic) {
  const std::vector<Variant> variants = object_variants();
  std::vector<Counts> counts(variants.size());
  Changes all;
  for (ObjectId object = 0; object < boxes_per_camera; ++object) all.moved.push_back(object);
  Random random(21);
  for (int i = 0; i < camera_count && !HasFailure(); ++i) {
    const Camera camera = adversarial_camera(random);
    std::vector<Aabb> boxes;
    while (boxes.size() < boxes_per_camera) boxes.push_back(adversarial_box(random, camera));
    const Scene scene = scene_of(random, camera, boxes);
    const SceneState state(scene);
    all.transforms.assign(state.view().transforms.begin(), state.view().transforms.end());
    const bool turns = i % part == 0;
    const Camera by_turning = turned(random, camera);

    Verdicts as_built(camera, state.view().bounds, scene.objects);
    Verdicts as_moved(camera, boxes, {});
    Verdicts after_turn(by_turning, boxes, {});
    std::vector<Touch> touches;
    for (std::uint64_t t = 0; t < touches_per_camera; ++t) {
      const auto object = static_cast<ObjectId>(random.below(boxes.size()));
      const Camera from = touching_camera(random, camera, boxes[object]);
      touches.push_back(
          {object, from, std::make_unique<Verdicts>(from, boxes, std::span<const Object>())});
    }
    // Of the boxes, structures know those of the placed cubes first, then those that are not.
    ObjectsView handed_in = state.view();
    handed_in.bounds = boxes;
    for (std::size_t v = 0; v < variants.size(); ++v) {
      const Variant& variant = variants[v];
      if (i % variant.every != 0) continue;
      const auto culler = built(variant, scene);
      const auto judge = [&](std::uint64_t frame, const Camera& from, const ObjectsView& objects,
                             const Changes& changes, std::span<const ObjectId> judged,
                             Verdicts& verdicts) {
        judge_objects(variant, *culler, scene, {frame, from, {64, 64}, objects, 0.0}, changes,
                      judged, verdicts, counts[v]);
      };
      judge(0, camera, state.view(), {}, all.moved, as_built);
      if (variant.volumes == Volumes::meshes) continue;
      judge(1, camera, handed_in, all, all.moved, as_moved);
      if (turns) {
        judge(2, by_turning, handed_in, {}, all.moved, after_turn);
        judge(3, camera, handed_in, {}, all.moved, as_moved);
      }
      for (std::uint64_t t = 0; t < touches.size(); ++t) {
        Touch& touch = touches[t];
        judge(4 + t, touch.camera, handed_in, {}, std::span(&touch.object, 1), *touch.verdicts);
      }
    }
  }
  std::cout << camera_count << " cameras, " << boxes_per_camera << " boxes before each\n";
  for (std::size_t v = 0; v < variants.size(); ++v) print(variants[v], counts[v], "boxes");
}

TEST_F(CullerExactness, ConservativeCullersLeaveOutOnlyTrianglesThatAreOutsideInExactArithmetic) {
  // A large one, which octrees divide, and small ones, which may be outside as a whole.
  constexpr std::array<std::size_t, 14> triangle_counts{150, 50, 25, 10, 3, 2, 2,
                                                        2,   1,  1,  1,  1, 1, 1};
  const std::vector<Variant> variants = triangle_variants();
  std::vector<Counts> counts(variants.size());
  Random random(22);
  for (int i = 0; i < camera_count && !HasFailure(); ++i) {
    const Camera camera = adversarial_camera(random);
    Scene scene;
    for (MeshId m = 0; m < triangle_counts.size(); ++m) {
      // The mesh's frame: the world, or any other near to the camera.
      glm::dmat4x3 transform(1.0);
      if (m % 3 != 0) {
        OrientedBox frame = touching_box(random, camera, adversarial_box(random, camera));
        if (!fits_a_scene(frame, 0.1))
          frame.half_axes = glm::dmat3(0.3, 0.4, 0.1, 0, 2, 0, 0, 0.2, -1);
        const glm::dmat3& axes = frame.half_axes;
        transform = {axes[0], axes[1], axes[2], camera.pose.eye + random_vector(random, 10.0)};
      }
      const glm::dmat3 back = glm::inverse(glm::dmat3(transform));
      Mesh mesh;
      while (mesh.triangles.size() < triangle_counts[m]) {
        const Aabb box = adversarial_box(random, camera);
        for (int corner = 0; corner < 3; ++corner) {
          glm::dvec3 point(0.0);
          for (int axis = 0; axis < 3; ++axis) {
            point[axis] = random.below(2) == 0 ? box.min[axis] : box.max[axis];
          }
          const bool far = glm::length(point) > 1e-3 * max_scene_coordinate_m;
          if (far) point = camera.pose.eye + random_vector(random, 10.0);
          mesh.positions.emplace_back(back * (point - transform[3]));
        }
        const auto first = static_cast<std::uint32_t>(mesh.positions.size()) - 3;
        mesh.triangles.emplace_back(first, first + 1, first + 2);
      }
      if (mesh.triangles.size() == 1) touch_a_plane(random, camera, mesh, transform);
      scene.meshes.push_back(std::move(mesh));
      scene.objects.push_back({m, transform, none_id});
    }
    scene.finish();
    const SceneState state(scene);
    const ExactJudge judge(camera);
    enum class Verdict { open, outside, touching };
    std::vector<Verdict> verdicts(scene.triangle_count(), Verdict::open);
    for (std::size_t v = 0; v < variants.size(); ++v) {
      const auto culler = built(variants[v], scene);
      const std::vector<bool>& keeps =
          kept(*culler, scene, {0, camera, {64, 64}, state.view(), 0.0}, {});
      counts[v].offered += keeps.size();
      for (TriangleId id = 0; id < keeps.size(); ++id) {
        if (keeps[id]) continue;
        ++counts[v].left_out;
        const ObjectId object = scene.object_of(id);
        const Mesh& mesh = scene.mesh_of(object);
        const glm::uvec3 corners = mesh.triangles[id - scene.first_triangle(object)];
        const std::array<glm::vec3, 3> triangle{
            mesh.positions[corners.x], mesh.positions[corners.y], mesh.positions[corners.z]};
        if (verdicts[id] == Verdict::open) {
          verdicts[id] = judge.outside_of_a_plane(triangle, scene.objects[object].transform)
                             ? Verdict::outside
                             : Verdict::touching;
        }
        EXPECT_EQ(verdicts[id], Verdict::outside)
            << variants[v].spec << " leaves out triangle " << id << "\n"
            << description_of(camera, bounds_of(triangle));
      }
    }
  }
  for (std::size_t v = 0; v < variants.size(); ++v) print(variants[v], counts[v], "triangles");
}

TEST_F(CullerExactness, NoConservativeFrustumCullerIsForgotten) {
  std::set<std::string> judged;
  for (const auto& variants : {object_variants(), triangle_variants()}) {
    for (const Variant& variant : variants) {
      judged.insert(variant.spec.substr(0, variant.spec.find('[')));
    }
  }
  for (const auto& [name, entry] : registry_.entries()) {
    if (entry.info.family == "frustum" && entry.info.guarantee == Guarantee::conservative) {
      EXPECT_TRUE(judged.contains(name)) << name;
    }
  }
}

}  // namespace
}  // namespace vislab
