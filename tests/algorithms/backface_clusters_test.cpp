#include <gtest/gtest.h>

#include <set>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/cluster_tree_data.h"
#include "algorithms/backface/flat_clusters.h"
#include "common/simd/simd_target.h"
#include "tests/algorithms/facing_worlds.h"
#include "tests/geometry/exact_facing.h"

namespace vislab {
namespace {

using namespace backface_culling;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int effort = 1;
#else
constexpr int effort = 10;
#endif

Mesh with_bounds(Mesh mesh) {
  mesh.bounds = Aabb();
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) mesh.bounds.extend(mesh.positions[triangle[corner]]);
  }
  return mesh;
}

Mesh bumpy(std::uint32_t subdivisions, const glm::dvec3& offset = glm::dvec3(0.0)) {
  return with_bounds(bumpy_sphere_mesh({subdivisions, Bumps::high, 0.0, offset}));
}

/// A cube of 12 n^2 triangles, six planes.
Mesh divided_cube(std::uint32_t n) {
  Mesh mesh = bumpy_sphere_mesh({n, Bumps::none, 0.0, glm::dvec3(0.0)});
  // Each side of the sphere back onto its plane.
  for (glm::vec3& p : mesh.positions) {
    p /= std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(p[axis]) > 1.0F - 1e-5F) p[axis] = p[axis] > 0.0F ? 1.0F : -1.0F;
    }
  }
  return with_bounds(std::move(mesh));
}

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.objects = {{0, glm::dmat4x3(1.0), none_id}};
  scene.finish();
  return scene;
}

void expect_partition(const Mesh& mesh, const TriangleClusters& clusters, std::uint32_t size) {
  ASSERT_EQ(clusters.order.size(), mesh.triangles.size());
  ASSERT_EQ(clusters.first.front(), 0U);
  ASSERT_EQ(clusters.first.back(), mesh.triangles.size());
  std::set<std::uint32_t> seen;
  for (std::uint32_t cluster = 0; cluster < clusters.count(); ++cluster) {
    const std::span<const std::uint32_t> triangles = clusters.of(cluster);
    EXPECT_FALSE(triangles.empty());
    EXPECT_TRUE(std::ranges::is_sorted(triangles));
    if (cluster < clusters.tested) {
      EXPECT_LE(triangles.size(), size);
    }
    seen.insert(triangles.begin(), triangles.end());
  }
  EXPECT_EQ(seen.size(), mesh.triangles.size());
  // The tree's leaves are the clusters, in order.
  std::uint32_t leaf = 0;
  for (std::uint32_t i = 0; i < clusters.nodes.size(); ++i) {
    const TriangleClusters::Node& node = clusters.nodes[i];
    if (node.is_cluster()) {
      EXPECT_EQ(node.first, clusters.first[leaf]);
      EXPECT_EQ(node.end, clusters.first[++leaf]);
    } else {
      EXPECT_EQ(node.left, i + 1);
      EXPECT_EQ(clusters.nodes[node.left].first, node.first);
      EXPECT_EQ(clusters.nodes[node.left].end, clusters.nodes[node.right].first);
      EXPECT_EQ(clusters.nodes[node.right].end, node.end);
    }
  }
  EXPECT_EQ(leaf, clusters.tested);
}

TEST(TriangleClusters, ArePartitionsOfTheTriangles) {
  for (const Mesh& mesh : {bumpy(1), bumpy(7), bumpy(20), with_bounds(sphere_mesh(9)),
                           with_bounds(ribbed_sphere_mesh(9, 17, 4))}) {
    for (const std::uint32_t size : {1U, 3U, 16U, 100000U}) {
      ClusterSettings settings;
      settings.size = size;
      settings.test_cost = -1.0;  // nothing is joined
      expect_partition(mesh, make_clusters(mesh, MeshFrame(mesh), settings), size);
    }
  }
}

