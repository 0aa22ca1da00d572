// Cones of normals: their geometry, the kernel against its scalar twin, backface.cone, and
// backface.hierarchical with and without what it remembers. That nothing but back faces goes is
// held to exact arithmetic in backface_exactness_test.cpp, with clusters of one triangle on its
// many small meshes and of tens on its few fine ones.
#include <gtest/gtest.h>

#include <set>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/cluster_cones.h"
#include "algorithms/backface/cone_tree.h"
#include "algorithms/backface/tree_memory.h"
#include "common/simd/simd_target.h"
#include "tests/algorithms/facing_worlds.h"

namespace vislab {
namespace {

using namespace backface_culling;
using test::vector_in;

glm::dvec3 direction(Random& random) {
  glm::dvec3 v;
  do {
    v = vector_in(random, 1.0);
  } while (glm::length(v) > 1.0 || glm::length(v) < 0.1);
  return glm::normalize(v);
}

/// Planes whose normals are within about `spread` of one direction, near the origin.
std::vector<glm::dvec4> planes_facing_alike(Random& random, std::size_t count, double spread) {
  const glm::dvec3 middle = direction(random);
  std::vector<glm::dvec4> planes;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 normal = glm::normalize(middle + vector_in(random, 1.0) * spread);
    planes.emplace_back(normal, random.uniform(-0.3, 0.3));
  }
  return planes;
}

double value(const glm::dvec4& plane, const glm::dvec3& point) {
  return glm::dot(glm::dvec3(plane), point) + plane.w;
}

TEST(SmallestCone, HoldsItsNormalsAndIsNoWiderThanAnyOtherConeAroundThem) {
  Random random(51);
  for (int i = 0; i < 300; ++i) {
    const auto planes = planes_facing_alike(random, 1 + random.below(12), random.uniform(0.0, 0.5));
    const NormalCone cone = smallest_cone(planes);
    ASSERT_TRUE(cone.exists());
    EXPECT_NEAR(glm::length(cone.axis), 1.0, 1e-12);
    for (const glm::dvec4& plane : planes) {
      EXPECT_LE(glm::length(glm::cross(cone.axis, glm::dvec3(plane))), cone.sine + 1e-12);
    }
    for (int other = 0; other < 60; ++other) {
      const glm::dvec3 turned =
          cone.axis + direction(random) * std::pow(10.0, -random.uniform(1.0, 7.0));
      EXPECT_GE(cone_around(turned, planes).sine, cone.sine - 1e-9);
    }
  }
}

TEST(SmallestCone, IsNoneForNormalsThatFitIntoNoNarrowCone) {
  const auto cone = [](std::vector<glm::dvec4> planes) { return smallest_cone(planes); };
  EXPECT_FALSE(cone({}).exists());
  EXPECT_FALSE(cone({{1, 0, 0, 0}, {-1, 0, 0, 0}}).exists());
  EXPECT_FALSE(cone({{1, 0, 0, 0}, {-0.6, 0.8, 0, 0}, {-0.6, -0.8, 0, 0}}).exists());
  const double narrow = std::cos(degrees(88.0));
  const double wide = std::sin(degrees(88.0));
  EXPECT_FALSE(cone({{narrow, wide, 0, 0}, {narrow, -wide, 0, 0}}).exists());
  EXPECT_DOUBLE_EQ(cone({{0, 1, 0, 3}}).sine, 0.0);
  EXPECT_DOUBLE_EQ(cone({{0, 1, 0, 3}, {0, 1, 0, -2}}).sine, 0.0);
  EXPECT_NEAR(cone({{0, 1, 0, 0}, {1, 0, 0, 0}}).sine, std::sqrt(0.5), 1e-12);
}

TEST(SmallestCone, OfTwoConesHoldsBoth) {
  Random random(52);
  for (int i = 0; i < 200; ++i) {
    auto planes = planes_facing_alike(random, 8, 0.2);
    const NormalCone a = smallest_cone(std::span(planes).first(3));
    const NormalCone b = smallest_cone(std::span(planes).last(5));
    const NormalCone both = cone_around(merged_axis(a, b), planes);
    ASSERT_TRUE(both.exists());
    EXPECT_GE(both.sine, smallest_cone(planes).sine - 1e-9);
    // No wider than the smallest cone around the two.
    const double between = std::acos(std::min(1.0, glm::dot(a.axis, b.axis)));
    const double most = std::max({std::asin(a.sine), std::asin(b.sine),
                                  0.5 * (between + std::asin(a.sine) + std::asin(b.sine))});
    EXPECT_LE(both.sine, std::sin(most) + 1e-9);
  }
}

TEST(Apex, IsBehindAllPlanesAndAsHighAsTheyAllow) {
  Random random(53);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const auto planes =
        planes_facing_alike(random, 3 + random.below(10), random.uniform(0.05, 0.5));
    const NormalCone cone = smallest_cone(planes);
    constexpr double spare = 1e-9;
    const glm::dvec3 back = apex_behind(planes, cone.axis, 1.0, spare);
    const glm::dvec3 front = apex_in_front(planes, cone.axis, 1.0, spare);
    double highest = -std::numeric_limits<double>::infinity();
    double highest_size = 0.0;
    for (const glm::dvec4& plane : planes) {
      EXPECT_LE(value(plane, back), -spare * (1.0 + glm::length(back)));
      EXPECT_GE(value(plane, front), spare * (1.0 + glm::length(front)));
    }
    // The highest corner of the region behind all planes, by trying all.
    for (std::size_t a = 0; a < planes.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        for (std::size_t c = 0; c < b; ++c) {
          const glm::dmat3 normals(planes[a], planes[b], planes[c]);
          if (std::abs(glm::determinant(normals)) < 1e-6) continue;
          const glm::dvec3 corner = glm::inverse(glm::transpose(normals)) *
                                    -glm::dvec3(planes[a].w, planes[b].w, planes[c].w);
          const bool behind = std::ranges::all_of(
              planes, [&](const glm::dvec4& plane) { return value(plane, corner) < 1e-9; });
          if (behind && glm::dot(cone.axis, corner) > highest) {
            highest = glm::dot(cone.axis, corner);
            highest_size = glm::length(corner);
          }
        }
      }
    }
    if (highest_size < 0.9 && std::isfinite(highest)) {
      EXPECT_NEAR(glm::dot(cone.axis, back), highest, 1e-6);
      ++met;
    }
  }
  EXPECT_GT(met, 100);
}

