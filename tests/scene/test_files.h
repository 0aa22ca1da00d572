// Files that tests write, and errors that they expect.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/scene/error.h"
#include "common/scene/library.h"

namespace vislab::test {

/// A folder of its own, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("vislab_") + info->test_suite_name() + "_" + info->name() + "_" +
             std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The message of the InputError that `action` throws; a failed test and "" if it throws none.
template <typename Action>
std::string input_error(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

/// True if a message is one line and has the part; says the message if not.
inline testing::AssertionResult says(const std::string& message, const std::string& part) {
  if (message.find('\n') != std::string::npos) {
    return testing::AssertionFailure() << "not one line: " << message;
  }
  if (message.find(part) == std::string::npos) {
    return testing::AssertionFailure() << "`" << part << "` is not in: " << message;
  }
  return testing::AssertionSuccess();
}

inline DataFolders repository_data() {
  const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  return {data, data / "cache"};
}

}  // namespace vislab::test
