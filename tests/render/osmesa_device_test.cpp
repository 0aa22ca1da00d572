#include "common/render/osmesa_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <thread>

#include "common/scene/error.h"
#include "tests/render/small_scenes.h"

namespace vislab {
namespace {

using test::cube_mesh;
using test::frame_of;
using test::object_at;
using test::square_mesh;
using test::wall_and_cubes;

std::size_t count_of(const std::vector<std::uint32_t>& ids, std::uint32_t id) {
  return static_cast<std::size_t>(std::count(ids.begin(), ids.end(), id));
}

TEST(OsMesaDevice, WritesTheIdOfTheNearestObjectAndNoneElsewhere) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {101, 101}));
  device.draw(state.view().shown);
  const std::vector<std::uint32_t> ids = device.read_ids();
  EXPECT_EQ(ids[50 * 101 + 50], 0U);
  EXPECT_GT(count_of(ids, 1), 0U);
  EXPECT_EQ(count_of(ids, 2), 0U);
  EXPECT_GT(count_of(ids, 3), 0U);
  EXPECT_EQ(ids[0], none_id);
  // Rows run from the lower left: the near cube is right of and above the middle.
  EXPECT_EQ(ids[std::size_t{56} * 101 + 59], 1U);
}

TEST(OsMesaDevice, WritesCanonicalTriangleIds) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw(state.view().shown);
  const std::vector<std::uint32_t> objects = device.read_ids();
  const std::vector<float> depth = device.read_depth();

  const std::vector<TriangleRange> ranges = {{0, 0, 7},  {0, 7, 25}, {1, 0, 12},
                                             {2, 0, 12}, {3, 0, 5},  {3, 5, 7}};
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw_ids(ranges);
  const std::vector<std::uint32_t> triangles = device.read_ids();
  EXPECT_EQ(device.read_depth(), depth);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    ASSERT_EQ(triangles[i] == none_id, objects[i] == none_id);
    if (objects[i] != none_id) {
      ASSERT_EQ(scene.object_of(triangles[i]), objects[i]);
    }
  }
  // The wall's lower left cell is its first two triangles, its upper right cell the last two.
  const std::set<std::uint32_t> seen(triangles.begin(), triangles.end());
  EXPECT_TRUE(seen.contains(0) && seen.contains(1) && seen.contains(30) && seen.contains(31));
}

TEST(OsMesaDevice, DrawsRangesThatCoverEverythingLikeWholeObjects) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {127, 65}));
  device.draw(state.view().shown);
  const std::vector<std::uint32_t> ids = device.read_ids();
  const std::vector<float> depth = device.read_depth();

  // In order, out of order (copied together), in many pieces and with an empty piece.
  const std::vector<std::vector<TriangleRange>> covers = {
      {{0, 0, 32}, {1, 0, 12}, {2, 0, 12}, {3, 0, 12}},
      {{3, 6, 6}, {3, 0, 6}, {0, 0, 16}, {0, 20, 12}, {0, 16, 4}, {2, 0, 12}, {1, 0, 12}},
      {{0, 0, 1}, {0, 1, 31}, {1, 3, 0}, {1, 0, 12}, {2, 1, 11}, {2, 0, 1}, {3, 0, 12}}};
  for (const std::vector<TriangleRange>& cover : covers) {
    device.begin_frame(frame_of(state, {127, 65}));
    device.draw(cover);
    EXPECT_EQ(device.read_depth(), depth);
    EXPECT_EQ(device.read_ids(), ids);
  }
}

TEST(OsMesaDevice, DrawsOnlyTheTrianglesOfTheRanges) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {64, 64}));
  // The wall's rows of cells are 8 triangles each: the lowest and the third of four.
  const std::vector<TriangleRange> rows = {{0, 0, 8}, {0, 16, 8}};
  device.draw(rows);
  const std::vector<std::uint32_t> ids = device.read_ids();
  const auto at = [&](std::size_t row) { return ids[row * 64 + 32]; };
  EXPECT_EQ(at(21), 0U);
  EXPECT_EQ(at(28), none_id);
  EXPECT_EQ(at(35), 0U);
  EXPECT_EQ(at(42), none_id);
}

