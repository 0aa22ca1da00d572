// Octrees and partitions as frustum cullers: what they keep is what frustum.flat keeps, or, where
// objects are repeated, less of what is outside.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "algorithms/frustum/traversal.h"
#include "common/geometry/random.h"
#include "common/spatial/bsp.h"
#include "common/spatial/leaf_octree.h"
#include "common/spatial/loose_octree.h"
#include "experiments/contract/contract.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"
#include "tests/geometry/adversarial_boxes.h"

namespace vislab {
namespace {

using frustum_culling::FrustumTester;
using frustum_culling::NodePolicy;
using frustum_culling::ObjectTester;
using frustum_culling::ObjectTestOptions;
using frustum_culling::Switches;
using frustum_culling::Traversal;

using Ids = std::vector<ObjectId>;

class IdSink : public DrawSink {
 public:
  void everything() override { FAIL(); }
  void objects(std::span<const ObjectId> ids) override {
    ids_.insert(ids_.end(), ids.begin(), ids.end());
  }
  void ranges(std::span<const TriangleRange>) override { FAIL(); }
  void flush() override { FAIL(); }

  Ids sorted() {
    std::ranges::sort(ids_);
    return ids_;
  }

 private:
  Ids ids_;
};

Ids sorted(Ids ids) {
  std::ranges::sort(ids);
  return ids;
}

template <typename Structure>
Ids kept(const Structure& structure, const Camera& camera, std::span<const Aabb> boxes,
         NodePolicy policy = NodePolicy::refine) {
  FrustumTester tester{Switches{}};
  ObjectTester objects{ObjectTestOptions{}};
  Traversal traversal(policy);
  traversal.build(boxes.size(), structure.repeats_objects());
  Frame frame;
  frame.camera = camera;
  frame.objects.bounds = boxes;
  IdSink sink;
  traversal.cull(structure, tester, objects, frame, sink);
  return sink.sorted();
}

Ids by_definition(const Camera& camera, std::span<const Aabb> boxes) {
  const Frustum frustum = frustum_of(camera);
  Ids ids;
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    const bool outside = std::ranges::any_of(
        frustum.span(), [&](const Plane& plane) { return surely_outside(plane, boxes[object]); });
    if (!outside) ids.push_back(object);
  }
  return ids;
}

/// Boxes that are hard for the frustum, a few of them broken. `near`: without the most extended
/// ones, beside which all others would be in one cell.
std::vector<Aabb> hard_boxes(Random& random, const Camera& camera, bool near) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 400; ++i) boxes.push_back(test::adversarial_box(random, camera));
  if (near) {
    const auto reach = [&](const Aabb& box) {
      const glm::dvec3 a = glm::abs(glm::dvec3(box.min) - camera.pose.eye);
      const glm::dvec3 b = glm::abs(glm::dvec3(box.max) - camera.pose.eye);
      return std::max({a.x, a.y, a.z, b.x, b.y, b.z});
    };
    std::ranges::stable_sort(boxes, {}, reach);
    boxes.resize(200);
  }
  boxes.push_back({glm::vec3(std::numeric_limits<float>::quiet_NaN()), glm::vec3(1.0F)});
  boxes.push_back({glm::vec3(0.0F), glm::vec3(std::numeric_limits<float>::infinity())});
  boxes.push_back({});
  return boxes;
}

template <typename Structure>
void expect_the_definition(const typename Structure::Limits& limits, std::uint64_t seed) {
  Random random(seed);
  std::size_t outside = 0;
  std::size_t deep = 0;
  for (int c = 0; c < 60; ++c) {
    const Camera camera = test::adversarial_camera(random);
    std::vector<Aabb> boxes = hard_boxes(random, camera, c % 3 != 0);
    Structure structure(limits);
    structure.build(boxes);
    const Ids expected = by_definition(camera, boxes);
    ASSERT_EQ(kept(structure, camera, boxes), expected) << "camera " << c;
    EXPECT_TRUE(std::ranges::includes(kept(structure, camera, boxes, NodePolicy::keep), expected));
    // All go elsewhere, one after the other.
    std::ranges::rotate(boxes, boxes.begin() + 50);
    for (ObjectId object = 0; object < boxes.size(); ++object) {
      structure.move(object, boxes[object]);
    }
    structure.finish_changes();
    ASSERT_EQ(kept(structure, camera, boxes), by_definition(camera, boxes)) << "camera " << c;
    outside += boxes.size() - expected.size();
    deep += structure.nodes().size() > 50 ? 1 : 0;
  }
  EXPECT_GT(outside, 1000U);
  EXPECT_GT(deep, 20U);
}