TEST(TriangleClusters, SetTrianglesWithoutAreaApart) {
  Mesh mesh = bumpy(4);
  const auto first_bad = static_cast<std::uint32_t>(mesh.triangles.size());
  mesh.triangles.emplace_back(1, 1, 2);
  mesh.triangles.emplace_back(0, 0, 0);
  const TriangleClusters clusters = make_clusters(mesh, MeshFrame(mesh), {});
  ASSERT_EQ(clusters.count(), clusters.tested + 1);
  EXPECT_TRUE(std::ranges::equal(clusters.of(clusters.tested),
                                 std::vector<std::uint32_t>{first_bad, first_bad + 1}));
  Mesh nothing_else = mesh;
  nothing_else.triangles = {{1, 1, 2}};
  const TriangleClusters none =
      make_clusters(nothing_else, MeshFrame(with_bounds(nothing_else)), {});
  EXPECT_EQ(none.count(), 1U);
  EXPECT_EQ(none.tested, 0U);
  EXPECT_TRUE(none.nodes.empty());
}

TEST(TriangleClusters, AreAsManyAsTheCostModelWants) {
  const Mesh cube = divided_cube(24);
  const MeshFrame frame(cube);
  ClusterSettings settings;
  settings.test_cost = CostTable::typical().cluster_test_over_triangle();
  // The triangles of a side lie in one plane: what of them is one subtree is one cluster.
  EXPECT_LE(make_clusters(cube, frame, settings).tested, 24U);
  // With the sign as printed, joining has to cull more than the halves did.
  settings.join = JoinRule::printed;
  EXPECT_GT(make_clusters(cube, frame, settings).tested, 400U);
  // Where tests cost more, there are fewer.
  const Mesh sphere = bumpy(20);
  std::uint32_t before = ~0U;
  for (const double cost : {0.01, 1.0, 30.0, 1e4}) {
    ClusterSettings dear;
    dear.size = 4;
    dear.test_cost = cost;
    const TriangleClusters clusters = make_clusters(sphere, MeshFrame(sphere), dear);
    EXPECT_LT(clusters.tested, before) << cost;
    before = clusters.tested;
    expect_partition(sphere, clusters, ~0U);
  }
  EXPECT_EQ(before, 1U);
}

/// All triangles of a few clusters of a mesh.
struct Patch {
  std::vector<glm::dvec4> planes;
  Aabb box;
};

Patch patch_of(const Mesh& mesh, const MeshFrame& frame, std::span<const std::uint32_t> triangles) {
  Patch patch;
  for (const std::uint32_t triangle : triangles) {
    patch.planes.push_back(unit_plane(mesh, frame, triangle));
  }
  patch.box = box_of(mesh, frame, triangles);
  return patch;
}

TEST(ClusterBound, OfTwoClustersNeedsItsOwnDistance) {
  // Two triangles in parallel planes, z = 0 and z = 1, each a cluster with its own origin.
  Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F},
                    {0.0F, 0.0F, 1.0F}, {1.0F, 0.0F, 1.0F}, {0.0F, 1.0F, 1.0F}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh = with_bounds(mesh);
  const MeshFrame frame(mesh);
  const std::vector<std::uint32_t> both = {0, 1};
  const Patch a = patch_of(mesh, frame, std::span(both).first(1));
  const Patch b = patch_of(mesh, frame, std::span(both).last(1));
  const Patch joined = patch_of(mesh, frame, both);
  const ClusterBound right = bound_of(joined.planes, joined.box, frame, Origin::centre);
  // The slides' rule, right for a common origin only.
  ClusterBound by_rule = right;
  by_rule.back = std::min(bound_of(a.planes, a.box, frame, Origin::centre).back,
                          bound_of(b.planes, b.box, frame, Origin::centre).back);
  const auto facing = [&](const ClusterBound& bound, double z) {
    MeshEye eye;
    eye.position = glm::dvec4(glm::dvec3(0.3, 0.3, z) - frame.middle, 1.0);
    return facing_of(bound, cluster_eye(eye, frame, 1.0));
  };
  EXPECT_EQ(facing(right, -0.2), ClusterFacing::back);
  EXPECT_EQ(facing(right, 0.2), ClusterFacing::mixed);  // before the first, behind the second
  EXPECT_EQ(facing(by_rule, 0.2), ClusterFacing::back) << "leaves out a front face";
  EXPECT_EQ(facing(right, 1.2), ClusterFacing::front);
}

