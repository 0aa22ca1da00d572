#include <gtest/gtest.h>

#include <array>
#include <iostream>
#include <set>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/flat_clusters.h"
#include "algorithms/backface/plane_kernel.h"
#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/simd/simd_target.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"
#include "tests/geometry/exact_facing.h"

namespace vislab {
namespace {

Scene one_object(Mesh mesh, const glm::dmat4x3& transform = glm::dmat4x3(1.0)) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.objects = {{0, transform, none_id}};
  scene.finish();
  return scene;
}

std::set<std::uint32_t> triangles(const std::vector<TriangleRange>& ranges) {
  std::set<std::uint32_t> all;
  for (const TriangleRange& range : ranges) {
    for (std::uint32_t i = 0; i < range.count; ++i) {
      EXPECT_TRUE(all.insert(range.first + i).second) << "twice";
    }
  }
  return all;
}

/// A quad in the plane z = 0 that is seen from +z.
Mesh sheet() {
  Mesh mesh;
  mesh.positions = {
      {-1.0F, -1.0F, 0.0F}, {1.0F, -1.0F, 0.0F}, {1.0F, 1.0F, 0.0F}, {-1.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(BackfacePolygon, KeepsTheSidesOfACubeThatFaceTheEye) {
  const Scene scene = one_object(cube_mesh());
  CullerRun run("backface.polygon", scene);
  // Sides in the mesh: -x, +x, -y, +y, -z, +z, two triangles each.
  using Set = std::set<std::uint32_t>;
  const glm::dvec3 middle(0.0);
  EXPECT_EQ(triangles(run.emitted(camera_at({0.0, 0.0, 5.0}, middle))), (Set{10, 11}));
  EXPECT_EQ(triangles(run.emitted(camera_at({0.0, -5.0, 0.1}, middle))), (Set{4, 5}));
  EXPECT_EQ(triangles(run.emitted(camera_at({-4.0, 3.0, 5.0}, middle))), (Set{0, 1, 6, 7, 10, 11}));
}

TEST(BackfacePolygon, KeepsWhatIsSeenExactlyEdgeOn) {
  const Scene scene = one_object(cube_mesh());
  CullerRun run("backface.polygon", scene);
  const Camera beside = camera_at({1.0, 0.0, 5.0}, {0.0, 0.0, 0.0});  // in the plane of +x
  EXPECT_EQ(triangles(run.emitted(beside)), (std::set<std::uint32_t>{2, 3, 10, 11}));
}

TEST(BackfacePolygon, UsesTheViewDirectionOfAnOrthographicCamera) {
  const Scene scene = one_object(cube_mesh());
  CullerRun run("backface.polygon", scene);
  Camera camera = camera_at({3.0, 0.0, 50.0}, {0.0, 0.0, 0.0});
  camera.lens = orthographic_lens(5.0, 1.0, 0.1, 100.0);
  EXPECT_EQ(triangles(run.emitted(camera)), (std::set<std::uint32_t>{2, 3, 4, 5, 6, 7, 10, 11}));
  camera.pose = look_at({3.0, 0.5, 50.0}, {0.0, 0.0, 0.0});
  EXPECT_EQ(triangles(run.emitted(camera)), (std::set<std::uint32_t>{2, 3, 6, 7, 10, 11}));
}

TEST(BackfacePolygon, KeepsAnObjectWholeIfTheEyeIsInItsBoxOrNear) {
  const Scene scene = one_object(cube_mesh());
  CullerRun run("backface.polygon", scene);
  for (const glm::dvec3& eye :
       {glm::dvec3(0.0, 0.0, 0.5), glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 0.0, 1.1)}) {
    EXPECT_EQ(triangles(run.emitted(camera_at(eye, {0.0, 0.0, -3.0}))).size(), 12U);
  }
  Camera orthographic = camera_at({0.0, 0.0, 0.5}, {0.0, 0.0, -3.0});
  orthographic.lens = orthographic_lens(5.0, 1.0, 0.1, 100.0);
  EXPECT_EQ(triangles(run.emitted(orthographic)).size(), 12U);
}

TEST(BackfacePolygon, KeepsOpenMeshesUnlessToldOtherwise) {
  const Scene scene = one_object(sheet());
  const Camera front = camera_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0});
  const Camera back = camera_at({0.0, 0.0, -5.0}, {0.0, 0.0, 0.0});
  CullerRun careful("backface.polygon", scene);
  EXPECT_EQ(careful.culler().info().guarantee, Guarantee::conservative);
  EXPECT_EQ(triangles(careful.emitted(back)).size(), 2U);
  CullerRun careless("backface.polygon[open=cull]", scene);
  EXPECT_EQ(careless.culler().info().guarantee, Guarantee::approximate);
  EXPECT_EQ(triangles(careless.emitted(front)).size(), 2U);
  EXPECT_EQ(triangles(careless.emitted(back)).size(), 0U);
}

TEST(BackfacePolygon, KeepsTheFrontOfObjectsUnderAnyAffineTransform) {
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    glm::dmat4x3 transform;
    do {
      for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) transform[column][row] = random.uniform(-2.0, 2.0);
      }
    } while (glm::determinant(glm::dmat3(transform[0], transform[1], transform[2])) < 0.2);
    const Scene scene = one_object(sphere_mesh(6), transform);
    CullerRun run("backface.polygon", scene);
    const Camera camera = camera_at({9.0, 8.0, 12.0}, {0.0, 0.0, 0.0});
    std::set<std::uint32_t> expected;
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
      const auto [a, b, c] = world_triangle(scene.meshes[0], transform, t);
      const glm::dvec3 normal = glm::cross(b - a, c - a);
      if (glm::dot(normal, camera.pose.eye - a) >= -1e-12) expected.insert(t);
    }
    EXPECT_EQ(triangles(run.emitted(camera)), expected) << "transform " << i;
    EXPECT_GT(expected.size(), 10U);
    EXPECT_LT(expected.size(), 140U);
  }
}

