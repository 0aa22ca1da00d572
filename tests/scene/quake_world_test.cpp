#include "common/scene/quake_world.h"
#include "common/scene/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

#include "common/scene/quake_file.h"
#include "tests/input_error.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

constexpr int lump_count = 17;

/// A small world: one node that parts x < 0 from x > 0, three leaves (0 is solid by custom), a
/// square floor, a patch and a door.
struct SmallWorld {
  std::string entities =
      "{ \"classname\" \"worldspawn\" }\n"
      "{ \"classname\" \"info_player_start\" \"origin\" \"64 0 32\" \"angle\" \"90\" }\n"
      "{ \"classname\" \"func_door\" \"model\" \"*1\" \"origin\" \"0 0 320\" }\n";
  std::vector<quake::Texture> textures{2};
  std::vector<quake::PlaneRecord> planes{{{1, 0, 0}, 0}};
  std::vector<quake::NodeRecord> nodes{{0, {-2, -3}, {-128, -128, 0}, {128, 128, 128}}};
  std::vector<quake::LeafRecord> leaves{
      {-1, -1, {0, 0, 0}, {0, 0, 0}, 0, 0, 0, 0},
      {0, 0, {0, -128, 0}, {128, 128, 128}, 0, 2, 0, 0},
      {1, 0, {-128, -128, 0}, {0, 128, 128}, 1, 2, 0, 0},
  };
  std::vector<std::int32_t> leaf_faces{0, 1, 2};
  std::vector<quake::ModelRecord> models{{{-128, -128, 0}, {128, 128, 128}, 0, 3, 0, 0},
                                         {{0, 0, 0}, {32, 32, 0}, 3, 1, 0, 0}};
  std::vector<quake::Vertex> vertices;
  std::vector<std::int32_t> mesh_vertices{0, 2, 1, 0, 3, 2};  // clockwise from above, as in Quake
  std::vector<quake::FaceRecord> faces;
  std::string visible = std::string("\2\0\0\0\1\0\0\0\3\1", 10);

  SmallWorld() {
    textures[1].flags = 0x80;  // not drawn
    const auto add_vertex = [&](float x, float y, float z) {
      quake::Vertex vertex{};
      vertex.position = {x, y, z};
      vertices.push_back(vertex);
    };
    add_vertex(0, 0, 0);
    add_vertex(64, 0, 0);
    add_vertex(64, 64, 0);
    add_vertex(0, 64, 0);
    // An arch: three rows of control points over x, bent upward in the middle.
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        add_vertex(-96.0F + 32.0F * static_cast<float>(column), 32.0F * static_cast<float>(2 - row),
                   column == 1 ? 64.0F : 32.0F);
      }
    }
    quake::FaceRecord floor{};
    floor.type = quake::FaceType::polygon;
    floor.vertex_count = 4;
    floor.mesh_vertex_count = 6;
    quake::FaceRecord hidden = floor;
    hidden.texture = 1;
    quake::FaceRecord patch{};
    patch.type = quake::FaceType::patch;
    patch.first_vertex = 4;
    patch.vertex_count = 9;
    patch.size[0] = 3;
    patch.size[1] = 3;
    faces = {floor, hidden, patch, floor};
  }

  std::string bytes() const {
    std::map<int, std::string> lumps;
    const auto add = [&](int lump, const auto& records) {
      lumps[lump].assign(reinterpret_cast<const char*>(records.data()),
                         records.size() * sizeof(records[0]));
    };
    lumps[0] = entities;
    add(1, textures);
    add(2, planes);
    add(3, nodes);
    add(4, leaves);
    add(5, leaf_faces);
    add(7, models);
    add(10, vertices);
    add(11, mesh_vertices);
    add(13, faces);
    lumps[16] = visible;
    std::string header("IBSP\x2e\0\0\0", 8);
    std::string body;
    for (int lump = 0; lump < lump_count; ++lump) {
      const auto offset = static_cast<std::int32_t>(8 + 8 * lump_count + body.size());
      const auto length = static_cast<std::int32_t>(lumps[lump].size());
      header.append(reinterpret_cast<const char*>(&offset), 4);
      header.append(reinterpret_cast<const char*>(&length), 4);
      body += lumps[lump];
    }
    return header + body;
  }
};