TEST(LooseOctreeCuller, KeepsExactlyWhatNoPlaneExcludesOfHardBoxes) {
  expect_the_definition<LooseOctree>({0.0, 8, 0.0, 0}, 21);
  expect_the_definition<LooseOctree>({5.0, 8, 0.0, 4}, 22);
  expect_the_definition<LooseOctree>({1e4, 12, 1.0, 1}, 23);
}

TEST(BspCuller, KeepsExactlyWhatNoPlaneExcludesOfHardBoxes) {
  using enum AxisBsp::Straddlers;
  using enum AxisBsp::Split;
  expect_the_definition<AxisBsp>({node, midpoint, 20, 2}, 24);
  expect_the_definition<AxisBsp>({node, cost, 20, 4}, 25);
  expect_the_definition<AxisBsp>({centre, median, 20, 1}, 26);
  expect_the_definition<AxisBsp>({centre, cost, 20, 4}, 27);
}

template <typename Structure>
void expect_no_less_than_what_is_inside(const typename Structure::Limits& limits,
                                        std::uint64_t seed) {
  Random random(seed);
  for (int c = 0; c < 60; ++c) {
    const Camera camera = test::adversarial_camera(random);
    const std::vector<Aabb> boxes = hard_boxes(random, camera, c % 3 != 0);
    Structure structure(limits);
    structure.build(boxes);
    const Ids ids = kept(structure, camera, boxes);
    const Ids expected = by_definition(camera, boxes);
    ASSERT_TRUE(std::ranges::includes(expected, ids)) << "camera " << c;
    Ids missing;
    std::ranges::set_difference(expected, ids, std::back_inserter(missing));
    const ExactFrustum exact(camera);
    for (const ObjectId object : missing) {
      EXPECT_EQ(exact.side(boxes[object]), Side::outside) << "camera " << c << ", box " << object;
    }
  }
}

TEST(OctreeCuller, LeavesOutOnlyWhatIsOutsideOfTheFrustumOfHardBoxes) {
  expect_no_less_than_what_is_inside<LeafOctree>({6, 2}, 31);
  expect_no_less_than_what_is_inside<LeafOctree>({3, 8}, 32);
  expect_no_less_than_what_is_inside<AxisBsp>(
      {AxisBsp::Straddlers::both, AxisBsp::Split::cost, 16, 2}, 33);
}

Scene random_field(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 offset(random.uniform(-30.0, 30.0), random.uniform(-30.0, 30.0),
                            random.uniform(-30.0, 30.0));
    const glm::dvec3 scale(random.uniform(0.1, 2.0), random.uniform(0.1, 2.0),
                           random.uniform(0.1, 2.0));
    scene.objects.push_back({0, placed(offset, scale), none_id});
  }
  scene.finish();
  return scene;
}

Camera some_camera(Random& random) {
  return camera_at({random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 0.5},
                   {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), 0.0});
}

/// Some move a little, some far, some out of the root; some hide, some come back.
class Traffic {
 public:
  Traffic(std::uint64_t seed, std::size_t count) : random_(seed), shown_(count, true) {}

  Changes next() {
    Changes changes;
    for (ObjectId object = 0; object < shown_.size(); ++object) {
      if (random_.below(10) == 0) {
        const double reach = random_.below(20) == 0 ? 500.0 : 30.0;
        changes.moved.push_back(object);
        changes.transforms.push_back(
            placed({random_.uniform(-reach, reach), random_.uniform(-30.0, 30.0),
                    random_.uniform(-30.0, 30.0)}));
      }
      if (random_.below(20) == 0) {
        (shown_[object] ? changes.hidden : changes.shown).push_back(object);
        shown_[object] = !shown_[object];
      }
    }
    return changes;
  }

 private:
  Random random_;
  std::vector<bool> shown_;
};