TEST(BackfacePolygon, KeepsOnlyWhatItWasOffered) {
  const Scene scene = one_object(cube_mesh());
  CullerRun run("backface.polygon", scene);
  const std::vector<TriangleRange> some = {{0, 9, 3}, {0, 0, 1}, {0, 2, 3}};
  const std::span<const TriangleRange> span(some);
  const std::vector<TriangleRange> kept =
      run.emitted(camera_at({5.0, 0.1, 5.0}, {0.0, 0.0, 0.0}),
                  Candidates::of(std::span<const std::span<const TriangleRange>>(&span, 1)));
  EXPECT_EQ(kept, (std::vector<TriangleRange>{{0, 10, 2}, {0, 2, 2}}));
}

/// A soup of random triangles around a point, some without area.
Mesh soup(Random& random, std::uint32_t triangles, double size, const glm::dvec3& middle) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
    const glm::dvec3 offset(random.uniform(-size, size), random.uniform(-size, size),
                            random.uniform(-size, size));
    mesh.positions.emplace_back(middle + offset);
  }
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const bool flat = random.below(10) == 0;
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, flat ? 3 * i : 3 * i + 2);
  }
  for (const glm::vec3& position : mesh.positions) mesh.bounds.extend(glm::dvec3(position));
  return mesh;
}

TEST(BackfacePolygon, MarksTheSameTrianglesWithEveryInstructionSetFromAnyStart) {
  using namespace backface_culling;
  Random random(4);
  const Mesh mesh = soup(random, 1000, 3.0, {1.0, 2.0, 3.0});
  const MeshFrame frame(mesh);
  const PlaneArrays planes(mesh, frame);
  for (const double w : {1.0, 0.0}) {
    MeshEye eye;
    eye.position = glm::dvec4(2.0, -7.0, 4.0, w);
    const PlaneTest test = plane_test(eye, frame);
    for (const auto& [first, count] :
         {std::pair(0U, 1000U), std::pair(1U, 999U), std::pair(17U, 64U), std::pair(63U, 66U),
          std::pair(999U, 1U), std::pair(500U, 0U)}) {
      const std::vector<std::uint64_t> filler(words_of(count), ~std::uint64_t{0});
      std::vector<std::uint64_t> expected = filler;
      mark_behind_scalar(planes, test, first, count, expected.data());
      for (std::uint32_t i = 0; i < count; ++i) {
        const glm::dvec4 plane = scaled_plane(mesh, frame, first + i);
        const double value = glm::dot(plane, eye.position);
        const bool marked = (expected[i / 64] >> (i % 64) & 1U) != 0;
        EXPECT_TRUE(!marked || value < 0.0) << first + i;
        EXPECT_TRUE(marked || value > -1e-4) << first + i;
      }
      for (const std::string& target : simd_targets()) {
        const SimdTargetScope scope(target);
        std::vector<std::uint64_t> bits = filler;
        mark_behind(planes, test, first, count, bits.data());
        EXPECT_EQ(bits, expected) << target << " from " << first << ", " << count << " triangles";
      }
    }
  }
}