TEST(ClusterBound, TellsBacksAndFrontsOfEveryPlane) {
  const Mesh mesh = bumpy(16, {3.0, -2.0, 1.0});
  const MeshFrame frame(mesh);
  const TriangleClusters clusters = make_clusters(mesh, frame, {});
  Random random(4);
  int decided = 0;
  for (const Origin origin : {Origin::mesh, Origin::centre, Origin::best}) {
    for (std::uint32_t cluster = 0; cluster < clusters.tested; ++cluster) {
      const Patch patch = patch_of(mesh, frame, clusters.of(cluster));
      const ClusterBound bound = bound_of(patch.planes, patch.box, frame, origin);
      for (int i = 0; i < 8; ++i) {
        MeshEye eye;
        eye.position = glm::dvec4(test::vector_in(random, 3.0), i % 4 == 0 ? 0.0 : 1.0);
        const ClusterFacing facing = facing_of(bound, cluster_eye(eye, frame, 5.0));
        if (facing == ClusterFacing::mixed) continue;
        ++decided;
        for (const glm::dvec4& plane : patch.planes) {
          const double value = glm::dot(plane, eye.position);
          EXPECT_TRUE(facing == ClusterFacing::back ? value < 0.0 : value > 0.0);
        }
      }
    }
  }
  EXPECT_GT(decided, 1000);
  EXPECT_EQ(facing_of(bound_of({}, {}, frame, Origin::best), {}), ClusterFacing::mixed);
}

std::vector<MeshEye> some_eyes(Random& random, int count) {
  std::vector<MeshEye> eyes;
  for (int i = 0; i < count; ++i) {
    MeshEye eye;
    const double reach = std::exp2(random.uniform(0.0, 12.0));
    eye.position = glm::dvec4(test::vector_in(random, reach), i % 4 == 0 ? 0.0 : 1.0);
    eyes.push_back(eye);
  }
  return eyes;
}

TEST(ClusterKernel, AnswersAsTheScalarTestOnEveryInstructionSet) {
  const Mesh mesh = bumpy(20);
  const MeshFrame frame(mesh);
  ClusterSettings settings;
  settings.size = 7;
  const TriangleClusters clusters = make_clusters(mesh, frame, settings);
  const FlatClusters flat(mesh, frame, settings);
  const ClusterTree tree(mesh, frame, settings);
  ASSERT_EQ(flat.cluster_count(), clusters.tested);
  ASSERT_NE(clusters.tested % 16, 0U);  // a block that is not full is among them
  std::vector<ClusterBound> bounds;
  for (std::uint32_t cluster = 0; cluster < clusters.tested; ++cluster) {
    const Patch patch = patch_of(mesh, frame, clusters.of(cluster));
    bounds.push_back(bound_of(patch.planes, patch.box, frame, settings.origin));
  }
  Random random(8);
  for (const MeshEye& eye : some_eyes(random, 20 * effort)) {
    const ClusterEye rounded = cluster_eye(eye, frame, flat.reach());
    std::vector<std::uint64_t> expected(words_of(clusters.tested), 0);
    for (std::uint32_t cluster = 0; cluster < clusters.tested; ++cluster) {
      if (facing_of(bounds[cluster], rounded) == ClusterFacing::back) {
        set_bits(expected, cluster, 1);
      }
    }
    std::vector<std::uint32_t> first_found;
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      std::vector<std::uint64_t> back(expected.size());
      find_back(flat.blocks(), rounded, back);
      EXPECT_EQ(back, expected) << target;
      TreeAnswer answer;
      answer.reserve(tree.nodes().size());
      find_back(tree.nodes(), cluster_eye(eye, frame, tree.reach()), answer);
      std::vector<std::uint32_t> found(answer.found().begin(), answer.found().end());
      if (target == simd_targets().front()) first_found = found;
      EXPECT_EQ(found, first_found) << target;
    }
  }
}

