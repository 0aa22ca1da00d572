// Files of a new culler: made in the checkout that one stands in, all of them or none.
#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/results/files.h"
#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

/// Of a checkout only what is looked at and changed, and the tests stand in it.
class NewCuller : public ::testing::Test {
 protected:
  NewCuller() : before_(fs::current_path()) {
    const fs::path source = VISLAB_SOURCE_DIR;
    for (const char* file :
         {"algorithms/CMakeLists.txt", "algorithms/skeleton/CMakeLists.txt",
          "algorithms/skeleton/example.cpp", "algorithms/frustum/CMakeLists.txt",
          "algorithms/frustum/object_tester.cpp", "algorithms/peers/CMakeLists.txt",
          "cmake/Vislab.cmake", "common/scene/CMakeLists.txt", "experiments/CMakeLists.txt",
          "report/CMakeLists.txt"}) {
      fs::create_directories((root() / file).parent_path());
      fs::copy_file(source / file, root() / file);
    }
    fs::current_path(root());
  }
  ~NewCuller() override { fs::current_path(before_); }

  fs::path root() const { return folder_.path() / "checkout"; }

  /// Every file and what is in it.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(root())) {
      all[entry.path().string()] = entry.is_directory() ? "" : read_file(entry.path());
    }
    return all;
  }

  void expect_refused(const std::string& name, const std::string& word) const {
    const auto untouched = files();
    const ProgramResult result = run_vislab({"new-culler", name});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
    EXPECT_EQ(files(), untouched) << name;
  }

 private:
  TemporaryFolder folder_;
  fs::path before_;
};

TEST_F(NewCuller, ANewFamilyIsAFolderAndALine) {
  const std::string list = read_file("algorithms/CMakeLists.txt");
  const ProgramResult result = run_vislab({"new-culler", "mine.first_try"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_file("algorithms/mine/CMakeLists.txt"),
            "vislab_add_culler_family(mine CULLERS first_try)\n");
  const std::string source = read_file("algorithms/mine/first_try.cpp");
  EXPECT_NE(source.find("CullerEntry mine_first_try()"), std::string::npos);
  EXPECT_NE(source.find("info.name = \"mine.first_try\""), std::string::npos);
  EXPECT_EQ(source.find("skeleton"), std::string::npos) << "nothing of the skeleton's name stays";
  EXPECT_EQ(source.find("Example"), std::string::npos);
  const std::string longer = read_file("algorithms/CMakeLists.txt");
  EXPECT_EQ(longer.size(), list.size() + std::string("add_subdirectory(mine)\n").size());
  EXPECT_LT(longer.find("add_subdirectory(mine)\n"), longer.find("vislab_write_registry()"));
  EXPECT_NE(result.out.find("check --culler mine.first_try"), std::string::npos) << result.out;
}

TEST_F(NewCuller, AVariantIsAFileAndAName) {
  ASSERT_EQ(run_vislab({"new-culler", "mine.first"}).exit_code, 0);
  ASSERT_EQ(run_vislab({"new-culler", "mine.second"}).exit_code, 0);
  EXPECT_EQ(read_file("algorithms/mine/CMakeLists.txt"),
            "vislab_add_culler_family(mine CULLERS first second)\n");
  ASSERT_EQ(run_vislab({"new-culler", "frustum.own"}).exit_code, 0);
  EXPECT_NE(read_file("algorithms/frustum/CMakeLists.txt").find("\n    own\n  SOURCES"),
            std::string::npos);
  ASSERT_EQ(run_vislab({"new-culler", "peer.own"}).exit_code, 0);
  EXPECT_TRUE(fs::exists("algorithms/peers/own.cpp")) << "the family's folder has another name";
  EXPECT_NE(read_file("algorithms/peers/CMakeLists.txt").find("CULLERS ${peers} own SOURCES"),
            std::string::npos);
}

TEST_F(NewCuller, IsMadeFromAnywhereInTheCheckout) {
  fs::current_path(root() / "algorithms" / "frustum");
  EXPECT_EQ(run_vislab({"new-culler", "mine.first"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(root() / "algorithms" / "mine" / "first.cpp"));
}

TEST_F(NewCuller, BadNamesAreRefused) {
  for (const char* name : {"mine", "mine.", ".mine", "Mine.first", "mine.First", "mine.a-b",
                           "my_own.first", "mine.first.second", "../x.y", "mine.mine", "1mine.a",
                           "mine. ", "mine.a/b", "mine.first__step", "mine.first_"}) {
    expect_refused(name, "family.variant");
  }
}

TEST_F(NewCuller, WhatIsThereIsNotTouched) {
  expect_refused("skeleton.example", "example.cpp exists");
  expect_refused("frustum.object_tester", "object_tester.cpp exists");
  expect_refused("scene.first", "library");
  expect_refused("options.first", "library");
  expect_refused("none.other", "none");
  fs::create_directories(root() / "algorithms" / "taken");
  expect_refused("taken.first", "exists");
}

TEST_F(NewCuller, IfOneFileCannotBeWrittenNoneIs) {
  fs::remove(root() / "algorithms" / "CMakeLists.txt");
  expect_refused("mine.first", "CMakeLists.txt");
}

TEST_F(NewCuller, OutsideOfACheckoutThereIsAMessage) {
  fs::current_path(root().parent_path());
  const ProgramResult result = run_vislab({"new-culler", "mine.first"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("not in a checkout"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace vislab
