#include "report/process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <thread>

#include "common/scene/error.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> find_in_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / name;
    if (fs::is_regular_file(file) && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return std::nullopt;
}

/// The last line that says something.
std::string last_words(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (line.find_first_not_of(" \t\r^") != std::string::npos) last = line;
  }
  return last.empty() ? "it printed nothing" : last;
}

/// Only async-signal-safe calls: this is the child of a process that may have several threads.
[[noreturn]] void become(const fs::path& file, char* const* arguments, const fs::path& folder,
                         const fs::path& log) {
  ::setpgid(0, 0);
  const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int input = ::open("/dev/null", O_RDONLY);
  if (output < 0 || input < 0 || ::chdir(folder.c_str()) != 0) ::_exit(127);
  ::dup2(input, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  ::execv(file.c_str(), arguments);
  ::_exit(127);
}

}  // namespace

void run_program(const Program& program, const std::vector<std::string>& arguments,
                 const fs::path& folder, std::chrono::seconds limit) {
  const std::optional<fs::path> file = find_in_path(program.name);
  if (!file) {
    throw InputError("the report needs the program " + program.name +
                     ", which is not installed (Debian package " + program.package + ")");
  }
  const fs::path log = folder / (program.name + ".log");
  std::vector<char*> pointers{const_cast<char*>(program.name.c_str())};
  for (const std::string& argument : arguments) {
    pointers.push_back(const_cast<char*>(argument.c_str()));
  }
  pointers.push_back(nullptr);

  const pid_t child = ::fork();
  if (child < 0) throw InputError(program.name + " cannot be started: " + std::strerror(errno));
  if (child == 0) become(*file, pointers.data(), folder, log);

  const auto end = std::chrono::steady_clock::now() + limit;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      ::kill(-child, SIGKILL);
      ::waitpid(child, &status, 0);
      throw InputError(program.name + " did not end within " + std::to_string(limit.count()) +
                       " s while writing the report");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::kill(-child, SIGKILL);  // helpers that it left behind
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError(program.name + " failed while writing the report: " + last_words(log));
  }
}

}  // namespace vislab