TEST(OsMesaDevice, KeepsTheFirstOfTwoThatTie) {
  Scene scene;
  scene.meshes = {square_mesh()};
  scene.objects = {object_at(0, {0.0, 0.0, -2.0}), object_at(0, {0.0, 0.0, -2.0})};
  scene.finish();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  for (const ObjectId first : {0U, 1U}) {
    device.begin_frame(frame_of(state, {32, 32}));
    const std::array<ObjectId, 2> order = {first, 1 - first};
    device.draw(order);
    const std::vector<std::uint32_t> ids = device.read_ids();
    EXPECT_GT(count_of(ids, first), 0U);
    EXPECT_EQ(count_of(ids, 1 - first), 0U);
  }
}

TEST(OsMesaDevice, DrawsBothSides) {
  Scene scene;
  scene.meshes = {square_mesh()};
  Object turned = object_at(0, {0.0, 0.0, -2.0});
  turned.transform[0] = {-1.0, 0.0, 0.0};
  turned.transform[2] = {0.0, 0.0, -1.0};
  scene.objects = {turned};
  scene.finish();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {32, 32}));
  device.draw(state.view().shown);
  EXPECT_EQ(device.read_ids()[16 * 32 + 16], 0U);
}

TEST(OsMesaDevice, TakesAnyResolutionAndRefusesThoseItCannotDraw) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  for (const Viewport viewport : {Viewport{513, 511}, Viewport{1, 1}, Viewport{3, 200}}) {
    device.begin_frame(frame_of(state, viewport));
    device.draw(state.view().shown);
    const std::vector<std::uint32_t> ids = device.read_ids();
    ASSERT_EQ(ids.size(), static_cast<std::size_t>(viewport.width) * viewport.height);
    const auto middle =
        static_cast<std::size_t>(viewport.height / 2 * viewport.width + viewport.width / 2);
    EXPECT_EQ(ids[middle], 0U) << viewport.width;
  }
  EXPECT_THROW(device.begin_frame(frame_of(state, {0, 5})), InputError);
  EXPECT_THROW(device.begin_frame(frame_of(state, {1 << 20, 5})), InputError);
  device.begin_frame(frame_of(state, {9, 9}));
  EXPECT_EQ(device.read_ids().size(), 81U);
}

TEST(OsMesaDevice, FollowsObjectsThatMove) {
  const Scene scene = wall_and_cubes();
  SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw(state.view().shown);
  ASSERT_EQ(count_of(device.read_ids(), 2), 0U);

  Changes changes;
  changes.moved = {2};
  changes.transforms = {object_at(1, {0.0, 0.0, -2.0}, 0.5).transform};
  state.apply(changes);
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw(state.view().shown);
  EXPECT_EQ(device.read_ids()[32 * 64 + 32], 2U);

  state.reset();
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw(state.view().shown);
  EXPECT_EQ(count_of(device.read_ids(), 2), 0U);
}

