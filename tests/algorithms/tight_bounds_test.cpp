#include "algorithms/occlusion/tight_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/random.h"
#include "common/spatial/bvh.h"
#include "experiments/contract/small_scenes.h"

namespace vislab::occlusion_culling {
namespace {

double surface_of(std::span<const Aabb> boxes) {
  double sum = 0.0;
  for (const Aabb& box : boxes) sum += half_area(box);
  return sum;
}

double volume_of(std::span<const Aabb> boxes) {
  double sum = 0.0;
  for (const Aabb& box : boxes) {
    const glm::dvec3 size = box.half_size() * 2.0;
    sum += size.x * size.y * size.z;
  }
  return sum;
}

/// Is the point in a box, or nearer to it than the rounding of the point's own computation?
bool held(std::span<const Aabb> boxes, const glm::dvec3& p) {
  const double reach = 1e-13 * (1.0 + absolute_sum(p));
  return std::ranges::any_of(
      boxes, [&](const Aabb& box) { return distance_squared(box, p) <= reach * reach; });
}

/// Points on all triangles of an object: corners, sides and inside.
void expect_held(const Scene& scene, ObjectId object, const ObjectsView& objects,
                 std::span<const Aabb> boxes) {
  constexpr int steps = 12;
  const Mesh& mesh = scene.mesh_of(object);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const auto corners = world_triangle(mesh, objects.transforms[object], triangle);
    for (int a = 0; a <= steps; ++a) {
      for (int b = 0; a + b <= steps; ++b) {
        const glm::dvec3 p =
            (corners[0] * static_cast<double>(a) + corners[1] * static_cast<double>(b) +
             corners[2] * static_cast<double>(steps - a - b)) /
            static_cast<double>(steps);
        ASSERT_TRUE(held(boxes, p)) << "object " << object << ", triangle " << triangle;
      }
    }
  }
}

Mesh random_mesh(Random& random, std::uint32_t triangles, float size) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::vec3 middle(random.uniform(-3.0, 3.0), random.uniform(-1.0, 1.0),
                           random.uniform(-3.0, 3.0));
    for (int corner = 0; corner < 3; ++corner) {
      mesh.positions.push_back(middle + glm::vec3(random.uniform(-size, size),
                                                  random.uniform(-size, size),
                                                  random.uniform(-size, size)));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

glm::dmat4x3 random_transform(Random& random) {
  glm::dmat4x3 transform(1.0);
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      transform[column][row] += random.uniform(-1.0, 1.0) * (column == 3 ? 100.0 : 0.9);
    }
  }
  return transform;
}

TEST(TightBounds, HoldEveryPointOfEveryTriangleWithinTheSurfaceThatIsAllowed) {
  Random random(3);
  Scene scene;
  for (const std::uint32_t triangles : {1U, 2U, 7U, 60U}) {
    for (const float size : {0.05F, 1.0F, 6.0F}) {
      scene.meshes.push_back(random_mesh(random, triangles, size));
      const auto mesh = static_cast<MeshId>(scene.meshes.size() - 1);
      scene.objects.push_back({mesh, glm::dmat4x3(1.0), none_id});
      for (int i = 0; i < 2; ++i)
        scene.objects.push_back({mesh, random_transform(random), none_id});
    }
  }
  scene.finish();
  const SceneState state(scene);
  std::uint32_t divided = 0;
  for (const TightBounds::Limits limits :
       {TightBounds::Limits{1.4, 16}, TightBounds::Limits{3.0, 32}, TightBounds::Limits{1.0, 2},
        TightBounds::Limits{1.4, 16, true}}) {
    TightBounds bounds;
    bounds.build(scene, limits);
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      std::vector<Aabb> boxes;
      const std::uint32_t count = bounds.append(object, state.view(), boxes);
      ASSERT_EQ(count, boxes.size());
      ASSERT_GE(count, 1U);
      EXPECT_LE(count, limits.max_boxes);
      EXPECT_LE(surface_of(boxes),
                limits.sigma * half_area(state.view().bounds[object]) * (1.0 + 1e-12));
      for (const Aabb& box : boxes) {
        EXPECT_TRUE(box.valid());
        EXPECT_TRUE(state.view().bounds[object].contains(box));
      }
      expect_held(scene, object, state.view(), boxes);
      if (count > 1) ++divided;
    }
  }
  EXPECT_GT(divided, 20U);
}

/// A beam along x, with 12 triangles that are as long as it is.
Mesh beam() {
  Mesh mesh = cube_mesh();
  for (glm::vec3& p : mesh.positions) p *= glm::vec3(10.0F, 0.5F, 0.5F);
  return mesh;
}

