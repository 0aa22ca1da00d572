#include <gtest/gtest.h>

#include <fstream>

#include "common/judge/truth.h"
#include "common/scene/error.h"
#include "tests/judge/judge_scenes.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

class TruthStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    Stage stage(random_triangles(40, 3.0, 0.8, 21), camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}),
                {50, 41});
    RayCaster caster(stage.scene, {.jitter_per_pixel = 4, .seed = 1, .threads = 2});
    truth_ = caster.trace(stage.frame);
  }

  fs::path only_file() const { return fs::directory_iterator(folder_)->path(); }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  FrameTruth truth_;
};

TEST_F(TruthStoreTest, gives_back_what_was_saved) {
  const TruthStore store(folder_ / "deep" / "inside");
  EXPECT_FALSE(store.load("key"));
  store.save("key", truth_);
  EXPECT_EQ(store.load("key"), truth_);
  EXPECT_FALSE(store.load("other"));
  FrameTruth empty;
  empty.viewport = {2, 1};
  empty.ids = {none_id, 0};
  store.save("key", empty);
  EXPECT_EQ(store.load("key"), empty);
}

TEST_F(TruthStoreTest, leaves_no_temporary_file) {
  const TruthStore store(folder_);
  store.save("key", truth_);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(TruthStoreTest, treats_a_truncated_file_as_not_there) {
  const TruthStore store(folder_);
  store.save("key", truth_);
  const auto size = fs::file_size(only_file());
  for (const std::uintmax_t left : {size - 1, size / 2, std::uintmax_t{25}, std::uintmax_t{24},
                                    std::uintmax_t{8}, std::uintmax_t{0}}) {
    fs::resize_file(only_file(), left);
    EXPECT_FALSE(store.load("key")) << left << " bytes of " << size;
  }
}

TEST_F(TruthStoreTest, treats_a_file_with_any_byte_changed_as_not_there) {
  const TruthStore store(folder_);
  store.save("key", truth_);
  const auto size = static_cast<std::streamoff>(fs::file_size(only_file()));
  for (std::streamoff at = 0; at < size; at += at < 32 ? 1 : 97) {
    std::fstream file(only_file(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(at);
    const char byte = static_cast<char>(file.get());
    file.seekp(at);
    file.put(static_cast<char>(byte ^ 0x10));
    file.close();
    EXPECT_FALSE(store.load("key")) << "byte " << at;
    store.save("key", truth_);
  }
}

TEST_F(TruthStoreTest, says_so_when_the_folder_cannot_be_written) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "file") << "not a folder";
  const TruthStore store(folder_ / "file");
  EXPECT_THROW(store.save("key", truth_), InputError);
}

}  // namespace
}  // namespace vislab
