// One run at a time writes into a results folder: two would measure each other's load.
#pragma once

#include <filesystem>
#include <functional>

namespace vislab {

/// Holds a folder for as long as it lives. The lock ends with the processes that have it, however
/// they end, and leaves no file behind.
class FolderLock {
 public:
  /// Waits for whoever has the folder, after calling `on_wait` once. Throws InputError if the
  /// folder cannot be opened or locked.
  FolderLock(const std::filesystem::path& folder, const std::function<void()>& on_wait);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

}  // namespace vislab
