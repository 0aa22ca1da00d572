#include "common/scene/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace vislab {
namespace {

/// Waits until it is on the disk; a file system that has no such call is not at fault.
bool flush_to_disk(int file) { return ::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP; }

bool write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(file, content.data(), content.size());
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) content.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool write_and_close(const std::string& name, std::string_view content, Flush flush) {
  const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) return false;
  const bool written = write_all(file, content) && (flush == Flush::no || flush_to_disk(file));
  const int why = errno;
  const bool closed = ::close(file) == 0;
  if (!written) errno = why;
  return written && closed;
}

/// The renaming itself. A folder that cannot be flushed still has the file, old or new.
void flush_folder(const std::filesystem::path& folder) {
  const std::string name = folder.empty() ? "." : folder.string();
  const int file = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

void write_file(const std::filesystem::path& file, std::string_view content, Flush flush) {
  static std::atomic<unsigned> count = 0;
  const std::string temporary =
      file.string() + "." + std::to_string(::getpid()) + "." + std::to_string(count++) + ".tmp";
  if (!write_and_close(temporary, content, flush) ||
      std::rename(temporary.c_str(), file.c_str()) != 0) {
    const std::string why = std::strerror(errno);
    ::unlink(temporary.c_str());
    throw WriteError("cannot write " + file.string() + ": " + why);
  }
  if (flush == Flush::yes) flush_folder(file.parent_path());
}

}  // namespace vislab