TEST(ClusterTree, FindsAllThatItsClustersFind) {
  for (const std::uint32_t size : {1U, 4U, 16U}) {
    const Mesh mesh = bumpy(16);
    const MeshFrame frame(mesh);
    ClusterSettings settings;
    settings.size = size;
    settings.test_cost = 0.03;
    const FlatClusters flat(mesh, frame, settings);
    const ClusterTree tree(mesh, frame, settings);
    TreeAnswer answer;
    answer.reserve(tree.nodes().size());
    Random random(9);
    std::size_t tested = 0;
    std::uint64_t found = 0;
    const std::vector<MeshEye> eyes = some_eyes(random, 40);
    for (const MeshEye& eye : eyes) {
      const double reach = std::max(flat.reach(), tree.reach());
      const ClusterEye rounded = cluster_eye(eye, frame, reach);
      std::vector<std::uint64_t> clusters(words_of(flat.cluster_count()), 0);
      find_back(flat.blocks(), rounded, clusters);
      std::vector<std::uint64_t> by_clusters(words_of(mesh.triangles.size()), 0);
      flat.mark(clusters, by_clusters.data());
      find_back(tree.nodes(), rounded, answer);
      tested += answer.nodes_tested;
      std::vector<std::uint64_t> by_tree(by_clusters.size(), 0);
      std::vector<std::uint64_t> below(clusters.size(), 0);
      for (const std::uint32_t child : answer.found()) {
        std::vector<std::uint64_t> alone(by_clusters.size(), 0);
        tree.mark(child, alone.data());
        for (std::size_t word = 0; word < alone.size(); ++word) {
          EXPECT_EQ(by_tree[word] & alone[word], 0U);  // no triangle twice
          by_tree[word] |= alone[word];
        }
        set_bits(below, tree.clusters_below(child).first, tree.clusters_below(child).count);
      }
      // The marks of a node are those of the clusters below it.
      std::vector<std::uint64_t> of_clusters(by_clusters.size(), 0);
      flat.mark(below, of_clusters.data());
      EXPECT_EQ(by_tree, of_clusters);
      for (std::size_t word = 0; word < by_tree.size(); ++word) {
        // A node's float bound about another origin may miss what is next to the limit.
        EXPECT_EQ(by_clusters[word] & ~by_tree[word], 0U);
        found += static_cast<std::uint64_t>(std::popcount(by_tree[word]));
      }
    }
    EXPECT_GT(found, eyes.size() * mesh.triangles.size() / 4);
    if (size == 1) {
      EXPECT_LT(tested, eyes.size() * tree.nodes().size() * 3 / 4);
    }
  }
}

TEST(RunList, MarksTheTrianglesItWasGiven) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t t = 0; t < 1000; ++t) {
      if (random.below(100) < static_cast<std::uint64_t>(i) || (t > 300 && t < 500)) {
        triangles.push_back(t);
      }
    }
    std::vector<std::uint64_t> expected(words_of(1000), 0), by_runs = expected, by_words = expected;
    for (const std::uint32_t t : triangles) set_bits(expected, t, 1);
    RunList runs;
    runs.append(triangles);
    runs.mark(0, runs.size(), by_runs.data());
    EXPECT_EQ(by_runs, expected);
    WordList words;
    words.append(triangles);
    EXPECT_EQ(words.size(), WordList::words_for(triangles));
    words.mark(0, words.size(), by_words.data());
    EXPECT_EQ(by_words, expected);
  }
  EXPECT_THROW(RunList::check(RunList::most_triangles + std::size_t{1}), InputError);
  EXPECT_NO_THROW(RunList::check(RunList::most_triangles));
}