TEST(TightBounds, ATurnedBeamHasAlongItsLengthWhatItsOneBoxHasAllAround) {
  const double half = std::sqrt(0.5);
  Scene scene;
  scene.meshes = {beam()};
  glm::dmat4x3 turned(1.0);
  turned[0] = {half, half, 0.0};
  turned[1] = {-half, half, 0.0};
  scene.objects = {{0, glm::dmat4x3(1.0), none_id}, {0, turned, none_id}};
  scene.finish();
  const SceneState state(scene);
  TightBounds bounds;
  bounds.build(scene, {});
  std::vector<Aabb> boxes;
  EXPECT_EQ(bounds.append(0, state.view(), boxes), 1U);
  EXPECT_EQ(boxes[0], state.view().bounds[0]);
  boxes.clear();
  EXPECT_GT(bounds.append(1, state.view(), boxes), 3U);
  EXPECT_LT(volume_of(boxes), 0.35 * volume_of({&state.view().bounds[1], 1}));
  // More boxes overlap more and gain too little for each, unless the finest division is wanted.
  bounds.build(scene, {1.4, 32});
  std::vector<Aabb> cheapest;
  EXPECT_LT(bounds.append(1, state.view(), cheapest), 16U);
  bounds.build(scene, {1.4, 32, true});
  std::vector<Aabb> finest;
  EXPECT_EQ(bounds.append(1, state.view(), finest), 32U);
  // A smaller surface is allowed: fewer boxes, or none but the one.
  bounds.build(scene, {1.0, 16});
  std::vector<Aabb> fewer;
  bounds.append(1, state.view(), fewer);
  EXPECT_LE(surface_of(fewer), half_area(state.view().bounds[1]));
}

TEST(TightBounds, WhatFillsItsBoxKeepsItAndSoDoesWhatHasNoExtentOrNoValidBox) {
  Scene scene;
  Mesh point = cube_mesh();
  for (glm::vec3& p : point.positions) p = {1.0F, 2.0F, 3.0F};
  Mesh line = cube_mesh();
  for (glm::vec3& p : line.positions) p.y = p.z = 0.0F;
  scene.meshes = {cube_mesh(), point, line};
  for (MeshId mesh = 0; mesh < 3; ++mesh) {
    scene.objects.push_back({mesh, glm::dmat4x3(1.0), none_id});
  }
  scene.finish();
  const SceneState state(scene);
  TightBounds bounds;
  bounds.build(scene, {});
  for (ObjectId object = 0; object < 3; ++object) {
    std::vector<Aabb> boxes;
    EXPECT_EQ(bounds.append(object, state.view(), boxes), 1U) << object;
    EXPECT_EQ(boxes[0], state.view().bounds[object]);
  }
  ObjectsView broken = state.view();
  std::vector<Aabb> bad(broken.bounds.begin(), broken.bounds.end());
  bad[0].max.x = std::numeric_limits<float>::quiet_NaN();
  broken.bounds = bad;
  std::vector<Aabb> boxes;
  EXPECT_EQ(bounds.append(0, broken, boxes), 1U);
  EXPECT_FALSE(boxes[0].valid());
}

TEST(TightBounds, ANodeIsBoundedByItsChildrenItsObjectsAndTheirParts) {
  Random random(11);
  Scene scene;
  scene.meshes = {cube_mesh(), random_mesh(random, 20, 0.4F)};
  for (int i = 0; i < 40; ++i) {
    glm::dmat4x3 transform = random_transform(random);
    transform[3] = {random.uniform(-60.0, 60.0), 0.0, random.uniform(-60.0, 60.0)};
    scene.objects.push_back({static_cast<MeshId>(i % 2), transform, none_id});
  }
  scene.finish();
  const SceneState state(scene);
  Bvh tree({Bvh::Build::top_down, Bvh::Motion::refit, 3});
  tree.build(state.view().bounds);
  TightBounds bounds;
  bounds.build(scene, {1.4, 16});
  std::vector<Aabb> boxes;
  std::uint32_t divided = 0;
  for (SpatialStructure::NodeIndex node = 0; node < tree.nodes().size(); ++node) {
    if (tree.objects_below(node).empty()) continue;
    boxes.clear();
    const std::uint32_t count = bounds.append(tree, node, state.view(), 16, boxes);
    ASSERT_EQ(count, boxes.size());
    EXPECT_LE(count, 16U);
    std::vector<Aabb> few;
    EXPECT_LE(bounds.append(tree, node, state.view(), 3, few), 3U);
    for (const ObjectId object : tree.objects_below(node)) {
      expect_held(scene, object, state.view(), few);
    }
    if (count > 1) ++divided;
    EXPECT_LE(surface_of(boxes), 1.4 * half_area(tree.nodes()[node].box) * (1.0 + 1e-12));
    for (const ObjectId object : tree.objects_below(node)) {
      expect_held(scene, object, state.view(), boxes);
    }
  }
  EXPECT_GT(divided, 10U);
  // Once the list is long enough, nothing is allocated for it.
  boxes.clear();
  const Aabb* const before = boxes.data();
  bounds.append(tree, SpatialStructure::root, state.view(), 16, boxes);
  EXPECT_EQ(boxes.data(), before);
}

}  // namespace
}  // namespace vislab::occlusion_culling
