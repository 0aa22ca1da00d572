#include "common/render/modelled_gpu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/geometry/frustum.h"
#include "common/geometry/random.h"
#include "common/render/gl_functions.h"
#include "common/render/osmesa_device.h"
#include "common/render/query_bounds.h"
#include "common/scene/error.h"
#include "common/simd/simd_target.h"
#include "tests/render/small_scenes.h"

namespace vislab {
namespace {

using test::cube_mesh;
using test::frame_of;
using test::object_at;
using test::square_mesh;
using test::wall_and_cubes;

#ifdef __SANITIZE_ADDRESS__
constexpr int trials = 4;
#else
constexpr int trials = 40;
#endif

/// Cubes and squares, some turned, mirrored or flat, that hide and cut each other.
Scene random_scene(Random& random) {
  Scene scene;
  scene.meshes = {square_mesh(2), cube_mesh()};
  for (int i = 0; i < 40; ++i) {
    const double depth = random.uniform(1.5, 30.0);
    Object object =
        object_at(static_cast<MeshId>(random.below(2)),
                  {depth * random.uniform(-0.7, 0.7), depth * random.uniform(-0.7, 0.7), -depth},
                  depth * random.uniform(0.02, 0.3));
    if (random.below(2) == 0) {
      for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
          object.transform[column][row] += 0.1 * depth * random.uniform(-1.0, 1.0);
        }
      }
    }
    if (random.below(4) == 0) object.transform[0] = -object.transform[0];
    scene.objects.push_back(object);
  }
  scene.finish();
  return scene;
}

std::uint64_t samples_of(RenderDevice& device, const Aabb& box) {
  return device.samples(device.query({&box, 1}));
}

TEST(ModelledGpu, AnswersAsOsMesaDoes) {
  Random random(61);
  OsMesaDevice real;
  ModelledGpu modelled(gpu_preset("gpu").model);
  const Viewport size{160, 120};
  int asked = 0, equal = 0, owners = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Scene scene = random_scene(random);
    const SceneState state(scene);
    const Frame frame = frame_of(state, size);
    std::vector<ObjectId> one_sided;
    for (const ObjectId object : state.view().shown) {
      if (random.below(3) == 0) one_sided.push_back(object);
    }
    for (RenderDevice* device :
         {static_cast<RenderDevice*>(&real), static_cast<RenderDevice*>(&modelled)}) {
      device->load(scene);
      device->begin_frame(frame);
      device->cull_back_faces(one_sided);
      device->draw(state.view().shown);
    }
    ASSERT_TRUE(std::ranges::equal(real.one_sided(), modelled.one_sided()));
    const std::vector<std::uint32_t> ids = real.read_ids();
    const std::set<std::uint32_t> seen(ids.begin(), ids.end());
    for (const ObjectId object : state.view().shown) {
      const Aabb box = enlarged_for_query(frame.camera, size, state.view().bounds[object]);
      if (touches_near_region(frame.camera, box)) continue;
      const std::uint64_t expected = samples_of(real, box);
      const std::uint64_t here = samples_of(modelled, box);
      if (seen.contains(object)) {
        ++owners;
        EXPECT_GT(here, 0U) << "trial " << trial << ", object " << object;
      }
      if (expected == 0 && here == 0) continue;
      ++asked;
      equal += expected == here ? 1 : 0;
      // Samples on edges and where depths tie.
      EXPECT_NEAR(static_cast<double>(here), static_cast<double>(expected),
                  4.0 + 0.05 * static_cast<double>(expected))
          << "trial " << trial << ", object " << object;
    }
  }
  EXPECT_GT(owners, 10 * trials);
  EXPECT_GT(equal, 9 * asked / 10) << equal << " of " << asked;
}

TEST(ModelledGpu, DrawsRangesThatCoverEverythingLikeWholeObjects) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  ModelledGpu device(gpu_preset("gpu").model);
  device.load(scene);
  const auto run = [&](auto&& draw) {
    device.begin_frame(frame_of(state, {127, 65}));
    draw();
    std::vector<std::uint64_t> samples;
    for (const Aabb& box : state.view().bounds) samples.push_back(samples_of(device, box));
    return samples;
  };
  const std::vector<std::uint64_t> whole = run([&] { device.draw(state.view().shown); });
  const std::uint64_t triangles = device.log().front().triangles;
  EXPECT_EQ(whole[2], 0U);
  const std::vector<TriangleRange> ranges = {{3, 6, 6},  {3, 0, 6},  {0, 0, 16}, {0, 20, 12},
                                             {0, 16, 4}, {2, 0, 12}, {1, 3, 0},  {1, 0, 12}};
  EXPECT_EQ(run([&] { device.draw(ranges); }), whole);
  EXPECT_EQ(device.log().front().count, 4U) << "one draw an object";
  EXPECT_EQ(device.log().front().triangles, triangles);
  const std::vector<TriangleRange> nothing = {{1, 3, 0}};
  run([&] { device.draw(nothing); });
  EXPECT_EQ(device.log().front().kind, GpuCommandKind::query)
      << "without triangles there is no draw";
}