TEST(BackfacePolygon, DecidesNearlyAllTrianglesOfTinyAndHugeMeshesFromNearAndFar) {
  using namespace backface_culling;
  Random random(5);
  for (const double size : {1e-36, 1e-18, 1.0, 1e18, 1e37}) {
    const Mesh mesh = soup(random, 300, size, glm::dvec3(size));
    const MeshFrame frame(mesh);
    const PlaneArrays planes(mesh, frame);
    for (const double distance : {2.0, 1e10, 1e60}) {
      MeshEye eye;
      eye.position = glm::dvec4(glm::dvec3(0.3, -0.7, 0.2) * (size * distance), 1.0);
      std::vector<std::uint64_t> bits(words_of(300));
      mark_behind(planes, plane_test(eye, frame), 0, 300, bits.data());
      int undecided = 0;
      for (std::uint32_t i = 0; i < 300; ++i) {
        const bool marked = (bits[i / 64] >> (i % 64) & 1U) != 0;
        const bool behind = glm::dot(scaled_plane(mesh, frame, i), eye.position) < 0.0;
        EXPECT_TRUE(!marked || behind) << size << ", " << distance;
        undecided += behind && !marked ? 1 : 0;
      }
      EXPECT_LE(undecided, 1) << size << ", " << distance;
    }
  }
}

/// Side of the plane through a, b, c on which p lies, exactly: coordinates are whole numbers below
/// 2^22, so that no product of three differences reaches 2^127.
int exact_side(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& c, const glm::ivec3& p) {
  __extension__ using Wide = __int128;
  const auto difference = [&](const glm::ivec3& q) { return glm::i64vec3(q) - glm::i64vec3(a); };
  const glm::i64vec3 u = difference(b), v = difference(c), w = difference(p);
  const Wide volume = Wide(u.y * v.z - u.z * v.y) * w.x + Wide(u.z * v.x - u.x * v.z) * w.y +
                      Wide(u.x * v.y - u.y * v.x) * w.z;
  return volume > 0 ? 1 : volume < 0 ? -1 : 0;
}

class BackfaceForms : public testing::TestWithParam<const char*> {};

TEST_P(BackfaceForms, AreNeverWrongNextToThePlaneOfATriangle) {
  Random random(21);
  const auto whole = [&](int limit) {
    return glm::ivec3(random.uniform(-limit, limit), random.uniform(-limit, limit),
                      random.uniform(-limit, limit));
  };
  int behind = 0;
  int culled = 0;
  for (int i = 0; i < 3000; ++i) {
    const int size = i % 2 == 0 ? 1 << 20 : 40;  // also slivers, by chance
    const glm::ivec3 a = whole(size), b = whole(size), c = whole(size);
    const glm::ivec3 offset = whole(1000);
    // In the plane, far outside of the triangle, and up to one unit off it.
    const auto s = static_cast<int>(random.below(3)), t = static_cast<int>(random.below(3));
    const glm::ivec3 eye = a + (b - a) * -s + (c - a) * -t + whole(2);
    Mesh mesh;
    mesh.positions = {glm::vec3(a), glm::vec3(b), glm::vec3(c)};
    mesh.triangles = {{0, 1, 2}};
    Scene scene;
    try {
      scene = one_object(mesh, placed(glm::dvec3(offset)));
    } catch (const std::runtime_error&) {
      continue;
    }
    Camera camera = camera_at(glm::dvec3(eye + offset), glm::dvec3(a + offset) + 0.5);
    camera.lens.near_m = 1e-3;
    CullerRun run(std::string("backface.polygon[open=cull,form=") + GetParam() + "]", scene);
    const bool kept = !run.emitted(camera).empty();
    const int side = exact_side(a, b, c, eye);
    EXPECT_TRUE(kept || side < 0) << "triangle " << i << " is seen from side " << side;
    behind += side < 0 ? 1 : 0;
    culled += kept ? 0 : 1;
  }
  EXPECT_GT(behind, 500);
  EXPECT_GT(culled, behind / 3);  // the error bound is not an excuse to keep everything
}

INSTANTIATE_TEST_SUITE_P(All, BackfaceForms, testing::Values("hesse", "computed", "stored_normal"),
                         [](const auto& form) { return std::string(form.param); });

/// A sphere with bumps, and eyes around it.
class BackfaceOfABumpySphere : public testing::Test {
 protected:
  static Scene sphere(Bumps bumps) {
    BumpySphereParameters parameters;
    parameters.subdivisions = 40;
    parameters.bumps = bumps;
    Scene scene = make_bumpy_sphere(parameters);
    scene.finish();
    return scene;
  }
  static std::vector<Camera> around() {
    std::vector<Camera> cameras;
    for (int i = 0; i < 12; ++i) {
      const double angle = degrees(30.0 * i);
      cameras.push_back(camera_at(
          3.0 * glm::dvec3(std::cos(angle), std::sin(2.0 * angle), std::sin(angle)), {0, 0, 0}));
    }
    return cameras;
  }
  static test::FacingCounts judged(CullerRun& run, const Scene& scene) {
    test::FacingCounts sum;
    for (const Camera& camera : around()) {
      const Frame frame = run.frame(camera);
      run.update(camera, {});
      sum +=
          test::count_facings(scene, frame, test::exact_facings(scene, frame), run.emitted(camera));
    }
    return sum;
  }
};