TEST(OsMesaDevice, CountsTheSamplesOfABoxAsTheDepthBufferSays) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  const Frame frame = frame_of(state, {128, 128});
  device.begin_frame(frame);
  // Cubes fill their boxes: what a box would add is what drawing its faces without writing would.
  const std::array<ObjectId, 2> drawn = {0, 3};
  device.draw(drawn);
  const std::vector<float> before = device.read_depth();
  const std::vector<Aabb> near_box = {state.view().bounds[1]};
  const std::vector<Aabb> hidden_box = {state.view().bounds[2]};
  const std::vector<Aabb> two_boxes = {state.view().bounds[1], state.view().bounds[2]};
  const QueryId near_query = device.query(near_box);
  const QueryId hidden_query = device.query(hidden_box);
  const QueryId both_query = device.query(two_boxes);
  const QueryId empty_query = device.query({});
  device.flush();
  EXPECT_EQ(device.read_depth(), before) << "a query must not write";
  EXPECT_EQ(device.samples(hidden_query), 0U);
  EXPECT_EQ(device.samples(empty_query), 0U);
  EXPECT_TRUE(device.ready(hidden_query));
  EXPECT_EQ(device.samples(both_query), device.samples(near_query));

  // Each face that is seen from the front alone, compared with the depth buffer by hand.
  std::uint64_t expected = 0;
  const std::array<ObjectId, 1> asked = {1};
  for (std::uint32_t face = 0; face < 6; ++face) {
    device.begin_frame(frame);
    device.cull_back_faces(asked);
    const std::array<TriangleRange, 1> range = {TriangleRange{1, 2 * face, 2}};
    device.draw(range);
    const std::vector<float> depth = device.read_depth();
    const std::vector<std::uint32_t> ids = device.read_ids();
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (ids[i] == 1 && depth[i] <= before[i]) ++expected;
    }
  }
  device.begin_frame(frame);
  device.draw(drawn);
  EXPECT_EQ(device.samples(device.query(near_box)), expected);
}

TEST(OsMesaDevice, CountsABoxThatTouchesWhatIsDrawn) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {object_at(0, {0.0, 0.0, -3.0})};
  scene.finish();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw(state.view().shown);
  // Seen head-on, the cube's own box has its front face exactly where the cube's is.
  const std::array<Aabb, 1> box = {Aabb{{-0.5F, -0.5F, -3.5F}, {0.5F, 0.5F, -2.5F}}};
  const QueryId query = device.query(box);
  EXPECT_EQ(device.samples(query), count_of(device.read_ids(), 0));
}

TEST(OsMesaDevice, DrawsOnAfterAQuery) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw(state.view().shown);
  const std::vector<std::uint32_t> ids = device.read_ids();
  device.begin_frame(frame_of(state, {64, 64}));
  for (const ObjectId object : state.view().shown) {
    const std::array<ObjectId, 1> one = {object};
    const std::array<Aabb, 1> box = {state.view().bounds[object]};
    device.samples(device.query(box));
    device.draw(one);
  }
  EXPECT_EQ(device.read_ids(), ids);
}

TEST(OsMesaDevice, TellsAQueryOfAnEarlierFrameFromThoseOfThisOne) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  const std::array<Aabb, 1> box = {state.view().bounds[1]};
  device.begin_frame(frame_of(state, {64, 64}));
  const QueryId earlier = device.query(box);
  device.begin_frame(frame_of(state, {64, 64}));
  const QueryId now = device.query(box);
  EXPECT_EQ(earlier.index, now.index) << "the place is used again, or nothing is tested here";
  EXPECT_THROW(device.samples(earlier), std::logic_error);
  EXPECT_THROW(device.ready(earlier), std::logic_error);
  EXPECT_GT(device.samples(now), 0U);
}

TEST(OsMesaDevice, CountsEachPixelOfABoxOnce) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {64, 64}));
  // Nothing is drawn, so back faces would pass as well.
  const std::array<Aabb, 1> box = {state.view().bounds[1]};
  const std::uint64_t samples = device.samples(device.query(box));
  device.begin_frame(frame_of(state, {64, 64}));
  device.draw(std::array<ObjectId, 1>{1});
  EXPECT_EQ(samples, count_of(device.read_ids(), 1));
}

TEST(OsMesaDevice, RefusesCallsInAWrongOrder) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  EXPECT_THROW(device.begin_frame(frame_of(state, {8, 8})), std::logic_error);
  device.load(scene);
  EXPECT_THROW(device.draw(state.view().shown), std::logic_error);
  device.begin_frame(frame_of(state, {8, 8}));
  EXPECT_THROW(device.samples({}), std::logic_error);
}

