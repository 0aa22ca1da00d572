// backface.normal_mask: what it finds, and that it is never wrong.
#include <gtest/gtest.h>

#include <iostream>
#include <set>

#include "algorithms/backface/direction_cube.h"
#include "algorithms/backface/normal_mask.h"
#include "algorithms/backface/sector_kernel.h"
#include "experiments/bench/backface/normals_field.h"
#include "tests/algorithms/facing_worlds.h"
#include "tests/geometry/exact_facing.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

using namespace backface_culling;
using test::FacingCounts;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int trials = 1;
#else
constexpr int trials = 10;
#endif

/// What a culler leaves out, judged exactly.
FacingCounts judged(const std::string& spec, const Scene& scene, const Camera& camera) {
  CullerRun run(spec, scene);
  const Frame frame = run.frame(camera);
  const std::vector<TriangleRange> kept = run.emitted(camera);
  return test::count_facings(scene, frame, test::exact_facings(scene, frame), kept);
}

Scene one_object(Mesh mesh, const glm::dmat4x3& transform = glm::dmat4x3(1.0)) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.objects = {{0, transform, none_id}};
  scene.finish();
  return scene;
}

TEST(NormalMask, RefusesMoreClassesThanTwoBytesTell) {
  Registry registry;
  register_all_cullers(registry);
  EXPECT_NO_THROW(registry.make("backface.normal_mask[n=18]"));
  for (const char* n : {"19", "0", "256"}) {
    const std::string message =
        input_error([&] { registry.make("backface.normal_mask[n=" + std::string(n) + "]"); });
    EXPECT_TRUE(says(message, "1 to 18")) << n;
    EXPECT_TRUE(says(message, "backface.normal_mask")) << n;
  }
  EXPECT_TRUE(says(input_error([] { DirectionCube(19); }), "1 to 18"));
}

TEST(NormalMask, TakesTwoBytesATriangleAndALittleForBlocks) {
  const Scene scene = one_object(sphere_mesh(60));
  CullerRun run("backface.normal_mask", scene);
  const auto triangles = static_cast<double>(scene.triangle_count());
  const auto bytes = static_cast<double>(run.culler().bytes());
  EXPECT_GE(bytes, 2.0 * triangles);
  EXPECT_LE(bytes, (2.0 + 24.0 / 128.0) * triangles + 1000.0);
}

TEST(NormalMask, FindsTheSharesThatWerePredicted) {
  struct Prediction {
    double fov_deg;
    std::array<double, 3> recall;  // 1 sector, 4 x 4, 8 x 8
  };
  const std::array<Prediction, 5> predictions{{{30.0, {0.62, 0.85, 0.89}},
                                               {45.0, {0.49, 0.82, 0.88}},
                                               {60.0, {0.36, 0.78, 0.86}},
                                               {90.0, {0.20, 0.72, 0.82}},
                                               {120.0, {0.06, 0.65, 0.80}}}};
  const std::array<int, 3> sectors{1, 4, 8};
  for (const Prediction& prediction : predictions) {
    const NormalsField field = normals_field(prediction.fov_deg, 16, 150, 5);
    ASSERT_TRUE(field.scene.meshes[0].solid);
    const SceneState state(field.scene);
    const Frame frame{0, field.camera, {64, 64}, state.view(), 0.0};
    const std::vector<test::Facing> facings = test::exact_facings(field.scene, frame);
    for (std::size_t i = 0; i < sectors.size(); ++i) {
      CullerRun run("backface.normal_mask[n=16,sectors=" + std::to_string(sectors[i]) + "]",
                    field.scene);
      const FacingCounts counts =
          test::count_facings(field.scene, frame, facings, run.emitted(field.camera));
      EXPECT_TRUE(counts.all_right());
      EXPECT_NEAR(counts.recall(), prediction.recall[i], 0.03)
          << prediction.fov_deg << " degrees, " << sectors[i] << " sectors a side";
    }
  }
}

/// A lens of any kind: wide, off-centre, orthographic.
Lens any_lens(Random& random, double reach) {
  const double near_m = 0.01;
  if (random.below(4) == 0) {
    return orthographic_lens(random.uniform(0.1, 10.0) * reach, 1.0, 0.0, 100.0 * reach);
  }
  Lens lens = perspective_lens(degrees(random.uniform(5.0, 170.0)), random.uniform(0.5, 2.0),
                               near_m, 100.0 * reach);
  if (random.below(3) == 0) {
    const double x = random.uniform(-2.0, 2.0) * near_m;
    lens.left += x;
    lens.right += x;
    lens.bottom += 0.5 * x;
    lens.top += 0.5 * x;
  }
  return lens;
}