/// A frame with everything that a method does, by polling; what passed on the clock.
std::vector<GpuCommand> busy_frame(ModelledGpu& device, const SceneState& state,
                                   std::vector<std::uint64_t>& samples) {
  const Frame frame = frame_of(state, {96, 96});
  device.begin_frame(frame);
  std::vector<QueryId> queries;
  for (const ObjectId object : state.view().shown) {
    const Aabb box = enlarged_for_query(frame.camera, frame.viewport, state.view().bounds[object]);
    if (touches_near_region(frame.camera, box)) {
      device.draw(std::array<ObjectId, 1>{object});
      continue;
    }
    queries.push_back(device.query({&box, 1}));
    if (queries.size() % 7 == 0) device.flush();
    if (object % 5 == 0) device.draw(std::array<ObjectId, 1>{object});
  }
  device.flush();
  for (const QueryId query : queries) {
    while (query.index % 2 == 0 && !device.ready(query)) continue;
    samples.push_back(device.samples(query));
  }
  device.finish();
  return device.log();
}

TEST(ModelledGpu, RepeatsBitForBitAndWithEveryInstructionSet) {
  Random random(62);
  const Scene scene = random_scene(random);
  const SceneState state(scene);
  std::vector<std::uint64_t> expected_samples;
  ModelledGpu first(gpu_preset("gpu").model);
  first.load(scene);
  const std::vector<GpuCommand> expected = busy_frame(first, state, expected_samples);
  const double expected_ms = *first.clock_ms();
  EXPECT_GT(expected_ms, 0.0);
  const auto expect_the_same = [&](ModelledGpu& device) {
    std::vector<std::uint64_t> samples;
    const std::vector<GpuCommand> log = busy_frame(device, state, samples);
    EXPECT_EQ(samples, expected_samples);
    EXPECT_EQ(*device.clock_ms(), expected_ms);
    ASSERT_EQ(log.size(), expected.size());
    for (std::size_t i = 0; i < log.size(); ++i) {
      EXPECT_EQ(log[i].host, expected[i].host);
      EXPECT_EQ(log[i].device, expected[i].device);
    }
  };
  expect_the_same(first);
  for (const std::string& target : simd_targets()) {
    const SimdTargetScope scope(target);
    ModelledGpu other(gpu_preset("gpu").model);
    other.load(scene);
    expect_the_same(other);
  }
}

TEST(ModelledGpu, AsynchronyHidesTheDevicesTimeThatASerialDeviceShows) {
  Random random(63);
  const Scene scene = random_scene(random);
  const SceneState state(scene);
  GpuModel model = gpu_preset("gpu").model;
  model.triangle_ns = 1000.0;
  const auto frame_ms = [&](bool serial) {
    model.serial = serial;
    ModelledGpu device(model);
    device.load(scene);
    device.begin_frame(frame_of(state, {64, 64}));
    for (const ObjectId object : state.view().shown) {
      device.draw(std::array<ObjectId, 1>{object});
      device.flush();
    }
    device.finish();
    return *device.clock_ms();
  };
  EXPECT_LT(frame_ms(false), 0.8 * frame_ms(true));
}

TEST(ModelledGpu, KeepsTheBoxesOfEachQuery) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  ModelledGpu device(gpu_preset("modern").model);
  device.load(scene);
  device.begin_frame(frame_of(state, {32, 32}));
  const std::span<const Aabb> all = state.view().bounds;
  device.query(all.first(3));
  device.query({});
  device.query(all.subspan(3, 1));
  EXPECT_TRUE(std::ranges::equal(device.boxes(0), all.first(3)));
  EXPECT_TRUE(device.boxes(1).empty());
  EXPECT_EQ(device.boxes(2).front(), all[3]);
  EXPECT_THROW(device.boxes(3), std::logic_error);
}