test::FacingCounts counts_of(CullerRun& run, const Scene& scene, const Camera& camera) {
  const Frame frame = run.frame(camera);
  const std::vector<test::Facing> facings = test::exact_facings(scene, frame);
  return test::count_facings(scene, frame, facings, run.emitted(camera));
}

TEST(BackfaceClusters, OfSeveralTrianglesLeaveOutOnlyBackFaces) {
  Random random(17);
  std::uint64_t marked = 0;
  for (int world = 0; world < 12 * effort; ++world) {
    const Scene scene = test::facing_world(random, world % 2 == 0, world % 4 < 2);
    std::vector<FlatClusters> clusters;
    for (const Mesh& mesh : scene.meshes) {
      ClusterSettings settings;
      settings.size = 2 + static_cast<std::uint32_t>(random.below(12));
      settings.least_count = 1;
      clusters.emplace_back(mesh, MeshFrame(mesh), settings);
    }
    const SceneState state(scene);
    for (int i = 0; i < 10; ++i) {
      const Camera camera = test::facing_camera(random, scene);
      const std::vector<test::Facing> facings =
          test::exact_facings(scene, {0, camera, Viewport{64, 64}, state.view(), 0.0});
      for (ObjectId object = 0; object < scene.object_count(); ++object) {
        const MeshId mesh = scene.objects[object].mesh;
        const MeshFrame frame(scene.meshes[mesh]);
        const auto eye = eye_in_mesh(camera, scene.objects[object].transform, frame);
        if (!eye) continue;
        std::vector<std::uint64_t> back(words_of(clusters[mesh].cluster_count()));
        find_back(clusters[mesh].blocks(), cluster_eye(*eye, frame, clusters[mesh].reach()), back);
        std::vector<std::uint64_t> bits(words_of(clusters[mesh].triangle_count()), 0);
        clusters[mesh].mark(back, bits.data());
        for (std::uint32_t t = 0; t < clusters[mesh].triangle_count(); ++t) {
          if ((bits[t / 64] >> (t % 64) & 1U) == 0) continue;
          ++marked;
          EXPECT_EQ(facings[scene.first_triangle(object) + t], test::Facing::back);
        }
      }
    }
  }
  EXPECT_GT(marked, 1000U);
}

TEST(BackfaceClusters, FindMostBackFacesOfARoughMesh) {
  const Scene scene = scene_of(bumpy_sphere_mesh({60, Bumps::low, 0.0, glm::dvec3(0.0)}));
  for (const char* spec : {"backface.cluster", "backface.cluster_tree"}) {
    CullerRun run(spec, scene);
    for (const double distance : {2.0, 3.0, 1e5}) {
      Camera camera = camera_at(distance * glm::dvec3(0.6, 0.48, 0.64), {0.0, 0.0, 0.0});
      for (const bool orthographic : {false, true}) {
        if (orthographic) camera.lens = orthographic_lens(5.0, 1.0, 0.1, 1e6);
        const test::FacingCounts counts = counts_of(run, scene, camera);
        EXPECT_TRUE(counts.all_right());
        EXPECT_GT(counts.recall(), 0.85) << spec << " at distance " << distance;
      }
    }
  }
}

TEST(BackfaceClusters, KeepWhatTheEyeSeesEdgeOn) {
  const Scene scene = scene_of(divided_cube(8));
  for (const char* spec : {"backface.cluster", "backface.cluster_tree"}) {
    CullerRun run(spec, scene);
    // In the planes of one and of two sides, and a hair off.
    for (const glm::dvec3& eye : {glm::dvec3(1.0, 0.3, 5.0), glm::dvec3(1.0, -1.0, 5.0),
                                  glm::dvec3(std::nextafter(1.0, 0.0), 0.0, 1e5)}) {
      const test::FacingCounts counts = counts_of(run, scene, camera_at(eye, {0.0, 0.0, 0.0}));
      EXPECT_TRUE(counts.all_right()) << spec;
      EXPECT_GE(counts.recall(), 0.5) << spec;
    }
    const test::FacingCounts clear =
        counts_of(run, scene, camera_at({3.0, 4.0, 5.0}, {0.0, 0.0, 0.0}));
    EXPECT_TRUE(clear.all_right());
    EXPECT_GT(clear.recall(), 0.95) << spec;
  }
}