Mesh bumpy(std::uint32_t subdivisions, Bumps bumps) {
  BumpySphereParameters parameters;
  parameters.subdivisions = subdivisions;
  parameters.bumps = bumps;
  return bumpy_sphere_mesh(parameters);
}

Scene scene_of(Mesh mesh, const std::vector<glm::dmat4x3>& transforms = {glm::dmat4x3(1.0)}) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  for (const glm::dmat4x3& transform : transforms) scene.objects.push_back({0, transform, none_id});
  scene.finish();
  return scene;
}

ClusterCones cones_of(const Scene& scene, std::uint32_t size, ConeForm form) {
  const Mesh& mesh = scene.meshes[0];
  const MeshFrame frame(mesh);
  return backface_culling::cones_of(mesh, frame, make_clusters(mesh, frame, cone_clusters(size)),
                                    form);
}

TEST(ClusterCones, GiveTheSameBitsOnEveryInstructionSetAsOneByOne) {
  Random random(54);
  const Scene scene = scene_of(bumpy(9, Bumps::high));
  for (const ConeForm form : {ConeForm::apex, ConeForm::sphere}) {
    for (const std::uint32_t size : {1U, 5U, 32U}) {
      const ClusterCones cones = cones_of(scene, size, form);
      std::vector<std::uint64_t> expected(words_of(cones.count()));
      std::vector<std::uint64_t> found(expected.size());
      for (int i = 0; i < 60; ++i) {
        MeshEye eye;
        const double far = std::pow(10.0, i < 50 ? random.uniform(-1.0, 8.0) : 20.0 + 20.0 * i);
        eye.position = glm::dvec4(direction(random) * far, i % 3 == 0 ? 0.0 : 1.0);
        eye.error = 1e-15 * far;
        const ConeEye test(eye, cones.unit());
        mark_cones_scalar(cones, test, expected.data());
        for (const std::string& target : simd_targets()) {
          const SimdTargetScope scope(target);
          mark_cones(cones, test, found.data());
          EXPECT_EQ(found, expected) << target << ", eye " << i;
        }
      }
    }
  }
}