TEST(ModelledGpu, ModelsThatDifferHaveDifferentDescriptions) {
  const GpuModel model = gpu_preset("gpu").model;
  const std::string description = ModelledGpu(model).description();
  for (const GpuDial& dial : gpu_dials()) {
    const double value = dial.value(model);
    const bool is_real = std::holds_alternative<double GpuModel::*>(dial.member);
    GpuModel other = model;
    dial.set(other, is_real ? std::nextafter(value, 1e9) : value == 1.0 ? 0.0 : value + 1.0);
    EXPECT_NE(ModelledGpu(other).description(), description) << dial.name;
  }
}

TEST(ModelledGpu, RefusesCallsInAWrongOrderAndQueriesOfEarlierFrames) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  ModelledGpu device(gpu_preset("gpu").model);
  EXPECT_THROW(device.begin_frame(frame_of(state, {8, 8})), std::logic_error);
  device.load(scene);
  EXPECT_THROW(device.draw(state.view().shown), std::logic_error);
  EXPECT_THROW(device.begin_frame(frame_of(state, {0, 8})), InputError);
  EXPECT_THROW(device.finish(), std::logic_error);
  device.begin_frame(frame_of(state, {8, 8}));
  const QueryId earlier = device.query({});
  EXPECT_EQ(device.samples(earlier), 0U);
  device.begin_frame(frame_of(state, {8, 8}));
  const QueryId now = device.query({});
  EXPECT_EQ(earlier.index, now.index);
  EXPECT_THROW(device.samples(earlier), std::logic_error);
  EXPECT_THROW(device.ready(earlier), std::logic_error);
}

/// Answers of so many queries before the first of which nothing is flushed by the caller, compared
/// with those of the same boxes one by one.
void expect_outstanding_queries_to_count(int side, std::size_t outstanding) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  const Frame frame = frame_of(state, {side, side});
  Random random(64);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 100; ++i) {
    const glm::vec3 low(static_cast<float>(random.uniform(-9.0, 8.0)),
                        static_cast<float>(random.uniform(-9.0, 8.0)),
                        static_cast<float>(random.uniform(-9.0, -2.0)));
    boxes.push_back({low, low + static_cast<float>(random.uniform(0.1, 0.7))});
  }
  device.begin_frame(frame);
  device.draw(state.view().shown);
  std::vector<std::uint64_t> expected;
  for (const Aabb& box : boxes) expected.push_back(samples_of(device, box));
  EXPECT_GT(std::ranges::count(expected, 0U), 20);
  EXPECT_GT(std::ranges::max(expected), 0U);
  device.begin_frame(frame);
  device.draw(state.view().shown);
  std::vector<QueryId> queries;
  for (std::size_t i = 0; i < outstanding; ++i) {
    queries.push_back(device.query({&boxes[i % boxes.size()], 1}));
  }
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < outstanding; ++i) {
    wrong += device.samples(queries[i]) != expected[i % boxes.size()] ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0U);
}

TEST(OsMesaQueries, ManyOutstandingOnesAnswerAsOneByOne) {
#ifdef __SANITIZE_ADDRESS__
  expect_outstanding_queries_to_count(48, 2'000);
#else
  expect_outstanding_queries_to_count(48, 20'000);
#endif
}

TEST(OsMesaQueries, OnesThatFillTheRenderersMemoryAnswerAsOneByOne) {
#ifdef __SANITIZE_ADDRESS__
  expect_outstanding_queries_to_count(1024, 2'000);
#else
  expect_outstanding_queries_to_count(1024, 8'000);
#endif
}

TEST(GlFunctions, RefuseAContextWhoseQueriesCountNothing) {
  GlFunctions gl;
  gl.GetQueryiv = [](GLenum, GLenum, GLint* bits) { *bits = 0; };
  try {
    require_queries(gl);
    FAIL() << "counters without bits were taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no occlusion queries"), std::string::npos);
  }
  gl.GetQueryiv = [](GLenum, GLenum, GLint* bits) { *bits = 32; };
  EXPECT_NO_THROW(require_queries(gl));
}

TEST(GlContext, TellsAnErrorWithTheCallsAfterWhichItWasFound) {
  GlContext context;
  const GlFunctions& gl = context.make_current();
  EXPECT_NO_THROW(context.check("nothing"));
  gl.Enable(0xFFFF);
  try {
    context.check("a batch of queries");
    FAIL() << "an error of OpenGL was passed over";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("a batch of queries"), std::string::npos);
  }
  EXPECT_NO_THROW(context.check("an error that was told"));
}

TEST(GlFunctions, NameALostContext) {
  EXPECT_NE(gl_error_name(GL_CONTEXT_LOST).find("the graphics context is gone"), std::string::npos);
}

}  // namespace
}  // namespace vislab
