// frustum.polygon and frustum.mesh_octree, which decide about triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "algorithms/frustum/triangle_octree.h"
#include "common/geometry/frustum.h"
#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

using frustum_culling::TriangleOctree;

/// A wavy sheet of 2 * steps^2 triangles, one unit a step.
Mesh sheet(std::uint32_t steps) {
  Mesh mesh;
  for (std::uint32_t z = 0; z <= steps; ++z) {
    for (std::uint32_t x = 0; x <= steps; ++x) {
      mesh.positions.emplace_back(x, std::sin(0.7F * static_cast<float>(x + 2 * z)), z);
    }
  }
  for (std::uint32_t z = 0; z < steps; ++z) {
    for (std::uint32_t x = 0; x < steps; ++x) {
      const std::uint32_t a = z * (steps + 1) + x;
      mesh.triangles.emplace_back(a, a + steps + 1, a + 1);
      mesh.triangles.emplace_back(a + 1, a + steps + 1, a + steps + 2);
    }
  }
  return mesh;
}

Scene sheets() {
  Scene scene;
  scene.meshes = {sheet(40)};
  glm::dmat4x3 sheared = placed({-60.0, -3.0, 5.0}, {-1.0, 2.0, 0.5});  // mirrored too
  sheared[1][0] = 0.4;
  scene.objects = {{0, placed({-20.0, -2.0, -20.0}), none_id},
                   {0, sheared, none_id},
                   {0, placed({500.0, 0.0, 0.0}), none_id}};
  scene.finish();
  return scene;
}

std::vector<Camera> cameras() {
  std::vector<Camera> all;
  Random random(31);
  for (int i = 0; i < 12; ++i) {
    Camera camera = camera_at({random.uniform(-20.0, 20.0), 3.0, random.uniform(-20.0, 20.0)},
                              {random.uniform(-30.0, 30.0), 0.0, random.uniform(-30.0, 30.0)});
    if (i % 3 == 1) camera.lens = orthographic_lens(12.0, 1.5, 0.5, 40.0);
    if (i % 3 == 2) camera.lens.far_m = std::numeric_limits<double>::infinity();
    all.push_back(camera);
  }
  return all;
}

/// Where a triangle lies to the frustum, by its vertices in the world, `margin` metres aside.
bool excluded(const Frustum& frustum, const std::array<glm::dvec3, 3>& triangle, double margin) {
  return std::ranges::any_of(frustum.span(), [&](const Plane& plane) {
    return std::ranges::all_of(
        triangle, [&](const glm::dvec3& p) { return plane.signed_distance(p) < -margin; });
  });
}

std::vector<std::uint8_t> kept_triangles(CullerRun& run, const Camera& camera, const Scene& scene) {
  std::vector<std::uint8_t> kept(scene.triangle_count(), 0);
  for (const TriangleRange& range : run.emitted(camera)) {
    for (std::uint32_t i = 0; i < range.count; ++i) {
      ++kept[scene.first_triangle(range.object) + range.first + i];
    }
  }
  return kept;
}

TEST(FrustumPolygon, KeepsExactlyTheTrianglesThatNoPlaneExcludes) {
  const Scene scene = sheets();
  CullerRun run("frustum.polygon", scene);
  for (const Camera& camera : cameras()) {
    const Frame frame = run.frame(camera);
    const Frustum frustum = frustum_of(camera);
    const std::vector<std::uint8_t> kept = kept_triangles(run, camera, scene);
    std::size_t count = 0;
    for (TriangleId id = 0; id < scene.triangle_count(); ++id) {
      const ObjectId object = scene.object_of(id);
      const auto triangle = world_triangle(scene.mesh_of(object), frame.objects.transforms[object],
                                           id - scene.first_triangle(object));
      if (excluded(frustum, triangle, 1e-9)) {
        EXPECT_EQ(kept[id], 0) << id;
      } else if (!excluded(frustum, triangle, 0.0)) {
        EXPECT_EQ(kept[id], 1) << id;
      }
      count += kept[id];
    }
    EXPECT_GT(count, 0U);
    EXPECT_LT(count, scene.triangle_count());
  }
}