TEST(ClusterCones, TellNothingBeforeEyesThatFloatCannotHold) {
  const Scene scene = scene_of(bumpy(6, Bumps::none));
  const ClusterCones cones = cones_of(scene, 8, ConeForm::apex);
  std::vector<std::uint64_t> found(words_of(cones.count()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const glm::dvec4& position :
       {glm::dvec4(1e25, 0.0, 0.0, 1.0), glm::dvec4(infinite, 0.0, 0.0, 1.0),
        glm::dvec4(nan, 0.0, 3.0, 1.0), glm::dvec4(0.0, 3.0, nan, 1.0), glm::dvec4(0.0)}) {
    MeshEye eye;
    eye.position = position;
    mark_cones(cones, ConeEye(eye, cones.unit()), found.data());
    for (const std::uint64_t word : found) EXPECT_EQ(word, 0U);
  }
}

/// Triangles of the one object of a scene that are kept.
std::vector<bool> kept_of(CullerRun& run, const Scene& scene, const Camera& camera) {
  std::vector<bool> kept(scene.triangle_count());
  for (const TriangleRange& range : run.emitted(camera)) {
    for (std::uint32_t i = 0; i < range.count; ++i) {
      kept[scene.first_triangle(range.object) + range.first + i] = true;
    }
  }
  return kept;
}

std::size_t count_of(const std::vector<bool>& kept) {
  return static_cast<std::size_t>(std::ranges::count(kept, true));
}

/// The share of the back faces of a scene's one mesh that a culler leaves out, over 16 eyes;
/// expects that nothing else is left out, to the rounding of double.
double share_of_back_faces(const std::string& spec, const Scene& scene, double distance = 3.0) {
  const Mesh& mesh = scene.meshes[0];
  const MeshFrame frame(mesh);
  CullerRun run(spec, scene);
  Random random(55);
  std::size_t all = 0;
  std::size_t found = 0;
  for (int i = 0; i < 16; ++i) {
    const Camera camera = camera_at(direction(random) * distance, glm::dvec3(0.0));
    const std::vector<bool> kept = kept_of(run, scene, camera);
    for (std::uint32_t t = 0; t < kept.size(); ++t) {
      const bool back = value(unit_plane(mesh, frame, t), camera.pose.eye - frame.middle) < 0.0;
      EXPECT_TRUE(kept[t] || back) << spec << " leaves out what is no back face";
      all += back ? 1 : 0;
      found += kept[t] ? 0 : 1;
    }
  }
  return static_cast<double>(found) / static_cast<double>(all);
}

TEST(BackfaceCone, FindsMostBackFacesWhereTheSurfaceIsSmooth) {
  const Scene smooth = scene_of(bumpy(40, Bumps::none));
  EXPECT_GT(share_of_back_faces("backface.cone", smooth), 0.9);
  EXPECT_GT(share_of_back_faces("backface.cone[form=sphere]", smooth), 0.85);
  EXPECT_GT(share_of_back_faces("backface.hierarchical", smooth), 0.9);
  const Scene high = scene_of(bumpy(40, Bumps::high));
  EXPECT_GT(share_of_back_faces("backface.cone[size=16]", high), 0.7);
}

TEST(BackfaceCone, FindsLessTheMoreTrianglesAConeHolds) {
  // The failure that the sources report: a cone around normals that spread holds no eye.
  const Scene coarse = scene_of(bumpy(40, Bumps::high));
  double before = 1.1;
  for (const char* size : {"1", "4", "16", "64", "256"}) {
    const double share =
        share_of_back_faces(std::string("backface.cone[size=") + size + "]", coarse);
    EXPECT_LT(share, before) << size;
    before = share;
  }
  EXPECT_LT(before, 0.9);
}

TEST(BackfaceCone, ASphereTellsLessThanAnApexWhereClustersAreWide) {
  const Scene scene = scene_of(bumpy(40, Bumps::low));
  const double apex = share_of_back_faces("backface.cone", scene, 1.4);
  EXPECT_GT(apex, share_of_back_faces("backface.cone[form=sphere]", scene, 1.4) + 0.02);
}

TEST(BackfaceCone, KeepsWhatIsSeenExactlyEdgeOn) {
  const Scene scene = scene_of(cube_mesh());
  for (const char* spec : {"backface.cone[size=2]", "backface.cone[size=1]",
                           "backface.hierarchical[size=2]", "backface.hierarchical[size=1]"}) {
    CullerRun run(spec, scene);
    const Camera beside = camera_at({1.0, 0.0, 5.0}, {0.0, 0.0, 0.0});  // in the plane of +x
    const std::vector<bool> kept = kept_of(run, scene, beside);
    // Sides in the mesh: -x, +x, -y, +y, -z, +z, two triangles each.
    EXPECT_EQ(count_of(kept), 4U) << spec;
    EXPECT_TRUE(kept[2] && kept[3] && kept[10] && kept[11]) << spec;
  }
}

/// Ways of a camera: slow, fast, standing, jumping, and from one kind of camera to the other.
std::vector<Camera> cameras_of(const std::string& way) {
  Random random(56);
  std::vector<Camera> cameras;
  for (int i = 0; i < 60; ++i) {
    const double turn = 0.02 * i;
    Camera camera = camera_at({4.0 * std::sin(turn), 0.7, 4.0 * std::cos(turn)}, glm::dvec3(0.0));
    if (way == "walk") camera = camera_at({-6.0 + 0.2 * i, 0.3, 1.9}, {20.0, 0.0, -9.0});
    if (way == "cut") camera = camera_at(direction(random) * random.uniform(1.9, 40.0), {});
    if (way == "stop_and_go" && i % 6 != 0) camera = cameras.back();
    if (way == "tremble") {
      camera = camera_at(glm::dvec3(2.0, 1.0, 3.0) + vector_in(random, 1e-9), glm::dvec3(0.0));
    }
    if (way == "orthographic" || (way == "switch" && i / 7 % 2 == 0)) {
      camera.lens = orthographic_lens(4.0, 1.0, 0.1, 100.0);
    }
    cameras.push_back(camera);
  }
  return cameras;
}

class Coherence : public testing::TestWithParam<const char*> {};

TEST_P(Coherence, ChangesNoAnswerAndAccountsForEveryNode) {
  const glm::dmat4x3 sheared(glm::dvec3(0.5, 0.1, 0.0), glm::dvec3(0.2, -0.4, 0.1),
                             glm::dvec3(0.0, 0.3, 0.5), glm::dvec3(2.5, 0.0, -1.0));
  const Scene scene =
      scene_of(bumpy(20, Bumps::low), {placed(glm::dvec3(0.0)), sheared, placed({0.0, -4.0, 0.0})});
  CullerRun on("backface.hierarchical[size=8]", scene);
  CullerRun off("backface.hierarchical[size=8,coherence=off]", scene);
  std::uint64_t first_pass = 0;
  for (int pass = 0; pass < 2; ++pass) {
    const std::uint64_t before = on.counter("nodes_tested");
    std::uint64_t frame = 0;
    for (const Camera& camera : cameras_of(GetParam())) {
      Changes changes;  // the second object turns by itself, now and then
      if (frame % 5 == 2) {
        changes.moved = {1};
        const double angle = 0.03 * static_cast<double>(frame);
        changes.transforms = {sheared};
        changes.transforms[0][0] *= std::cos(angle);
        changes.transforms[0][3].y += angle;
      }
      on.update(camera, changes);
      off.update(camera, changes);
      EXPECT_EQ(on.emitted(camera), off.emitted(camera)) << GetParam() << ", frame " << frame;
      EXPECT_EQ(on.counter("nodes_tested") + on.counter("nodes_reused"),
                off.counter("nodes_tested"));
      ++frame;
    }
    if (pass == 0) first_pass = on.counter("nodes_tested");
    if (pass == 1) {
      EXPECT_EQ(on.counter("nodes_tested") - before, first_pass) << "reset did not forget all";
    }
    on.reset();
    off.reset();
  }
  std::cout << GetParam() << ": " << on.counter("nodes_tested") << " nodes tested, "
            << on.counter("nodes_reused") << " reused\n";
}

INSTANTIATE_TEST_SUITE_P(Ways, Coherence,
                         testing::Values("orbit", "walk", "cut", "stop_and_go", "tremble",
                                         "orthographic", "switch"),
                         [](const auto& way) { return std::string(way.param); });

TEST(BackfaceHierarchical, TestsNothingWhileTheEyeStandsAndLittleWhileItGoesSlowly) {
  const Scene scene = scene_of(bumpy(32, Bumps::none));
  CullerRun run("backface.hierarchical", scene);
  const auto tested = [&](const glm::dvec3& eye) {
    const std::uint64_t before = run.counter("nodes_tested");
    run.emitted(camera_at(eye, glm::dvec3(0.0)));
    return run.counter("nodes_tested") - before;
  };
  const std::uint64_t all = tested({0.0, 0.0, 3.0});
  EXPECT_GT(all, 50U);
  EXPECT_EQ(tested({0.0, 0.0, 3.0}), 0U);
  std::uint64_t slowly = 0;
  for (int i = 1; i <= 20; ++i) slowly += tested({0.001 * i, 0.0, 3.0});
  EXPECT_LT(slowly, 20 * all / 10);
  EXPECT_GT(tested({0.0, 0.0, -3.0}), all / 2);  // from the other side everything has changed
}

TEST(BackfaceHierarchical, AnswersInBatchesAsInOne) {
  const Scene scene =
      scene_of(bumpy(12, Bumps::low), {placed({0.0, 0.0, 0.0}), placed({3.0, 0.0, 0.0})});
  CullerRun run("backface.hierarchical[size=4]", scene);
  CullerRun whole("backface.hierarchical[size=4,coherence=off]", scene);
  RecordingSink sink;
  for (int i = 0; i < 30; ++i) {
    const Camera camera = camera_at({5.0 * std::sin(0.1 * i), 1.0, 5.0 * std::cos(0.1 * i)}, {});
    const std::vector<bool> expected = kept_of(whole, scene, camera);
    std::vector<bool> kept(scene.triangle_count());
    const Frame frame = whole.frame(camera);
    // Of every second frame the second object is not offered at all.
    for (ObjectId object = 0; object < (i % 2 == 0 ? 1U : 2U); ++object) {
      for (std::uint32_t first = 0; first < 1728; first += 432) {
        const std::vector<TriangleRange> part{{object, first, 432}};
        const std::span<const TriangleRange> span(part);
        sink.start(scene, frame);
        run.culler().cull(frame, Candidates::of(std::span(&span, 1)), sink);
        for (const TriangleRange& range : sink.emitted()) {
          for (std::uint32_t t = 0; t < range.count; ++t) {
            kept[scene.first_triangle(object) + range.first + t] = true;
          }
        }
      }
    }
    const std::size_t judged = i % 2 == 0 ? 1728 : 2 * 1728;
    for (std::size_t t = 0; t < judged; ++t) EXPECT_EQ(kept[t], expected[t]) << t;
  }
}

TEST(ConeTree, VerdictsHoldAsLongAsTheirSlackSays) {
  Random random(57);
  std::size_t of_each[3] = {};
  for (const Bumps bumps : {Bumps::none, Bumps::high}) {
    const Scene scene = scene_of(bumpy(10, bumps));
    ClusterSettings settings;
    settings.size = 6;
    const ConeTree tree(scene.meshes[0], MeshFrame(scene.meshes[0]), settings);
    for (int i = 0; i < 200'000; ++i) {
      const ConeTree::Node& node = tree.nodes()[random.below(tree.nodes().size())];
      if (!node.cone.exists()) continue;
      MeshEye eye;
      const bool perspective = i % 4 != 0;
      glm::dvec3 position = direction(random) * (perspective ? random.uniform(1.0, 6.0) : 1.0);
      eye.position = glm::dvec4(position, perspective ? 1.0 : 0.0);
      eye.error = std::pow(10.0, random.uniform(-17.0, -6.0));
      const TreeEye from(eye);
      const ConeTree::Verdict verdict = ConeTree::verdict(node, from);
      ++of_each[static_cast<std::size_t>(verdict.facing)];
      // The ways on which depths change most: along the axis, to an apex, and any other.
      glm::dvec3 way = direction(random);
      const glm::dvec3 to_back = glm::normalize(node.back_apex - position);
      const glm::dvec3 to_front = glm::normalize(node.front_apex - position);
      if (i % 3 == 0) way = glm::normalize(node.cone.axis - node.cone.sine * to_back);
      if (i % 3 == 1) way = glm::normalize(node.cone.axis + node.cone.sine * to_front);
      if (i % 2 == 0) way = -way;
      position += way * (verdict.slack * random.uniform(0.9, 1.0));
      eye.position = glm::dvec4(position, perspective ? 1.0 : 0.0);
      eye.error *= random.uniform(0.5, 1.5);
      const TreeEye to(eye);
      if (!(from.way_to(to) < verdict.slack)) continue;
      EXPECT_EQ(ConeTree::verdict(node, to).facing, verdict.facing) << i;
    }
  }
  using Facing = ConeTree::Facing;
  for (const Facing facing : {Facing::back, Facing::front, Facing::mixed}) {
    EXPECT_GT(of_each[static_cast<std::size_t>(facing)], 1000U);
  }
}

TEST(ConeTree, VerdictsRunOutWhereTheyAreWorthIt) {
  // Straight up the axis the depth changes by 1 - sine times the way, at least: no slack is longer
  // than what is missing divided by that, or it would hold too long.
  const Scene scene = scene_of(bumpy(10, Bumps::none));
  ClusterSettings settings;
  settings.size = 6;
  const ConeTree tree(scene.meshes[0], MeshFrame(scene.meshes[0]), settings);
  Random random(58);
  int changed = 0;
  for (int i = 0; i < 20'000; ++i) {
    const ConeTree::Node& node = tree.nodes()[random.below(tree.nodes().size())];
    MeshEye eye;
    glm::dvec3 position = direction(random) * random.uniform(1.0, 3.0);
    eye.position = glm::dvec4(position, 1.0);
    const ConeTree::Verdict verdict = ConeTree::verdict(node, TreeEye(eye));
    if (!node.cone.exists() || verdict.facing != ConeTree::Facing::back) continue;
    const double worst = (1.0 + node.cone.sine) / (1.0 - node.cone.sine);
    position += node.cone.axis * (1.001 * worst * verdict.slack + 1e-9);
    eye.position = glm::dvec4(position, 1.0);
    EXPECT_NE(ConeTree::verdict(node, TreeEye(eye)).facing, ConeTree::Facing::back);
    ++changed;
  }
  EXPECT_GT(changed, 1000);
}

TEST(TreeMemory, OfAMeshWithoutAnyTestedTriangleMarksNothing) {
  Mesh mesh;
  mesh.positions = {glm::vec3(0.0F), glm::vec3(1.0F), glm::vec3(2.0F)};  // on a line
  mesh.triangles = {{0, 1, 2}};
  mesh.bounds = {mesh.positions[0], mesh.positions[2]};
  const ConeTree tree(mesh, MeshFrame(mesh), ClusterSettings());
  TreeMemory memory(tree);
  WalkCounts counts;
  MeshEye eye;
  eye.position = {0.0, 0.0, 9.0, 1.0};
  for (const std::uint64_t word : memory.mark(tree, TreeEye(eye), counts)) EXPECT_EQ(word, 0U);
  EXPECT_EQ(counts.tested + counts.reused, 0U);
}

}  // namespace
}  // namespace vislab
