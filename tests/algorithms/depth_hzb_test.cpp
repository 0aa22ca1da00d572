// depth.hzb and depth.hzb_two_pass: the image is that of the full scene, at any size and from
// awkward places; what moves is followed; what they find hidden.
#include <gtest/gtest.h>

#include <utility>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/depth_damage.h"

namespace vislab {
namespace {

const std::vector<std::string>& variants() {
  static const std::vector<std::string> all{
      "depth.hzb[sleep=false]",
      "depth.hzb_two_pass[sleep=false]",
      "depth.hzb[sleep=false,hierarchy=bvh,occluder_px=0,leaf_size=1]",
      "depth.hzb_two_pass[sleep=false,hierarchy=octree,occluder_px=0]",
      "depth.hzb[sleep=false,scale=half,order=random]",
      "depth.hzb_two_pass[sleep=false,scale=quarter,order=far_first]",
      "depth.hzb[sleep=false,silhouettes=false]"};
  return all;
}

Camera camera_of(const glm::dvec3& eye, const glm::dvec3& target, const Viewport& size) {
  return {look_at(eye, target), perspective_lens(degrees(60.0), size.aspect(), 0.1, 300.0)};
}

/// Boxes of many sizes, turned and sheared: some around the eye, some through the near plane, some
/// far.
Scene box_field(Random& random, int count) {
  Scene scene;
  scene.meshes = {cube_mesh(), sphere_mesh(4)};
  for (int i = 0; i < count; ++i) {
    const double angle = random.uniform(0.0, 3.0);
    const double reach = random.below(4) == 0 ? 4.0 : 40.0;
    const double size = random.uniform(0.1, random.below(5) == 0 ? 6.0 : 1.5);
    glm::dmat4x3 transform = placed(
        {random.uniform(-reach, reach), random.uniform(-3.0, 3.0), random.uniform(-reach, reach)},
        glm::dvec3(size, size * random.uniform(0.2, 2.0), size));
    const glm::dvec3 x = transform[0], z = transform[2];
    transform[0] = std::cos(angle) * x + std::sin(angle) * z;
    transform[2] = std::cos(angle) * z - std::sin(angle) * x;
    scene.objects.push_back({static_cast<MeshId>(random.below(2)), transform, none_id});
  }
  scene.finish();
  return scene;
}

/// A walk with steps of very different lengths, so that last frame's objects are good guesses and
/// bad ones.
Play walk_through_boxes(const Viewport& size, std::uint64_t seed) {
  Random random(seed);
  Play play;
  play.scene = box_field(random, 300);
  glm::dvec3 eye(0.0, 0.5, 6.0);
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 target = eye + glm::dvec3(random.uniform(-1.0, 1.0), random.uniform(-0.3, 0.1),
                                               random.uniform(-1.0, 1.0));
    play.steps.push_back({camera_of(eye, target, size), {}});
    eye += (i % 2 == 0 ? 0.3 : 12.0) *
           glm::dvec3(random.uniform(-1.0, 1.0), 0.0, random.uniform(-1.0, 1.0));
  }
  return play;
}

TEST(DepthHzb, ChangesNoPixelFromPlacesAmongAndInsideOfBoxes) {
  std::uint64_t seed = 1;
  for (const std::string& spec : variants()) {
    for (const Viewport& size : {Viewport{512, 512}, Viewport{1023, 769}, Viewport{160, 90}}) {
#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
      if (size.width > 160) continue;
#endif
      if (size.width > 160 && &spec - variants().data() > 1) continue;  // that takes long
      const Damage done = damage(spec, walk_through_boxes(size, ++seed), size, true);
      EXPECT_EQ(done.image_px, 0U) << spec << ' ' << size.width << 'x' << size.height;
      EXPECT_EQ(done.false_px, 0U) << spec << ' ' << size.width << 'x' << size.height;
      EXPECT_LT(done.kept, done.offered / 2) << spec;
    }
  }
}

TEST(DepthHzb, ChangesNoPixelInRoomsAndStreets) {
  const Viewport size{160, 90};
  for (const std::string& spec : variants()) {
    for (const bool rooms : {false, true}) {
      Play play;
      if (rooms) {
        play.scene = make_room_ring({6, 4, 1});
      } else {
        CityParameters city;
        city.blocks_x = 8;
        city.blocks_z = 8;
        city.street_boxes = 600;
        play.scene = make_city(city);
      }
      play.scene.finish();
      const glm::dvec3 middle = play.scene.bounds().center();
      const glm::dvec3 half = play.scene.bounds().half_size();
      for (int i = 0; i < 4; ++i) {
        // Along a circle through the rooms, or through streets and buildings.
        const double angle = 0.25 * i;
        const glm::dvec3 eye(middle.x + 0.7 * half.x * std::cos(angle), 1.7,
                             middle.z + 0.7 * half.z * std::sin(angle));
        const glm::dvec3 ahead(-std::sin(angle), 0.0, std::cos(angle));
        play.steps.push_back({camera_of(eye, eye + ahead, size), {}});
      }
      const Damage done = damage(spec, play, size, true);
      EXPECT_EQ(done.image_px, 0U) << spec << (rooms ? " in rooms" : " in streets");
      EXPECT_EQ(done.false_px, 0U) << spec << (rooms ? " in rooms" : " in streets");
    }
  }
}

TEST(DepthHzb, ChangesNoPixelWithoutPerspective) {
  const Viewport size{160, 90};
  for (const std::string& spec : variants()) {
    Play play = walk_through_boxes(size, 31);
    for (Play::Step& step : play.steps) {
      step.camera.lens = orthographic_lens(12.0, size.aspect(), 1.0, 60.0);
    }
    const Damage done = damage(spec, play, size, true);
    EXPECT_EQ(done.image_px, 0U) << spec;
    EXPECT_LT(done.kept, done.offered / 2) << spec;
  }
}

TEST(DepthHzb, FollowsWhatMovesGoesAndComesBack) {
  const Viewport size{160, 90};
  for (const std::string& spec : variants()) {
    Play play = walk_through_boxes(size, 47);
    Random random(48);
    std::vector<glm::dmat4x3> transforms;
    for (const Object& object : play.scene.objects) transforms.push_back(object.transform);
    std::vector<ObjectId> away;
    const Camera camera = play.steps.front().camera;
    play.steps.clear();
    for (int i = 0; i < 12; ++i) {
      Play::Step step{camera, {}};
      step.changes.shown = away;
      away.clear();
      for (ObjectId object = 0; object < transforms.size(); ++object) {
        if (std::ranges::binary_search(step.changes.shown, object)) continue;
        if (random.below(6) == 0) {
          away.push_back(object);
        } else if (random.below(4) == 0) {
          transforms[object][3] +=
              glm::dvec3(random.uniform(-3.0, 3.0), 0.0, random.uniform(-3.0, 3.0));
          step.changes.moved.push_back(object);
          step.changes.transforms.push_back(transforms[object]);
        }
      }
      step.changes.hidden = away;
      play.steps.push_back(std::move(step));
    }
    const Damage done = damage(spec, play, size, true);
    EXPECT_EQ(done.image_px, 0U) << spec;
    EXPECT_LT(done.kept, done.offered / 2) << spec;
  }
}

/// A wall before a grid of `count` cubes.
Scene wall_before(int count) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects.push_back({0, placed({0.0, 0.0, -10.0}, {20.0, 20.0, 0.5}), none_id});
  for (int i = 0; i < count; ++i) {
    scene.objects.push_back(
        {0, placed({i % 10 - 5.0, i / 10 % 10 - 5.0, -20.0 - i / 100}, glm::dvec3(0.3)), none_id});
  }
  scene.finish();
  return scene;
}