TEST(NormalMask, IsNeverWrongWithAnyLensNumberOfSectorsAndTransform) {
  Random random(8);
  FacingCounts sum;
  BumpySphereParameters parameters;
  parameters.subdivisions = 12;
  parameters.bumps = Bumps::low;
  const Mesh bumpy = bumpy_sphere_mesh(parameters);
  for (int trial = 0; trial < 12 * trials; ++trial) {
    Scene scene;
    scene.meshes = {bumpy, cube_mesh()};
    const glm::dvec3 middle = test::vector_in(random, trial % 3 == 0 ? 1e6 : 10.0);
    for (std::uint32_t i = 0; i < 4; ++i) {
      const glm::dmat3 linear = i == 0 ? glm::dmat3(1.0) : test::linear_map(random, trial % 2 == 0);
      const glm::dvec3 place = middle + test::vector_in(random, 6.0);
      scene.objects.push_back({i / 3, {linear[0], linear[1], linear[2], place}, none_id});
    }
    scene.finish();
    const std::string spec =
        "backface.normal_mask[n=" + std::to_string(2 + random.below(17)) +
        ",sectors=" + std::to_string(1 + random.below(SectorLines::most_sectors)) + "]";
    for (int view = 0; view < 6; ++view) {
      Camera camera = test::facing_camera(random, scene);
      if (view % 2 == 0) camera.lens = any_lens(random, 20.0);
      const FacingCounts counts = judged(spec, scene, camera);
      EXPECT_TRUE(counts.all_right())
          << spec << ", trial " << trial << ", view " << view << ": " << counts.front_left_out
          << " front faces, " << counts.edge_on_left_out << " edge-on";
      sum += counts;
    }
  }
  std::cout << sum.back << " back faces, " << sum.back_left_out << " left out\n";
  EXPECT_GT(sum.back_left_out, sum.back / 4);
}

TEST(NormalMask, TestsObjectsBesideTheView) {
  const Scene scene = one_object(sphere_mesh(8));
  Camera camera = camera_at({0.0, 0.0, 9.0}, {9.0, 0.0, 0.0});  // 45 degrees beside the middle
  camera.lens = perspective_lens(degrees(40.0), 1.0, 0.1, 100.0);
  const FacingCounts counts = judged("backface.normal_mask", scene, camera);
  EXPECT_TRUE(counts.all_right());
  EXPECT_GT(counts.recall(), 0.5);
}

TEST(NormalMask, KeepsWhatReachesBehindTheEye) {
  // Beside the eye, half of it in front.
  const Scene scene = one_object(sphere_mesh(8));
  const Camera camera = camera_at({0.0, 0.0, 3.0}, {3.0, 0.0, 3.0});
  EXPECT_EQ(judged("backface.normal_mask", scene, camera).back_left_out, 0U);
}

TEST(NormalMask, AnswersTheSameForPartsOfAMesh) {
  Random random(9);
  const Scene scene = one_object(sphere_mesh(20));
  const Camera camera = camera_at({0.4, 0.7, 2.2}, {0.3, 0.0, 0.0});
  const auto left_out = [&](const std::vector<TriangleRange>& offered) {
    CullerRun run("backface.normal_mask[n=16,sectors=16]", scene);
    const std::span<const TriangleRange> span(offered);
    std::set<std::uint32_t> out;
    for (const TriangleRange& range : offered) {
      for (std::uint32_t i = 0; i < range.count; ++i) out.insert(range.first + i);
    }
    for (const TriangleRange& range : run.emitted(
             camera, Candidates::of(std::span<const std::span<const TriangleRange>>(&span, 1)))) {
      for (std::uint32_t i = 0; i < range.count; ++i) out.erase(range.first + i);
    }
    return out;
  };
  const std::uint32_t all = scene.triangle_count(0);
  const std::set<std::uint32_t> whole = left_out({{0, 0, all}});
  EXPECT_GT(whole.size(), all / 4);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<TriangleRange> parts;
    const std::uint64_t longest = trial % 2 == 0 ? 9 : 300;
    for (std::uint32_t first = 0; first < all;) {
      const auto count = static_cast<std::uint32_t>(
          std::min<std::uint64_t>(1 + random.below(longest), all - first));
      parts.push_back({0, first, count});
      first += count;
    }
    EXPECT_EQ(left_out(parts), whole) << "parts of up to " << longest;
  }
}