TEST(FrustumMeshOctree, KeepsWhatNoPlaneExcludesAndLittleMore) {
  const Scene scene = sheets();
  CullerRun polygon("frustum.polygon", scene);
  CullerRun objects("frustum.flat", scene);
  for (const char* spec :
       {"frustum.mesh_octree", "frustum.mesh_octree[depth=0]",
        "frustum.mesh_octree[depth=12,leaf_size=1]", "frustum.mesh_octree[depth=2,leaf_size=16]"}) {
    CullerRun run(spec, scene);
    std::size_t needed = 0;
    std::size_t kept = 0;
    std::size_t whole = 0;
    for (const Camera& camera : cameras()) {
      const std::vector<std::uint8_t> inside = kept_triangles(polygon, camera, scene);
      const std::vector<std::uint8_t> ours = kept_triangles(run, camera, scene);
      const std::vector<std::uint8_t> all = kept_triangles(objects, camera, scene);
      for (TriangleId id = 0; id < scene.triangle_count(); ++id) {
        ASSERT_GE(ours[id], inside[id]) << spec << ", triangle " << id;
        ASSERT_LE(ours[id], 1) << spec << ", triangle " << id;
        needed += inside[id];
        kept += ours[id];
        whole += all[id];
      }
    }
    if (std::string(spec).find("depth=0") != std::string::npos) {
      EXPECT_LE(kept, whole);
    } else {
      EXPECT_LT(kept - needed, (whole - needed) / 2) << spec;
    }
  }
}

TEST(FrustumMeshOctree, KeepsAPartOfWhatItIsOffered) {
  const Scene scene = sheets();
  CullerRun run("frustum.mesh_octree[leaf_size=4]", scene);
  const std::vector<TriangleRange> offered = {{0, 3, 500}, {0, 600, 1}, {0, 602, 900}, {1, 0, 7}};
  const std::span<const TriangleRange> span(offered);
  for (const Camera& camera : cameras()) {
    const std::vector<std::uint8_t> all = kept_triangles(run, camera, scene);
    std::vector<std::uint8_t> expected(scene.triangle_count(), 0);
    for (const TriangleRange& range : offered) {
      for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
        const TriangleId id = scene.first_triangle(range.object) + i;
        expected[id] = all[id];
      }
    }
    std::vector<std::uint8_t> kept(scene.triangle_count(), 0);
    for (const TriangleRange& range : run.emitted(camera, Candidates::of({&span, 1}))) {
      for (std::uint32_t i = 0; i < range.count; ++i) {
        ++kept[scene.first_triangle(range.object) + range.first + i];
      }
    }
    EXPECT_EQ(kept, expected);
  }
}

TEST(TriangleOctree, HoldsEveryTriangleOnceBelowNodesWhoseBoxesHoldIt) {
  Mesh mesh = sheet(20);
  mesh.triangles.emplace_back(5, 5, 5);  // no area
  mesh.bounds = bounds_of(mesh.positions);
  for (const int depth : {0, 1, 5, 12}) {
    const TriangleOctree tree(mesh, depth, 3);
    std::vector<int> seen(mesh.triangles.size(), 0);
    for (const TriangleOctree::Node& node : tree.nodes()) {
      for (const TriangleOctree::Run& run : tree.runs_below(node)) {
        for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
          if (node.child_count == 0) ++seen[i];
          for (int corner = 0; corner < 3; ++corner) {
            EXPECT_TRUE(node.box.contains(mesh.positions[mesh.triangles[i][corner]]));
          }
        }
      }
    }
    EXPECT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(seen.size())) << depth;
  }
}

TEST(TriangleOctree, EndsWhereAllTrianglesAreAtOnePoint) {
  Mesh mesh;
  mesh.positions = {{1.0F, 2.0F, 3.0F}};
  mesh.triangles.assign(100, {0, 0, 0});
  mesh.bounds = bounds_of(mesh.positions);
  const TriangleOctree tree(mesh, 12, 1);
  EXPECT_EQ(tree.nodes().size(), 13U);
  EXPECT_EQ(tree.runs_below(tree.nodes()[0]).size(), 1U);
}

}  // namespace
}  // namespace vislab
