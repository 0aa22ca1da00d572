#include "common/spatial/query_hierarchy.h"

#include <gtest/gtest.h>

#include <set>

#include "common/geometry/random.h"

namespace vislab {
namespace {

/// Tetrahedra here and there.
Scene scattered(std::size_t count) {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  scene.meshes = {mesh};
  Random random(1);
  for (std::size_t i = 0; i < count; ++i) {
    glm::dmat4x3 place(1.0);
    place[3] = {random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0),
                random.uniform(-50.0, 50.0)};
    scene.objects.push_back({0, place, none_id});
  }
  scene.finish();
  return scene;
}

/// Every object that is shown is in exactly one unit that a walk from the root ends at; units are
/// the first nodes that are small enough, and links agree with the tree.
void expect_sound(const QueryHierarchy& hierarchy, const std::set<ObjectId>& shown) {
  std::set<ObjectId> found;
  std::vector<QueryHierarchy::NodeIndex> stack = {SpatialStructure::root};
  while (!stack.empty()) {
    const QueryHierarchy::NodeIndex index = stack.back();
    stack.pop_back();
    const SpatialNode& node = hierarchy.node(index);
    EXPECT_EQ(hierarchy.triangles(index), 4 * hierarchy.objects(index).size());
    if (hierarchy.is_unit(index)) {
      EXPECT_TRUE(node.child_count == 0 || hierarchy.work(index) <= hierarchy.leaf_triangles());
      for (const ObjectId object : hierarchy.objects(index)) {
        EXPECT_TRUE(found.insert(object).second) << object;
        EXPECT_EQ(hierarchy.unit_of(object), index);
      }
      continue;
    }
    EXPECT_GT(hierarchy.work(index), hierarchy.leaf_triangles());
    for (std::uint32_t i = 0; i < node.child_count; ++i) {
      EXPECT_EQ(hierarchy.parent(node.first_child + i), index);
      stack.push_back(node.first_child + i);
    }
  }
  EXPECT_EQ(found, shown);
}

TEST(QueryHierarchy, PutsEveryShownObjectIntoOneUnitWhateverComesAndGoes) {
  const Scene scene = scattered(200);
  for (const std::uint32_t leaf_triangles : {1U, 100U, 100'000U}) {
    QueryHierarchy hierarchy(leaf_triangles);
    hierarchy.build(scene);
    std::set<ObjectId> shown;
    for (ObjectId object = 0; object < 200; ++object) shown.insert(object);
    expect_sound(hierarchy, shown);
    SceneState state(scene);
    Random random(2);
    for (int frame = 0; frame < 8; ++frame) {
      Changes changes;
      for (ObjectId object = 0; object < 200; ++object) {
        const std::uint64_t what = random.below(10);
        if (what == 0 && shown.contains(object)) {
          changes.hidden.push_back(object);
        } else if (what < 5 && !shown.contains(object)) {
          changes.shown.push_back(object);
        } else if (what == 5) {
          changes.moved.push_back(object);
          glm::dmat4x3 place(1.0);
          place[3] = {random.uniform(-50.0, 50.0), 0.0, 0.0};
          changes.transforms.push_back(place);
        }
      }
      state.apply(changes);
      for (const ObjectId object : changes.hidden) shown.erase(object);
      shown.insert(changes.shown.begin(), changes.shown.end());
      const Frame now{static_cast<std::uint64_t>(frame), {}, {8, 8}, state.view(), 0.0};
      hierarchy.update(now, changes);
      expect_sound(hierarchy, shown);
    }
    EXPECT_TRUE(hierarchy.reset());
    EXPECT_FALSE(hierarchy.reset());
  }
}

TEST(QueryHierarchy, TellsWhichNodesHoldOtherObjects) {
  const Scene scene = scattered(64);
  QueryHierarchy hierarchy(1);
  hierarchy.build(scene);
  SceneState state(scene);
  Changes changes;
  changes.moved = {7};
  changes.transforms = {glm::dmat4x3(1.0)};
  state.apply(changes);
  hierarchy.update({0, {}, {8, 8}, state.view(), 0.0}, changes);
  EXPECT_TRUE(hierarchy.changed().empty()) << "motion changes no node";

  std::vector<std::set<ObjectId>> before;
  for (std::uint32_t node = 0; node < hierarchy.node_count(); ++node) {
    before.emplace_back(hierarchy.objects(node).begin(), hierarchy.objects(node).end());
  }
  changes = {};
  changes.hidden = {7, 20};
  state.apply(changes);
  hierarchy.update({1, {}, {8, 8}, state.view(), 0.0}, changes);
  const std::set<std::uint32_t> changed(hierarchy.changed().begin(), hierarchy.changed().end());
  EXPECT_FALSE(changed.empty());
  for (std::uint32_t node = 0; node < hierarchy.node_count(); ++node) {
    const std::set<ObjectId> now(hierarchy.objects(node).begin(), hierarchy.objects(node).end());
    EXPECT_EQ(changed.contains(node), now != before[node]) << node;
  }
}

}  // namespace
}  // namespace vislab
