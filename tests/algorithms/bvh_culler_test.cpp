// frustum.bvh on moving scenes: in every shape it keeps what frustum.flat keeps.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/random.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

constexpr std::size_t object_count = 600;

glm::dvec3 point(Random& random, double reach) {
  const double x = random.uniform(-reach, reach);
  const double y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

Scene random_field() {
  Random random(1);
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (std::size_t i = 0; i < object_count; ++i) {
    scene.objects.push_back({0, placed(point(random, 30.0), glm::dvec3(0.5)), none_id});
  }
  scene.finish();
  return scene;
}

/// Some move a little, some far out; some hide, some come back.
class Traffic {
 public:
  Changes next() {
    Changes changes;
    for (ObjectId object = 0; object < object_count; ++object) {
      if (random_.below(4) == 0) {
        const double reach = random_.below(50) == 0 ? 1e7 : 30.0;
        changes.moved.push_back(object);
        changes.transforms.push_back(placed(point(random_, reach), glm::dvec3(0.5)));
      }
      if (random_.below(20) == 0) {
        (shown_[object] ? changes.hidden : changes.shown).push_back(object);
        shown_[object] = !shown_[object];
      }
    }
    return changes;
  }

 private:
  Random random_{2};
  std::vector<bool> shown_ = std::vector<bool>(object_count, true);
};

std::vector<ObjectId> sorted(std::vector<ObjectId> ids) {
  std::ranges::sort(ids);
  return ids;
}

const std::vector<std::string> shapes{
    "frustum.bvh",
    "frustum.bvh[masking=false]",
    "frustum.bvh[motion=rebuild]",
    "frustum.bvh[build=top_down]",
    "frustum.bvh[build=top_down,motion=rebuild]",
    "frustum.bvh[build=bottom_up,leaf_size=3]",
    "frustum.bvh[build=incremental,leaf_size=1]",
    "frustum.bvh[layout=binary]",
    "frustum.bvh[layout=binary,masking=false,leaf_size=1]",
    "frustum.bvh[layout=binary,motion=rebuild,leaf_size=64]",
    "frustum.bvh[motion=enlarge]",
    "frustum.bvh[motion=reinsert]",
    "frustum.bvh[build=incremental,motion=reinsert,plane_coherence=true]",
    "frustum.bvh[octant=true,meta=off]",
};

TEST(BvhCuller, KeepsWhatFlatKeepsWhileObjectsMoveHideAndComeBack) {
  const Scene scene = random_field();
  for (const std::string& shape : shapes) {
    SCOPED_TRACE(shape);
    CullerRun ours(shape, scene);
    CullerRun flat("frustum.flat[kernel=scalar]", scene);
    for (int pass = 0; pass < 2; ++pass) {
      Traffic traffic;
      Random random(3);
      for (int step = 0; step < 40; ++step) {
        const glm::dvec3 eye = point(random, 20.0);
        const Camera camera = camera_at(eye, eye + point(random, 1.0));
        const Changes changes = step % 3 == 0 ? Changes{} : traffic.next();
        ours.update(camera, changes);
        flat.update(camera, changes);
        ASSERT_EQ(sorted(ours.objects(camera)), sorted(flat.objects(camera))) << step;
        // A list, as a stage behind another is offered.
        std::vector<ObjectId> list(ours.frame(camera).objects.shown.begin(),
                                   ours.frame(camera).objects.shown.end());
        std::erase_if(list, [](ObjectId object) { return object % 3 == 0; });
        const std::vector<std::span<const ObjectId>> runs{list};
        ASSERT_EQ(ours.objects(camera, Candidates::of(runs)),
                  flat.objects(camera, Candidates::of(runs)))
            << step;
      }
      ours.reset();
      flat.reset();
    }
  }
}

TEST(BvhCuller, RebuildsWhenObjectsHaveMixed) {
  const Scene scene = random_field();
  CullerRun ours("frustum.bvh", scene);
  const Camera camera = camera_at({0.0, 0.0, 25.0}, {1.0, 0.0, 0.0});
  const auto blocks = [&] {
    const std::uint64_t before = ours.counter("blocks_tested");
    ours.objects(camera);
    return ours.counter("blocks_tested") - before;
  };
  const std::uint64_t at_first = blocks();
  Random random(4);
  Changes changes;
  for (ObjectId object = 0; object < object_count; ++object) {
    changes.moved.push_back(object);
    changes.transforms.push_back(placed(point(random, 30.0), glm::dvec3(0.5)));
  }
  ours.update(camera, changes);
  const std::uint64_t mixed = blocks();
  EXPECT_GT(mixed, 3 * at_first / 2);
  // Queries lose more and more; the next time that something moves, all is put in order.
  for (int i = 0; i < 200; ++i) ours.objects(camera);
  changes.moved.resize(1);
  changes.transforms.resize(1);
  ours.update(camera, changes);
  EXPECT_LT(blocks(), mixed);
  EXPECT_LT(blocks(), 3 * at_first / 2);
}

TEST(BvhCuller, MaskingSavesPlaneTestsInBothLayouts) {
  const Scene scene = random_field();
  const Camera camera = camera_at({0.0, 0.0, 25.0}, {1.0, 0.0, 0.0});
  for (const std::string layout : {"wide", "binary"}) {
    CullerRun with("frustum.bvh[layout=" + layout + "]", scene);
    CullerRun without("frustum.bvh[masking=false,layout=" + layout + "]", scene);
    EXPECT_EQ(sorted(with.objects(camera)), sorted(without.objects(camera)));
    EXPECT_LT(with.counter("plane_tests"), without.counter("plane_tests")) << layout;
  }
}

}  // namespace
}  // namespace vislab