TEST(BackfaceClusters, FindTheSameInWhateverUnitAMeshIsGiven) {
  for (const char* spec : {"backface.cluster", "backface.cluster_tree",
                           "backface.cluster_tree[mixed=test]", "backface.cone"}) {
    const auto kept = [&](double unit) {
      Mesh mesh = bumpy(16);
      for (glm::vec3& position : mesh.positions) position *= static_cast<float>(unit);
      Scene scene;
      scene.meshes = {std::move(mesh)};
      scene.objects = {{0, glm::dmat4x3(1.0 / unit), none_id}};
      scene.finish();
      CullerRun run(spec, scene);
      std::vector<std::vector<TriangleRange>> all;
      for (const double distance : {2.0, 7.0, 1e6}) {
        Camera camera = camera_at(distance * glm::dvec3(0.6, 0.48, 0.64), {0.0, 0.0, 0.0});
        all.push_back(run.emitted(camera));
        camera.lens = orthographic_lens(5.0, 1.0, 0.1, 1e6);
        all.push_back(run.emitted(camera));
      }
      return all;
    };
    const auto expected = kept(1.0);
    EXPECT_GT(expected[0].size(), 1U) << spec;
    for (const double unit : {0x1p-100, 0x1p-20, 0x1p30, 0x1p125}) {
      EXPECT_TRUE(kept(unit) == expected) << spec << " in units of " << unit;
    }
  }
}

TEST(BackfaceClusters, FindNothingAboutTheOriginOfAMeshFarAway) {
  for (const char* name : {"backface.cluster", "backface.cluster_tree"}) {
    const auto recall = [&](const char* origin, double offset) {
      const Scene scene = [&] {
        Scene made = make_bumpy_sphere({24, Bumps::low, 0.0, glm::dvec3(offset, 0.0, 0.0)});
        made.finish();
        return made;
      }();
      CullerRun run(std::string(name) + "[size=64,origin=" + origin + "]", scene);
      const test::FacingCounts counts =
          counts_of(run, scene, camera_at({0.0, 1.0, 3.0}, {0.0, 0.0, 0.0}));
      EXPECT_TRUE(counts.all_right());
      return counts.recall();
    };
    EXPECT_GT(recall("mesh", 0.0), 0.85);
    EXPECT_LT(recall("mesh", 1000.0), 0.1);
    for (const char* origin : {"centre", "best"}) EXPECT_GT(recall(origin, 1000.0), 0.85);
  }
}

TEST(BackfaceClusters, WeighCostsAsMeasuredIfTold) {
  const Scene scene = scene_of(bumpy_sphere_mesh({24, Bumps::low, 0.0, glm::dvec3(0.0)}));
  CostTable costs = CostTable::typical();
  costs.cluster_test = Cost::exactly(100.0 * costs.triangle.ns);
  BuildContext context;
  context.costs = &costs;
  const auto tests = [&](const std::string& spec, const BuildContext& build) {
    CullerRun run(spec, scene, build);
    run.emitted(camera_at({0.0, 1.0, 3.0}, {0.0, 0.0, 0.0}));
    return run.counter("cluster_tests");
  };
  const std::uint64_t typical = tests("backface.cluster", {});
  EXPECT_EQ(tests("backface.cluster", context), typical);
  EXPECT_EQ(tests("backface.cluster[costs=measured]", {}), typical);
  EXPECT_LT(tests("backface.cluster[costs=measured]", context), typical / 4);
}

}  // namespace
}  // namespace vislab
