#include "common/render/png.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "common/scene/error.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

class Png : public testing::Test {
 protected:
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  Image image_{3, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 1, 2, 3, 4, 5, 6, 7, 8, 9}};
};

TEST_F(Png, ReadsBackWhatItWrote) {
  write_png(folder_ / "a.png", image_);
  EXPECT_EQ(read_png(folder_ / "a.png"), image_);
  EXPECT_EQ(files(), 1U) << "no temporary file may stay";
}

TEST_F(Png, NamesThePathThatCannotBeWritten) {
  const fs::path path = folder_ / "missing" / "a.png";
  EXPECT_TRUE(says(input_error([&] { write_png(path, image_); }), path.string()));
}

TEST_F(Png, RefusesNamesOfOtherFormats) {
  for (const char* name : {"a.jpg", "a", "a.png.gz"}) {
    EXPECT_THROW(write_png(folder_ / name, image_), InputError) << name;
  }
  EXPECT_EQ(files(), 0U);
  write_png(folder_ / "A.PNG", image_);
  EXPECT_EQ(read_png(folder_ / "A.PNG"), image_);
}

TEST_F(Png, LeavesNothingBehindWhenThePathIsAFolder) {
  fs::create_directories(folder_ / "a.png" / "inside");
  EXPECT_THROW(write_png(folder_ / "a.png", image_), InputError);
  EXPECT_EQ(files(), 1U);
}

TEST_F(Png, RefusesFilesThatAreNoPictures) {
  EXPECT_THROW(read_png(folder_ / "missing.png"), InputError);
  std::ofstream(folder_ / "text.png") << "not a picture";
  EXPECT_THROW(read_png(folder_ / "text.png"), InputError);
}

}  // namespace
}  // namespace vislab
