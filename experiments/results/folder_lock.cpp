#include "experiments/results/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/scene/error.h"

namespace vislab {

FolderLock::FolderLock(const std::filesystem::path& folder, const std::function<void()>& on_wait)
    : file_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  int status = file_ < 0 ? -1 : ::flock(file_, LOCK_EX | LOCK_NB);
  if (file_ >= 0 && status != 0 && errno == EWOULDBLOCK) {
    on_wait();
    do {
      status = ::flock(file_, LOCK_EX);
    } while (status != 0 && errno == EINTR);
  }
  if (status != 0) {
    const std::string why = std::strerror(errno);
    if (file_ >= 0) ::close(file_);
    throw InputError("results folder " + folder.string() + " cannot be locked: " + why +
                     "; name another with --results");
  }
}

FolderLock::~FolderLock() { ::close(file_); }

}  // namespace vislab