TEST(NormalMask, MakesMasksOnceForObjectsThatAreTurnedTheSame) {
  Random random(10);
  const glm::dmat3 linear = test::linear_map(random, false);
  Scene scene;
  scene.meshes = {sphere_mesh(4)};
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 place(0.1 * (i % 10) - 0.5, 0.1 * (i / 10) - 0.5, 0.0);
    scene.objects.push_back(
        {0, {linear[0] * 0.01, linear[1] * 0.01, linear[2] * 0.01, place}, none_id});
  }
  scene.finish();
  CullerRun run("backface.normal_mask[sectors=1]", scene);
  const Camera camera = camera_at({0.0, 0.0, 2.0}, {0.0, 0.0, 0.0});
  const std::vector<TriangleRange> first = run.emitted(camera);
  EXPECT_EQ(run.counter("directions_tested"), 4U);
  EXPECT_EQ(run.emitted(camera), first);
  EXPECT_EQ(run.counter("directions_tested"), 8U);  // another frame
}

TEST(NormalMask, MakesMasksAnewWhenTheCameraTurns) {
  const Scene scene = one_object(sphere_mesh(20));
  CullerRun both("backface.normal_mask", scene);
  const Camera first = camera_at({0.0, 0.0, 3.0}, {0.0, 0.0, 0.0});
  const Camera second = camera_at({0.5, 0.0, 3.0}, {-1.0, 0.4, 0.0});
  // Also within one frame: stereo pairs are two calls.
  const auto seen = [&](CullerRun& run, const Camera& camera) {
    RecordingSink sink;
    const Frame frame{0, camera, {64, 64}, run.frame(camera).objects, 0.0};
    sink.start(scene, frame);
    run.culler().cull(frame, Candidates::everything(), sink);
    return sink.emitted();
  };
  const std::vector<TriangleRange> of_first = seen(both, first);
  CullerRun fresh("backface.normal_mask", scene);
  const std::vector<TriangleRange> of_second = seen(fresh, second);
  EXPECT_NE(of_first, of_second);
  EXPECT_EQ(seen(both, second), of_second);
  EXPECT_EQ(seen(both, first), of_first);
  // Objects that are turned otherwise have the rectangles of others, but not their masks.
  Scene turned = scene;
  turned.objects.push_back(turned.objects[0]);
  turned.objects[1].transform[0] = -turned.objects[1].transform[0];
  turned.objects[1].transform[2] *= 0.3;
  Scene alone = scene;
  alone.objects[0] = turned.objects[1];
  turned.finish();
  alone.finish();
  CullerRun with_both("backface.normal_mask", turned);
  CullerRun with_one("backface.normal_mask", alone);
  std::vector<TriangleRange> expected = with_one.emitted(first);
  for (TriangleRange& range : expected) range.object = 1;
  std::vector<TriangleRange> found = with_both.emitted(first);
  std::erase_if(found, [](const TriangleRange& range) { return range.object == 0; });
  EXPECT_EQ(found, expected);
}

TEST(NormalMask, TestedByTheMiddleOfClassesIsWrong) {
  // The negative control: most normals of a class whose middle faces away do so too.
  const NormalsField field = normals_field(60.0, 8, 100, 6);
  const SceneState state(field.scene);
  const Frame frame{0, field.camera, {64, 64}, state.view(), 0.0};
  const std::vector<test::Facing> facings = test::exact_facings(field.scene, frame);
  Registry registry;
  register_all_cullers(registry);
  const CullerInfo& info = registry.entry("backface.normal_mask").info;
  std::uint64_t last = 0;
  for (const int n : {18, 8, 2}) {
    const auto wrong = [&](ClassTest class_test) {
      const std::unique_ptr<ICuller> culler = make_normal_mask(info, {n, 8, false, class_test});
      culler->build(field.scene, {});
      RecordingSink sink;
      sink.start(field.scene, frame);
      culler->cull(frame, Candidates::everything(), sink);
      return test::count_facings(field.scene, frame, facings, sink.emitted()).front_left_out;
    };
    EXPECT_EQ(wrong(ClassTest::corners), 0U);
    const std::uint64_t front = wrong(ClassTest::centre);
    EXPECT_GT(front, last) << "n = " << n;  // the coarser the worse
    last = front;
  }
}

}  // namespace
}  // namespace vislab