TEST(StructureCullers, AgreeWithTheFlatCullerWhileObjectsMoveComeAndGo) {
  const Scene scene = random_field(41, 800);
  CullerRun flat("frustum.flat[kernel=scalar]", scene);
  for (const char* spec :
       {"frustum.loose_octree", "frustum.loose_octree[overlap=0,leaf_size=0,depth=6]",
        "frustum.loose_octree[overlap=0.5,min_cell=3,leaf_size=2,masking=false]",
        "frustum.loose_octree[plane_coherence=true,octant=true,leaf_size=4]", "frustum.bsp",
        "frustum.bsp[straddlers=node,split=median,leaf_size=4]",
        "frustum.bsp[straddlers=node,split=cost]", "frustum.bsp[split=midpoint,leaf_size=1]"}) {
    SCOPED_TRACE(spec);
    CullerRun run(spec, scene);
    for (int pass = 0; pass < 2; ++pass) {
      Random random(42);
      Traffic traffic(43, scene.object_count());
      for (int frame = 0; frame < 40; ++frame) {
        const Camera camera = some_camera(random);
        const Changes changes = traffic.next();
        flat.update(camera, changes);
        run.update(camera, changes);
        const Ids expected = flat.objects(camera);
        ASSERT_EQ(sorted(run.objects(camera)), expected) << "frame " << frame;
        // The same as a list.
        const Ids shown(run.frame(camera).objects.shown.begin(),
                        run.frame(camera).objects.shown.end());
        const std::span<const ObjectId> runs[] = {std::span(shown).subspan(100, 200)};
        ASSERT_EQ(run.objects(camera, Candidates::of(runs)),
                  flat.objects(camera, Candidates::of(runs)));
      }
      flat.reset();
      run.reset();
    }
  }
}

TEST(StructureCullers, LoseNothingWhereObjectsAreRepeated) {
  const Scene scene = random_field(51, 800);
  CullerRun flat("frustum.flat[kernel=scalar]", scene);
  CullerRun exact("frustum.flat[test=exact]", scene);
  for (const char* spec :
       {"frustum.octree", "frustum.octree[depth=3,leaf_size=1]",
        "frustum.octree[depth=12,leaf_size=4]", "frustum.two_step",
        "frustum.two_step[nodes=inner,depth=6,leaf_size=8]",
        "frustum.two_step[depth=6,leaf_size=1]", "frustum.two_step[plane_coherence=true]",
        "frustum.bsp[straddlers=both]", "frustum.bsp[straddlers=both,split=median,leaf_size=4]"}) {
    SCOPED_TRACE(spec);
    CullerRun run(spec, scene);
    Random random(52);
    Traffic traffic(53, scene.object_count());
    for (int frame = 0; frame < 40; ++frame) {
      const Camera camera = some_camera(random);
      const Changes changes = traffic.next();
      for (CullerRun* each : {&flat, &exact, &run}) each->update(camera, changes);
      const Ids ids = sorted(run.objects(camera));
      ASSERT_TRUE(std::ranges::includes(flat.objects(camera), ids)) << "frame " << frame;
      ASSERT_TRUE(std::ranges::includes(ids, exact.objects(camera))) << "frame " << frame;
      ASSERT_TRUE(std::ranges::adjacent_find(ids) == ids.end());
    }
    for (CullerRun* each : {&flat, &exact, &run}) each->reset();
  }
}

TEST(StructureCullers, KeepTheirContractWithSmallLeaves) {
  Registry registry;
  register_all_cullers(registry);
  for (const char* spec :
       {"frustum.octree[leaf_size=2]", "frustum.two_step[leaf_size=2,nodes=inner]",
        "frustum.loose_octree[leaf_size=0]", "frustum.loose_octree[leaf_size=2,overlap=0.5]",
        "frustum.loose_octree[leaf_size=1,intersecting=keep]", "frustum.bsp[leaf_size=2]",
        "frustum.bsp[leaf_size=2,straddlers=node,split=median]",
        "frustum.bsp[leaf_size=2,straddlers=both,split=midpoint]"}) {
    for (const ContractResult& result : check_contract(registry, spec)) {
      EXPECT_TRUE(result.passed) << spec << ": " << result.check << ": " << result.message;
    }
  }
}

TEST(TwoStepCuller, FindsTheSameLeavesFromTheInnerNodes) {
  const Scene scene = random_field(61, 3000);
  CullerRun leaves("frustum.two_step[depth=5,leaf_size=8]", scene);
  CullerRun inner("frustum.two_step[depth=5,leaf_size=8,nodes=inner]", scene);
  Random random(62);
  for (int i = 0; i < 20; ++i) {
    const Camera camera = some_camera(random);
    EXPECT_EQ(leaves.objects(camera), inner.objects(camera));
  }
  EXPECT_EQ(leaves.counter("leaves_touched"), inner.counter("leaves_touched"));
  EXPECT_EQ(leaves.counter("objects_tested"), inner.counter("objects_tested"));
  EXPECT_LT(inner.counter("nodes_visited"), leaves.counter("nodes_visited"));
}