TEST(OsMesaDevice, TwoDevicesInOneThreadDoNotDisturbEachOther) {
  const Scene scene = wall_and_cubes();
  Scene other;
  other.meshes = {square_mesh()};
  other.objects = {object_at(0, {0.0, 0.0, -1.0})};
  other.finish();
  const SceneState state(scene);
  const SceneState other_state(other);
  OsMesaDevice first;
  first.load(scene);
  first.begin_frame(frame_of(state, {64, 64}));
  first.draw(state.view().shown);
  const std::vector<std::uint32_t> alone = first.read_ids();

  first.begin_frame(frame_of(state, {64, 64}));
  {
    OsMesaDevice second;
    second.load(other);
    second.begin_frame(frame_of(other_state, {16, 16}));
    first.draw(state.view().shown.first(2));
    second.draw(other_state.view().shown);
    first.draw(state.view().shown.subspan(2));
    EXPECT_EQ(second.read_ids()[8 * 16 + 8], 0U);
  }
  EXPECT_EQ(first.read_ids(), alone);
}

TEST(OsMesaDevice, DevicesInDifferentThreadsGiveTheSameImage) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  std::array<std::vector<std::uint32_t>, 2> ids;
  const auto work = [&](std::size_t i) {
    OsMesaDevice device;
    device.load(scene);
    for (int repeat = 0; repeat < 20; ++repeat) {
      device.begin_frame(frame_of(state, {64, 64}));
      device.draw(state.view().shown);
    }
    ids[i] = device.read_ids();
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  EXPECT_GT(count_of(ids[0], 0), 0U);
  EXPECT_EQ(ids[0], ids[1]);
}

/// Reads the planar depth at the middle of a square that faces the camera at `distance`.
double depth_of_square(OsMesaDevice& device, const Camera& camera, double distance) {
  Scene scene;
  scene.meshes = {square_mesh()};
  scene.objects = {object_at(0, camera.pose.eye - camera.pose.back * distance, distance)};
  scene.finish();
  const SceneState state(scene);
  Frame frame = frame_of(state, {33, 33});
  frame.camera = camera;
  device.load(scene);
  device.begin_frame(frame);
  device.draw(state.view().shown);
  const double depth = device.read_depth()[16 * 33 + 16];
  const Lens& lens = camera.lens;
  if (lens.projection == Projection::orthographic) {
    return lens.near_m + depth * (lens.far_m - lens.near_m);
  }
  const double share = std::isinf(lens.far_m) ? 1.0 : (lens.far_m - lens.near_m) / lens.far_m;
  return lens.near_m / (1.0 - depth * share);
}

TEST(OsMesaDevice, DepthAgreesWithDistanceForEveryKindOfCamera) {
  OsMesaDevice device;
  for (const glm::dvec3 eye : {glm::dvec3(0.0), glm::dvec3(3000.123, 20.0, -700.7)}) {
    Camera camera;
    camera.pose.eye = eye;
    for (const double far_m : {100.0, std::numeric_limits<double>::infinity()}) {
      camera.lens = perspective_lens(1.0, 1.0, 0.1, far_m);
      for (const double distance : {0.11, 1.0, 7.3, 49.0}) {
        EXPECT_NEAR(depth_of_square(device, camera, distance) / distance, 1.0, 1e-4) << far_m;
      }
    }
    camera.lens = orthographic_lens(4.0, 1.0, -5.0, 80.0);
    for (const double distance : {1.0, 7.3, 79.0}) {
      EXPECT_NEAR(depth_of_square(device, camera, distance) / distance, 1.0, 1e-4);
    }
  }
}

TEST(OsMesaDevice, AnOffCentreLensShiftsTheImage) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  Frame frame = frame_of(state, {64, 64});
  device.begin_frame(frame);
  device.draw(state.view().shown);
  const std::vector<std::uint32_t> whole = device.read_ids();
  // The right half of the image, at the same pixel size.
  frame.camera.lens.left = 0.0;
  frame.viewport.width = 32;
  device.begin_frame(frame);
  device.draw(state.view().shown);
  const std::vector<std::uint32_t> half = device.read_ids();
  for (std::size_t y = 0; y < 64; ++y) {
    for (std::size_t x = 0; x < 32; ++x) {
      ASSERT_EQ(half[y * 32 + x], whole[y * 64 + 32 + x]) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace vislab
