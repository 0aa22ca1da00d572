// backface.cluster_tree[mixed=test]: all that backface.polygon finds, and back faces only.
#include <gtest/gtest.h>

#include <bit>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/cluster_tree_data.h"
#include "common/simd/simd_target.h"
#include "tests/algorithms/facing_worlds.h"
#include "tests/algorithms/run_culler.h"
#include "tests/geometry/exact_facing.h"

namespace vislab {
namespace {

using namespace backface_culling;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int effort = 1;
#else
constexpr int effort = 8;
#endif

constexpr const char* tested = "backface.cluster_tree[mixed=test,open=cull]";

using Bits = std::vector<std::uint64_t>;

std::size_t count_of(const Bits& bits) {
  std::size_t count = 0;
  for (const std::uint64_t word : bits) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

/// What a tree finds of its mesh, tested clusters and mixed ones.
Bits found_by(const ClusterTree& tree, const Mesh& mesh, const MeshFrame& frame,
              const MeshEye& eye) {
  TreeAnswer answer;
  answer.reserve(tree.nodes().size());
  find_back_and_mixed(tree.nodes(), cluster_eye(eye, frame, tree.reach()), answer);
  Bits bits(words_of(mesh.triangles.size()), 0);
  for (const std::uint32_t child : answer.found()) tree.mark(child, bits.data());
  std::vector<std::uint32_t> clusters;
  for (const std::uint32_t child : answer.found_mixed()) {
    EXPECT_EQ(tree.nodes()[child / ClusterBlock::width].node[child % ClusterBlock::width], 0U);
    clusters.push_back(tree.clusters_below(child).first);
  }
  tree.mark_mixed(clusters, plane_test(eye, frame), bits.data());
  return bits;
}

Bits found_by_planes(const Mesh& mesh, const MeshFrame& frame, const MeshEye& eye) {
  Bits bits(words_of(mesh.triangles.size()), 0);
  mark_behind_scalar(PlaneArrays(mesh, frame), plane_test(eye, frame), 0,
                     static_cast<std::uint32_t>(mesh.triangles.size()), bits.data());
  return bits;
}

/// A bumpy sphere, and triangles that are nearly or wholly without area, which no cluster takes.
Mesh with_slivers(std::uint32_t subdivisions, Random& random) {
  Mesh mesh = bumpy_sphere_mesh({subdivisions, Bumps::high, 0.0, glm::dvec3(0.0)});
  for (int i = 0; i < 150; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const glm::dvec3 a = test::vector_in(random, 1.0);
    const glm::dvec3 way = test::vector_in(random, 1.0);
    mesh.positions.emplace_back(a);
    mesh.positions.emplace_back(a + way);
    mesh.positions.emplace_back(a + 0.5 * way + test::vector_in(random, i % 3 == 0 ? 0.0 : 1e-6));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  mesh.bounds = Aabb();
  for (const glm::vec3& p : mesh.positions) mesh.bounds.extend(p);
  return mesh;
}

/// About 84,000 triangles, row by row: so many that clusters save time. With a small hole, so that
/// nobody has to find out whether so large a mesh is solid.
Mesh smooth_sphere() { return bumpy_sphere_mesh({84, Bumps::none, 0.001, glm::dvec3(0.0)}); }

/// The same triangles in an order that has nothing to do with where they are.
Mesh shuffled(Mesh mesh, Random& random) {
  for (std::size_t i = mesh.triangles.size(); i-- > 1;) {
    std::swap(mesh.triangles[i], mesh.triangles[random.below(i + 1)]);
  }
  return mesh;
}

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.objects = {{0, glm::dmat4x3(1.0), none_id}};
  scene.finish();
  return scene;
}

TEST(MixedClusters, FindAllThatPlanesFindOnEveryInstructionSet) {
  Random random(31);
  for (const std::uint32_t size : {1U, 5U, 32U, 150U, 100000U}) {
    const Mesh mesh = with_slivers(14, random);
    const MeshFrame frame(mesh);
    ClusterSettings settings;
    settings.size = size;
    settings.least_count = 1;
    const ClusterTree tree(mesh, frame, settings, MixedClusters::test);
    std::size_t found = 0;
    std::size_t all = 0;
    for (int i = 0; i < 6 * effort; ++i) {
      MeshEye eye;
      eye.position = glm::dvec4(test::vector_in(random, std::exp2(random.uniform(0.0, 8.0))),
                                i % 4 == 0 ? 0.0 : 1.0);
      const Bits planes = found_by_planes(mesh, frame, eye);
      const Bits first = found_by(tree, mesh, frame, eye);
      for (std::size_t word = 0; word < first.size(); ++word) {
        EXPECT_EQ(planes[word] & ~first[word], 0U) << "missed, size " << size;
      }
      found += count_of(first);
      all += mesh.triangles.size();
      for (const std::string& target : simd_targets()) {
        const SimdTargetScope scope(target);
        EXPECT_EQ(found_by(tree, mesh, frame, eye), first) << target;
      }
    }
    EXPECT_GT(found, all / 3);
    EXPECT_LT(found, 2 * all / 3);
  }
}

TEST(MixedClusters, LeaveOutOnlyBackFacesBeforeEyesMadeToBreakThem) {
  Random random(32);
  std::uint64_t marked = 0;
  for (int world = 0; world < 8 * effort; ++world) {
    const Scene scene = test::facing_world(random, world % 2 == 0, world % 4 < 2);
    std::vector<ClusterTree> trees;
    for (const Mesh& mesh : scene.meshes) {
      ClusterSettings settings;
      settings.size = 2 + static_cast<std::uint32_t>(random.below(100));
      settings.least_count = 1;
      trees.emplace_back(mesh, MeshFrame(mesh), settings, MixedClusters::test);
    }
    const SceneState state(scene);
    for (int i = 0; i < 10; ++i) {
      const Camera camera = test::facing_camera(random, scene);
      const std::vector<test::Facing> facings =
          test::exact_facings(scene, {0, camera, Viewport{64, 64}, state.view(), 0.0});
      for (ObjectId object = 0; object < scene.object_count(); ++object) {
        const MeshId id = scene.objects[object].mesh;
        const Mesh& mesh = scene.meshes[id];
        const MeshFrame frame(mesh);
        const auto eye = eye_in_mesh(camera, scene.objects[object].transform, frame);
        if (!eye) continue;
        const Bits bits = found_by(trees[id], mesh, frame, *eye);
        const Bits planes = found_by_planes(mesh, frame, *eye);
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
          const std::uint64_t bit = std::uint64_t{1} << (t % 64);
          EXPECT_LE(planes[t / 64] & bit, bits[t / 64] & bit);
          if ((bits[t / 64] & bit) == 0) continue;
          ++marked;
          EXPECT_EQ(facings[scene.first_triangle(object) + t], test::Facing::back);
        }
      }
    }
  }
  EXPECT_GT(marked, 1000U);
}

TEST(MixedClusters, AreWeighedAgainstPlanesForEachMesh) {
  Random random(33);
  const Mesh sphere = smooth_sphere();
  const Scene in_order = scene_of(sphere);
  const Scene in_no_order = scene_of(shuffled(sphere, random));
  const Camera camera = camera_at({0.0, 1.0, 3.0}, {0.0, 0.0, 0.0});
  const auto run_on = [&](const Scene& scene) {
    CullerRun run(tested, scene);
    const Frame frame = run.frame(camera);
    const test::FacingCounts counts =
        test::count_facings(scene, frame, test::exact_facings(scene, frame), run.emitted(camera));
    EXPECT_TRUE(counts.all_right());
    EXPECT_GT(counts.recall(), 0.999);
    return std::pair(run.counter("node_tests"), run.counter("triangles_tested"));
  };
  const auto [nodes, triangles] = run_on(in_order);
  EXPECT_GT(nodes, 0U);
  EXPECT_LT(triangles, sphere.triangles.size() / 4);
  const auto [no_nodes, all_triangles] = run_on(in_no_order);
  EXPECT_EQ(no_nodes, 0U);
  EXPECT_EQ(all_triangles, sphere.triangles.size());
  // Kept clusters have no use for planes, in whatever order they are.
  CullerRun keeping("backface.cluster_tree[open=cull]", in_no_order);
  CullerRun testing(tested, in_order);
  CullerRun only_clusters("backface.cluster_tree[open=cull]", in_order);
  keeping.emitted(camera);
  EXPECT_GT(keeping.counter("node_tests"), 0U);
  EXPECT_EQ(keeping.counter("triangles_tested"), 0U);
  EXPECT_GE(testing.culler().bytes(),
            only_clusters.culler().bytes() + 16 * sphere.triangles.size());
}

TEST(MixedClusters, KeepOfSomeTrianglesWhatTheyKeepOfAll) {
  Random random(34);
  const Mesh sphere = smooth_sphere();
  for (const bool in_order : {true, false}) {
    const Scene scene = scene_of(in_order ? sphere : shuffled(sphere, random));
    CullerRun run(tested, scene);
    const Camera camera = camera_at({1.0, 1.0, 2.5}, {0.0, 0.0, 0.0});
    const auto bits_of = [&](std::span<const TriangleRange> ranges) {
      Bits bits(words_of(scene.triangle_count(0)), 0);
      for (const TriangleRange& range : ranges) set_bits(bits, range.first, range.count);
      return bits;
    };
    const Bits all = bits_of(run.emitted(camera));
    EXPECT_EQ(run.counter("node_tests") > 0, in_order);
    for (int i = 0; i < 20; ++i) {
      std::vector<TriangleRange> offered;
      std::uint32_t first = static_cast<std::uint32_t>(random.below(300));
      while (first < scene.triangle_count(0)) {
        const std::uint32_t rest = scene.triangle_count(0) - first;
        const auto count = std::min(rest, 1 + static_cast<std::uint32_t>(random.below(400)));
        offered.push_back({0, first, count});
        first += count + 1 + static_cast<std::uint32_t>(random.below(300));
      }
      const std::vector<std::span<const TriangleRange>> runs = {offered};
      Bits expected = bits_of(offered);
      for (std::size_t word = 0; word < all.size(); ++word) expected[word] &= all[word];
      EXPECT_EQ(bits_of(run.emitted(camera, Candidates::of(runs))), expected);
    }
  }
}

}  // namespace
}  // namespace vislab