TEST(DepthHzb, AskLittleMoreIfTenTimesAsMuchIsHidden) {
  for (const char* spec : {"depth.hzb", "depth.hzb_two_pass"}) {
    std::array<std::uint64_t, 2> queries{};
    for (std::size_t i = 0; i < 2; ++i) {
      const Scene scene = wall_before(i == 0 ? 100 : 1'000);
      CullerRun run(spec, scene);
      for (int frame = 0; frame < 3; ++frame) {
        EXPECT_EQ(run.objects(camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0})).size(), 1U) << spec;
      }
      queries[i] = run.counter("queries");
    }
    EXPECT_LT(queries[1], 2 * queries[0]) << spec;
  }
}

TEST(DepthHzb, FindAsMuchInBatchesAsAtOnceIfOccludersComeFirst) {
  const Scene scene = wall_before(300);
  const std::vector<ObjectId> wall{0};
  std::vector<ObjectId> cubes;
  for (ObjectId object = 1; object <= 300; ++object) cubes.push_back(object);
  const Camera camera = camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  for (const char* spec : {"depth.hzb", "depth.hzb_two_pass"}) {
    CullerRun run(spec, scene);
    const Frame frame = run.frame(camera);
    RecordingSink sink;
    for (const auto* batch : {&std::as_const(wall), &std::as_const(cubes)}) {
      const std::span<const ObjectId> objects(*batch);
      sink.start(scene, frame);
      run.culler().cull(frame, Candidates::of(std::span(&objects, 1)), sink);
      EXPECT_EQ(sink.emitted().size(), batch == &wall ? 1U : 0U) << spec;
    }
    // The frame is over, and the wall was not offered: nothing is hidden by it.
    Frame next = frame;
    next.index = 1;
    const std::span<const ObjectId> objects(cubes);
    sink.start(scene, next);
    run.culler().cull(next, Candidates::of(std::span(&objects, 1)), sink);
    EXPECT_GE(sink.emitted().size(), 100U) << spec;
  }
}

TEST(DepthHzb, StopWhereNothingIsHidden) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (int i = 0; i < 400; ++i) {
    scene.objects.push_back(
        {0, placed({i % 20 - 10.0, i / 20 - 10.0, -30.0}, glm::dvec3(0.2)), none_id});
  }
  scene.finish();
  for (const char* spec : {"depth.hzb", "depth.hzb_two_pass"}) {
    CullerRun run(spec, scene);
    const Camera camera = camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
    for (int frame = 0; frame < 10; ++frame) run.emitted(camera);
    const std::uint64_t before = run.counter("queries");
    EXPECT_EQ(run.objects(camera).size(), 400U) << spec;
    EXPECT_EQ(run.counter("queries"), before) << spec;
  }
}

}  // namespace
}  // namespace vislab
