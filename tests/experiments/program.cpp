#include "tests/experiments/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "experiments/results/files.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

/// In a process group of its own, with its output in two files.
pid_t start(const std::vector<std::string>& arguments, const std::string& out,
            const std::string& err, rlim_t largest_file = RLIM_INFINITY) {
  std::vector<std::string> words{std::string(VISLAB_BINARY_DIR) + "/vislab"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::setpgid(0, 0);
    const int flags = O_CREAT | O_WRONLY | O_TRUNC;
    ::dup2(::open(out.c_str(), flags, 0600), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), flags, 0600), STDERR_FILENO);
    if (largest_file != RLIM_INFINITY) {
      const rlimit limit{largest_file, largest_file};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      ::signal(SIGXFSZ, SIG_IGN);  // a full disk is an error of write(), no signal
    }
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::setpgid(pid, pid);
  return pid;
}

/// A minute at most.
void wait_for(const std::function<bool()>& when) {
  for (int i = 0; i < 3000 && !when(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// Waits for its end.
ProgramResult result_of(pid_t pid, const std::string& out, const std::string& err) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(err)};
}

}  // namespace

ProgramResult run_vislab(const std::vector<std::string>& arguments) {
  return run_vislab_on_full_disk(arguments, RLIM_INFINITY);
}

ProgramResult run_vislab_on_full_disk(const std::vector<std::string>& arguments,
                                      std::uint64_t largest_file) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "out";
  const std::string err = folder.path() / "err";
  return result_of(start(arguments, out, err, largest_file), out, err);
}

ProgramResult signal_vislab(const std::vector<std::string>& arguments, int signal,
                            const std::function<bool()>& when) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "out";
  const std::string err = folder.path() / "err";
  const pid_t pid = start(arguments, out, err);
  wait_for(when);
  ::kill(signal == SIGINT ? -pid : pid, signal);
  return result_of(pid, out, err);
}

ProgramResult interrupt_vislab_twice(const std::vector<std::string>& arguments,
                                     const std::function<bool()>& when) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "out";
  const std::string err = folder.path() / "err";
  const pid_t pid = start(arguments, out, err);
  wait_for(when);
  ::kill(-pid, SIGINT);
  // Signals that come while one is waiting to be handled are one.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  ::kill(-pid, SIGINT);
  return result_of(pid, out, err);
}

void kill_vislab(const std::vector<std::string>& arguments, int after_ms) {
  const TemporaryFolder folder;
  // The program and the processes that it starts have its end for writing until they are gone, and
  // with them what they have locked.
  int alive[2];
  if (::pipe(alive) != 0) throw std::runtime_error("no pipe");
  const pid_t pid = start(arguments, folder.path() / "out", folder.path() / "err");
  ::close(alive[1]);
  std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
  ::kill(-pid, SIGKILL);
  int status = 0;
  ::waitpid(pid, &status, 0);
  char nothing = 0;
  while (::read(alive[0], &nothing, 1) < 0 && errno == EINTR) {
  }
  ::close(alive[0]);
}

}  // namespace vislab