TEST_F(BackfaceOfABumpySphere, IsFoundByAllExactFormsNearlyWhole) {
  const Scene scene = sphere(Bumps::high);
  for (const char* spec : {"backface.polygon", "backface.polygon[form=computed]",
                           "backface.polygon[form=stored_normal]", "backface.projected_plane"}) {
    CullerRun run(spec, scene);
    const test::FacingCounts counts = judged(run, scene);
    EXPECT_TRUE(counts.all_right()) << spec;
    EXPECT_GT(counts.recall(), 0.9999) << spec;
  }
}

TEST_F(BackfaceOfABumpySphere, LosesFrontFacesByTheNormalsOfVerticesMostlyInHollows) {
  // Of what is left out, by bumps: none, low, high.
  constexpr std::array<double, 3> least{0.0, 0.001, 0.02};
  constexpr std::array<double, 3> most{0.001, 0.01, 0.1};
  for (const Bumps bumps : {Bumps::none, Bumps::low, Bumps::high}) {
    const Scene scene = sphere(bumps);
    CullerRun run("backface.polygon[form=vertex_normals]", scene);
    EXPECT_EQ(run.culler().info().guarantee, Guarantee::approximate);
    const test::FacingCounts counts = judged(run, scene);
    const double wrong = static_cast<double>(counts.front_left_out) /
                         static_cast<double>(counts.front_left_out + counts.back_left_out);
    const auto kind = static_cast<std::size_t>(bumps);
    std::cout << "bumps " << kind << ": of what is left out " << 100.0 * wrong
              << " % are front faces; of the back faces " << 100.0 * counts.recall()
              << " % are left out\n";
    EXPECT_GT(wrong, least[kind]);
    EXPECT_LT(wrong, most[kind]);
    EXPECT_GT(counts.recall(), 0.8);
  }
}

TEST_F(BackfaceOfABumpySphere, CostsMoreTheDearerATestIsIfTheCostModelHasThePrintedSign) {
  using namespace backface_culling;
  const Scene scene = sphere(Bumps::high);
  const Mesh& mesh = scene.meshes[0];
  const MeshFrame frame(mesh);
  struct Work {
    std::size_t clusters = 0;
    double cost = 0.0;  // of all views, in triangles drawn
  };
  const auto work = [&](double test_cost, JoinRule rule) {
    ClusterSettings settings;
    settings.test_cost = test_cost;
    settings.join = rule;
    const FlatClusters clusters(mesh, frame, settings);
    Work sum{clusters.cluster_count(), 0.0};
    std::vector<std::uint64_t> back(words_of(sum.clusters));
    for (const Camera& camera : around()) {
      const auto eye = eye_in_mesh(camera, scene.objects[0].transform, frame);
      find_back(clusters.blocks(), cluster_eye(*eye, frame, clusters.reach()), back);
      std::vector<std::uint64_t> bits(words_of(mesh.triangles.size()), 0);
      clusters.mark(back, bits.data());
      sum.cost += static_cast<double>(sum.clusters) * test_cost +
                  static_cast<double>(mesh.triangles.size());
      for (const std::uint64_t word : bits) sum.cost -= std::popcount(word);
    }
    return sum;
  };
  for (const double test_cost : {0.02, 1.0, 4.0, 16.0}) {
    const Work derived = work(test_cost, JoinRule::derived);
    const Work printed = work(test_cost, JoinRule::printed);
    std::cout << "t_C / r = " << test_cost << ": " << derived.clusters << " clusters, printed sign "
              << printed.clusters << "; cost " << derived.cost << ", printed sign " << printed.cost
              << "\n";
    CullerRun run(
        "backface.wrong[error=printed_cost_sign,test_cost=" + std::to_string(test_cost) + "]",
        scene);
    EXPECT_TRUE(judged(run, scene).all_right());
    EXPECT_EQ(run.counter("cluster_tests"), printed.clusters * around().size());
    EXPECT_LE(derived.cost, printed.cost);
    if (test_cost >= 1.0) {
      EXPECT_LT(derived.clusters, printed.clusters);
      EXPECT_LT(derived.cost, 0.99 * printed.cost);
    }
  }
}

}  // namespace
}  // namespace vislab