class QuakeWorldFile : public testing::Test {
 protected:
  Scene load(const SmallWorld& world) {
    Scene scene = import_quake_world(folder_.write("small.bsp", world.bytes()));
    scene.finish();
    return scene;
  }
  std::string refused(const SmallWorld& world) { return refused_bytes(world.bytes()); }
  std::string refused_bytes(const std::string& bytes) {
    const std::filesystem::path file = folder_.write("small.bsp", bytes);
    return input_error([&]() { import_quake_world(file); });
  }

  TemporaryFolder folder_;
};

TEST_F(QuakeWorldFile, MakesAnObjectOfTheFacesOfEachLeafAndEachBrushModel) {
  const Scene scene = load(SmallWorld());
  ASSERT_EQ(scene.object_count(), 3U);
  EXPECT_EQ(scene.triangle_count(ObjectId{0}), 2U);   // the floor; the other face is not drawn
  EXPECT_EQ(scene.triangle_count(ObjectId{1}), 32U);  // the patch in 4 x 4 cells
  EXPECT_EQ(scene.triangle_count(ObjectId{2}), 2U);   // the door
  const QuakeWorld& world = *scene.quake;
  EXPECT_EQ(world.leaves[1].object, 0U);
  EXPECT_EQ(world.leaves[2].object, 1U);
  EXPECT_EQ(world.leaves[0].object, none_id);
  ASSERT_EQ(world.brush_models.size(), 1U);
  EXPECT_EQ(world.brush_models[0].object, 2U);
  EXPECT_EQ(world.brush_models[0].class_name, "func_door");
  EXPECT_EQ(world.leaf_of_object, (std::vector<std::uint32_t>{1, 2, none_id}));
}

TEST_F(QuakeWorldFile, TurnsIntoMetresWithYUpAndFrontFacesCounterClockwise) {
  const Scene scene = load(SmallWorld());
  const Aabb& floor = scene.meshes[0].bounds;
  EXPECT_EQ(floor.min, glm::vec3(0.0F, 0.0F, -2.0F));
  EXPECT_EQ(floor.max, glm::vec3(2.0F, 0.0F, 0.0F));
  const auto corners = world_triangle(scene.meshes[0], scene.objects[0].transform, 0);
  EXPECT_GT(glm::cross(corners[1] - corners[0], corners[2] - corners[0]).y, 0.0);
  EXPECT_EQ(scene.objects[2].transform[3], glm::dvec3(0.0, 10.0, 0.0));
}

TEST_F(QuakeWorldFile, BendsPatchesAlongTheirCurve) {
  const Scene scene = load(SmallWorld());
  const Mesh& arch = scene.meshes[1];
  EXPECT_EQ(arch.positions.size(), 25U);
  // A quarter of the way along the curve the height is 9/16 + 1/16 of the ends' and 6/16 of the
  // middle's: 44 units.
  EXPECT_EQ(arch.positions[1].y, 44.0F / 32.0F);
  EXPECT_EQ(arch.positions[2].y, 48.0F / 32.0F);
  for (std::uint32_t t = 0; t < arch.triangles.size(); ++t) {
    const auto c = world_triangle(arch, scene.objects[1].transform, t);
    EXPECT_GT(glm::cross(c[1] - c[0], c[2] - c[0]).y, 0.0);
  }
}

TEST_F(QuakeWorldFile, LeavesPatchCellsOutThatAreDrawnTogetherToAPoint) {
  SmallWorld world;
  for (std::size_t i = 5; i < 7; ++i) world.vertices[i].position = world.vertices[4].position;
  const Scene scene = load(world);
  EXPECT_EQ(scene.triangle_count(ObjectId{1}), 28U);
  EXPECT_EQ(scene.report.zero_area_triangles, 0U);
}