TEST(TwoStepCuller, LeavesOutABigBoxOffACornerThatNoPlaneExcludes) {
  // The camera looks diagonally; a plate reaches across its axis, but nearer than the near plane.
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, 0.0, 47.0}, {100.0, 0.5, 50.0}), none_id}};
  for (int i = 0; i < 2500; ++i) {  // so that the octree becomes fine
    scene.objects.push_back(
        {0, placed({4.0 * (i % 50) - 98.0, 0.0, 4.0 * (i / 50) - 98.0}, glm::dvec3(0.1)), none_id});
  }
  scene.finish();
  const Camera camera = {look_at({0.0, 0.0, 0.0}, {1.0, 0.0, -1.0}),
                         perspective_lens(degrees(20.0), 1.0, 10.0, 200.0)};
  const auto keeps_plate = [&](const char* spec) {
    CullerRun run(spec, scene);
    const Ids ids = run.objects(camera);
    return std::ranges::find(ids, ObjectId{0}) != ids.end();
  };
  EXPECT_TRUE(keeps_plate("frustum.flat"));
  EXPECT_FALSE(keeps_plate("frustum.flat[test=exact]"));
  EXPECT_FALSE(keeps_plate("frustum.two_step[depth=6,leaf_size=1]"));
  EXPECT_FALSE(keeps_plate("frustum.octree[depth=6,leaf_size=1]"));
  EXPECT_TRUE(keeps_plate("frustum.loose_octree"));
}

TEST(LooseOctreeCuller, DrawsAllOfTheRootUntestedIfIntersectingIsKept) {
  // A belt in the plane that halves the root: all of it stays in the root of a strict octree.
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (int i = 0; i < 100; ++i) {
    scene.objects.push_back({0, placed({3.0 * i - 150.0, 0.0, -20.0}), none_id});
  }
  scene.objects.push_back({0, placed({0.0, 100.0, -20.0}), none_id});
  scene.objects.push_back({0, placed({0.0, -100.0, -20.0}), none_id});
  scene.finish();
  const Camera camera = camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  CullerRun strict("frustum.loose_octree[overlap=0,intersecting=keep,leaf_size=0]", scene);
  CullerRun loose("frustum.loose_octree[overlap=5,intersecting=keep,leaf_size=0]", scene);
  CullerRun refined("frustum.loose_octree[overlap=0,leaf_size=0]", scene);
  CullerRun flat("frustum.flat", scene);
  EXPECT_GE(strict.objects(camera).size(), 100U);
  EXPECT_LT(loose.objects(camera).size(), 40U);
  EXPECT_EQ(sorted(refined.objects(camera)), sorted(flat.objects(camera)));
  EXPECT_GE(strict.counter("objects_in_root"), 100U);
  EXPECT_EQ(loose.counter("objects_in_root"), 0U);
}

TEST(OctreeCuller, TestsFewerObjectsAndMoreNodesTheDeeperItIs) {
  const Scene scene = random_field(71, 5000);
  const Camera camera = camera_at({0.0, 0.0, 20.0}, {5.0, 1.0, 0.0});
  std::uint64_t objects = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t nodes = 0;
  for (const char* depth : {"0", "2", "4", "6"}) {
    CullerRun run("frustum.octree[leaf_size=1,depth=" + std::string(depth) + "]", scene);
    run.objects(camera);
    EXPECT_LT(run.counter("objects_tested"), objects);
    EXPECT_GT(run.counter("nodes_visited"), nodes);
    objects = run.counter("objects_tested");
    nodes = run.counter("nodes_visited");
  }
}

TEST(StructureCullers, KeepWhatHasLeftTheRootOrHasABrokenBox) {
  const Scene scene = random_field(81, 50);
  for (const char* spec : {"frustum.octree", "frustum.two_step", "frustum.loose_octree",
                           "frustum.bsp", "frustum.bsp[straddlers=both]"}) {
    SCOPED_TRACE(spec);
    CullerRun run(spec, scene);
    const Camera away = camera_at({5000.0, 0.0, 0.0}, {5010.0, 0.0, 0.0});
    EXPECT_TRUE(run.objects(away).empty());
    run.update(away, {{7}, {placed({5010.0, 0.0, 0.0})}, {}, {}});
    EXPECT_EQ(run.objects(away), Ids{7});

    std::vector<Aabb> boxes(run.frame(away).objects.bounds.begin(),
                            run.frame(away).objects.bounds.end());
    boxes[3].min.x = std::numeric_limits<float>::quiet_NaN();
    boxes[4].max.y = std::numeric_limits<float>::infinity();
    Frame frame = run.frame(away);
    frame.objects.bounds = boxes;
    run.culler().update(frame, {{3, 4}, {glm::dmat4x3(1.0), glm::dmat4x3(1.0)}, {}, {}});
    IdSink sink;
    run.culler().cull(frame, Candidates::everything(), sink);
    EXPECT_EQ(sink.sorted(), (Ids{3, 4, 7}));
  }
}

}  // namespace
}  // namespace vislab