TEST_F(QuakeWorldFile, NeighbouringPatchesShareTheirEdgeExactly) {
  // The second patch continues the first, its common edge run through backwards.
  SmallWorld world;
  const float wobble[9] = {0.1F, 0.7F, -0.3F, 0.77F, 13.3F, 5.1F, -7.7F, 3.3F, 0.9F};
  for (int i = 0; i < 9; ++i) {
    world.vertices[static_cast<std::size_t>(4 + i)].position[2] += wobble[i];
  }
  quake::FaceRecord second = world.faces[2];
  second.first_vertex = static_cast<std::int32_t>(world.vertices.size());
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      quake::Vertex vertex = world.vertices[static_cast<std::size_t>(4 + 3 * (2 - row) + 2)];
      vertex.position[0] += 32.0F * static_cast<float>(column);
      world.vertices.push_back(vertex);
    }
  }
  world.faces.insert(world.faces.begin() + 3, second);
  world.leaf_faces = {0, 1, 2, 3};
  world.leaves[2].face_count = 3;
  world.models[0].face_count = 4;
  world.models[1].first_face = 4;
  const Scene scene = load(world);
  EXPECT_EQ(scene.meshes[1].positions.size(), 45U);  // 25 + 25 less the five of the edge
}

TEST_F(QuakeWorldFile, KnowsLeavesVisibilityEntitiesAndPlaces) {
  const Scene scene = load(SmallWorld());
  const QuakeWorld& world = *scene.quake;
  EXPECT_EQ(world.leaf_at({1.0, 1.0, 0.0}), 1U);
  EXPECT_EQ(world.leaf_at({-1.0, 1.0, 0.0}), 2U);
  EXPECT_EQ(world.leaf_at({0.0, 1.0, 0.0}), 1U);
  EXPECT_TRUE(world.sees(0, 1));
  EXPECT_FALSE(world.sees(1, 1));
  EXPECT_FALSE(world.sees(-1, 0));
  ASSERT_EQ(world.entities.size(), 3U);
  EXPECT_EQ(world.entities[1].at("angle"), "90");
  ASSERT_EQ(world.places.size(), 1U);
  EXPECT_EQ(world.places[0].eye, glm::dvec3(2.0, 58.0 / 32.0, 0.0));
  EXPECT_NEAR(world.places[0].heading_rad, std::acos(-1.0) / 2.0, 1e-12);
}

std::vector<std::uint32_t> leaves_of(const Scene& scene, ObjectId object) {
  const auto leaves = scene.quake->leaves_of_object(object);
  return {leaves.begin(), leaves.end()};
}

TEST_F(QuakeWorldFile, ListsAllLeavesThatAnObjectReachesInto) {
  SmallWorld world;
  const Scene apart = load(world);
  EXPECT_EQ(leaves_of(apart, 0), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(leaves_of(apart, 1), (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(leaves_of(apart, 2), (std::vector<std::uint32_t>{}));  // the door moves
  // The floor reaches over the plane, though only leaf 1 lists it.
  world.vertices[0].position[0] = -16.0F;
  EXPECT_EQ(leaves_of(load(world), 0), (std::vector<std::uint32_t>{1, 2}));
  // Leaf 1 lists the patch, though no triangle of it reaches there.
  world = SmallWorld();
  world.leaf_faces = {0, 1, 2, 2};
  world.leaves[1].face_count = 3;
  world.leaves[2].first_face = 3;
  world.leaves[2].face_count = 1;
  const Scene listed = load(world);
  EXPECT_EQ(listed.object_count(), 2U);
  EXPECT_EQ(leaves_of(listed, 0), (std::vector<std::uint32_t>{1, 2}));
}

TEST_F(QuakeWorldFile, GivesCellsTheObjectsThatReachIntoTheirLeaves) {
  SmallWorld world;
  world.vertices[0].position[0] = -16.0F;
  const Scene scene = load(world);
  ASSERT_EQ(scene.cells.size(), 2U);
  EXPECT_EQ(scene.quake->cell_of_leaf, (std::vector<CellId>{none_id, 0, 1}));
  EXPECT_EQ(scene.cells[0].objects, (std::vector<ObjectId>{0}));
  EXPECT_EQ(scene.cells[1].objects, (std::vector<ObjectId>{0, 1}));
  EXPECT_EQ(scene.portals.size(), 2U);
}

TEST_F(QuakeWorldFile, MakesTheCellsThatADescriptionAsksFor) {
  folder_.write("small.bsp", SmallWorld().bytes());
  const auto cells = [&](const std::string& keys) {
    const std::filesystem::path file =
        folder_.write("small.toml", "[quake3]\nfile = \"small.bsp\"\n" + keys);
    return load_scene(file.string(), test::repository_data()).scene.cells.size();
  };
  EXPECT_EQ(cells(""), 2U);
  EXPECT_EQ(cells("cells = \"leaves\"\n"), 2U);
  EXPECT_EQ(cells("cells = \"none\"\n"), 0U);
  EXPECT_EQ(cells("cells = \"rooms\"\nsmallest_m3 = 5.0\n"), 1U);
  EXPECT_TRUE(says(input_error([&]() { cells("cells = \"doors\"\n"); }), "`doors`"));
  EXPECT_TRUE(says(input_error([&]() { cells("smallest_m3 = 5.0\n"); }), "`smallest_m3`"));
}

TEST_F(QuakeWorldFile, RefusesEveryTruncation) {
  const std::string whole = SmallWorld().bytes();
  for (std::size_t size = 1; size < whole.size(); size += 7) {
    SCOPED_TRACE(size);
    EXPECT_TRUE(says(refused_bytes(whole.substr(0, size)), "small.bsp"));
  }
}

TEST_F(QuakeWorldFile, NeverCrashesOnADamagedByte) {
  const std::string whole = SmallWorld().bytes();
  const char patterns[3] = {'\xff', '\x7f', '\x01'};
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ patterns[at % 3]);
    const std::filesystem::path file = folder_.write("damaged.bsp", bytes);
    try {
      Scene scene = import_quake_world(file);
      scene.finish();
    } catch (const InputError& error) {
      EXPECT_TRUE(says(error.what(), ""));
    }
  }
}

TEST_F(QuakeWorldFile, RefusesOtherFormatsAndVersions) {
  EXPECT_TRUE(says(refused_bytes("not a world at all, but long enough"), "begin with IBSP"));
  std::string old = SmallWorld().bytes();
  old[4] = 38;
  EXPECT_TRUE(says(refused_bytes(old), "has version 38"));
}

TEST_F(QuakeWorldFile, RefusesIndicesOutOfRange) {
  const auto expect_refused = [&](auto damage, const std::string& part) {
    SmallWorld world;
    damage(world);
    EXPECT_TRUE(says(refused(world), part));
  };
  expect_refused([](SmallWorld& w) { w.leaf_faces[1] = 4; }, "face 4");
  expect_refused([](SmallWorld& w) { w.leaf_faces[1] = -1; }, "face -1");
  expect_refused([](SmallWorld& w) { w.mesh_vertices[2] = 4; }, "vertex of a face 4");
  expect_refused([](SmallWorld& w) { w.faces[0].mesh_vertex_count = 9; }, "mesh vertex 0 and 9");
  expect_refused([](SmallWorld& w) { w.faces[0].mesh_vertex_count = 5; }, "whole triangles");
  expect_refused([](SmallWorld& w) { w.faces[0].first_vertex = 12; }, "vertex 12 and 4");
  expect_refused([](SmallWorld& w) { w.faces[0].texture = 2; }, "texture 2");
  expect_refused([](SmallWorld& w) { w.faces[2].size[0] = 4; }, "a patch of 4 by 3");
  expect_refused([](SmallWorld& w) { w.faces[2].size[1] = 5; }, "a patch of 3 by 5");
  expect_refused([](SmallWorld& w) { w.faces[1].type = quake::FaceType{7}; }, "unknown type 7");
  expect_refused([](SmallWorld& w) { w.nodes[0].plane = 1; }, "plane 1");
  expect_refused([](SmallWorld& w) { w.nodes[0].children[0] = 0; }, "two parents");
  expect_refused([](SmallWorld& w) { w.nodes[0].children[1] = -4; }, "BSP leaf 3");
  expect_refused([](SmallWorld& w) { w.leaves[1].first_face = 3; }, "leaf face 3");
  expect_refused([](SmallWorld& w) { w.leaves[1].cluster = 2; }, "cluster 2 of 2");
  expect_refused([](SmallWorld& w) { w.models[1].face_count = 2; }, "face 3 and 2");
  expect_refused([](SmallWorld& w) { w.visible[4] = 9; }, "visibility sets");
  expect_refused([](SmallWorld& w) { w.nodes[0].children[1] = -2; }, "BSP leaf 1 has two");
  expect_refused([](SmallWorld& w) { w.nodes.clear(); }, "no BSP node");
  expect_refused([](SmallWorld& w) { w.models.clear(); }, "no model");
}

TEST_F(QuakeWorldFile, LeavesOutBitsOfVisibleSetsThatNameNoCluster) {
  SmallWorld world;
  world.visible = std::string("\2\0\0\0\1\0\0\0\xff\xfe", 10);
  EXPECT_EQ(load(world).quake->visible, (std::vector<std::uint8_t>{0b11, 0b10}));
  // Rows of two bytes more than are needed.
  world.visible = std::string("\2\0\0\0\3\0\0\0\x07\xff\xff\xfd\xff\xff", 14);
  EXPECT_EQ(load(world).quake->visible, (std::vector<std::uint8_t>{0b11, 0, 0, 0b01, 0, 0}));
}

TEST_F(QuakeWorldFile, RefusesLeavesThatCannotBeSolidThoughTheyAreInNoCluster) {
  SmallWorld world;
  world.leaves[2].cluster = -1;
  EXPECT_TRUE(says(refused(world), "leaf 2 is in no cluster"));
  world.leaves[2].area = -1;
  EXPECT_TRUE(says(refused(world), "2 faces and area -1"));
  world.leaves[2].face_count = 0;
  world.leaves[2].area = 0;
  EXPECT_TRUE(says(refused(world), "0 faces and area 0"));
  // As solid as can be, but cluster 1 is left without a leaf.
  world.leaves[2].area = -1;
  EXPECT_TRUE(says(refused(world), "cluster 1 of 2"));
  world.visible.clear();
  EXPECT_EQ(load(world).cells.size(), 1U)
      << "without sets nothing says how many clusters there are";
}

TEST_F(QuakeWorldFile, RefusesClustersWhoseOnlyLeafTheTreeDoesNotReach) {
  SmallWorld world;
  world.nodes[0].children[1] = -1;
  EXPECT_TRUE(says(refused(world), "cluster 1 of 2"));
}

TEST_F(QuakeWorldFile, RefusesPlanesAndCornersThatAreNone) {
  SmallWorld world;
  world.planes[0].normal[1] = 0.5F;
  EXPECT_TRUE(says(refused(world), "normal of plane 0"));
  world = SmallWorld();
  world.planes[0].normal[0] = std::nanf("");
  EXPECT_TRUE(says(refused(world), "normal of plane 0"));
  world = SmallWorld();
  world.planes[0].distance = -1e30F;
  EXPECT_TRUE(says(refused(world), "plane 0 is"));
  world = SmallWorld();
  world.vertices[5].position[2] = std::nanf("");
  EXPECT_TRUE(says(refused(world), "vertex 5 of a face"));
  world.vertices[5].position[2] = 140'000.0F;
  EXPECT_TRUE(says(refused(world), "coordinates are numbers up to"));
}

TEST_F(QuakeWorldFile, SaysWhatIsKnownAgainstItsVisibleSets) {
  EXPECT_TRUE(says(load(SmallWorld()).quake->doubt_about_sets(), "1 clusters do not see them"));
  SmallWorld world;
  world.visible.clear();
  EXPECT_TRUE(says(load(world).quake->doubt_about_sets(), "has no potentially visible sets"));
  world.visible = std::string("\2\0\0\0\1\0\0\0\3\3", 10);
  EXPECT_EQ(load(world).quake->doubt_about_sets(), "");
}

TEST_F(QuakeWorldFile, RefusesEntitiesThatDoNotEnd) {
  SmallWorld world;
  world.entities = "{ \"classname\" \"worldspawn\" ";
  EXPECT_TRUE(says(refused(world), "last entity does not end"));
  world.entities = "{ \"classname\" \"worldsp";
  EXPECT_TRUE(says(refused(world), "entity text"));
}

TEST_F(QuakeWorldFile, RefusesAWorldWithoutAnyFace) {
  SmallWorld world;
  for (quake::FaceRecord& face : world.faces) face.texture = 1;
  EXPECT_TRUE(says(refused(world), "no face that is drawn"));
}

}  // namespace
}  // namespace vislab
