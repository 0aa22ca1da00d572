#include "common/scene/mesh_import.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "common/scene/assimp_reader.h"
#include "common/scene/error.h"
#include "common/scene/file_bytes.h"
#include "common/scene/mesh_check.h"

namespace vislab {
namespace {

// What the child sends: 'E' and a message, or 'S', the meshes, the objects and a final '.'. Parent
// and child are the same program, so numbers go as they lie in memory.

class Writer {
 public:
  explicit Writer(int pipe) : pipe_(pipe) {}

  void bytes(const void* data, std::size_t size) {
    const char* from = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t written = write(pipe_, from, size);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) _exit(1);  // the parent is gone
      from += written;
      size -= static_cast<std::size_t>(written);
    }
  }
  template <typename Value>
  void value(const Value& v) {
    bytes(&v, sizeof v);
  }
  template <typename List>
  void list(const List& l) {
    value<std::uint64_t>(l.size());
    bytes(l.data(), l.size() * sizeof(typename List::value_type));
  }

 private:
  int pipe_;
};

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  void bytes(void* to, std::size_t size) {
    if (size > text_.size() - at_) throw std::runtime_error("its answer is cut short");
    if (size > 0) std::memcpy(to, text_.data() + at_, size);
    at_ += size;
  }
  template <typename Value>
  Value value() {
    Value v;
    bytes(&v, sizeof v);
    return v;
  }
  template <typename List>
  List list() {
    const auto size = value<std::uint64_t>();
    if (size > text_.size() - at_) throw std::runtime_error("its answer is cut short");
    List l(size, typename List::value_type());
    bytes(l.data(), size * sizeof(typename List::value_type));
    return l;
  }

 private:
  const std::string& text_;
  std::size_t at_ = 0;
};

void send(Writer& writer, const Scene& scene) {
  writer.value('S');
  writer.value<std::uint64_t>(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    writer.list(mesh.name);
    writer.list(mesh.positions);
    writer.list(mesh.triangles);
  }
  writer.value<std::uint64_t>(scene.objects.size());
  for (const Object& object : scene.objects) {
    writer.value(object.mesh);
    writer.value(object.transform);
  }
  writer.value('.');
}

/// Throws std::runtime_error with the child's own message, or if the answer is not whole.
Scene receive(const std::string& answer) {
  Reader reader(answer);
  if (reader.value<char>() == 'E') throw std::runtime_error(reader.list<std::string>());
  Scene scene;
  const auto meshes = reader.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < meshes; ++i) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.name = reader.list<std::string>();
    mesh.positions = reader.list<std::vector<glm::vec3>>();
    mesh.triangles = reader.list<std::vector<glm::uvec3>>();
  }
  const auto objects = reader.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < objects; ++i) {
    Object& object = scene.objects.emplace_back();
    object.mesh = reader.value<MeshId>();
    object.transform = reader.value<glm::dmat4x3>();
  }
  if (reader.value<char>() != '.') throw std::runtime_error("its answer is cut short");
  return scene;
}

struct Source {
  std::string file;
  std::optional<std::string> bytes;  // decompressed; the file itself is read if absent
  std::string format;
};

/// Never returns: imports, sends, and ends the process without running the parent's cleanup.
[[noreturn]] void run_child(int pipe, const Source& source, unsigned time_limit_s) {
  for (const int signal_number : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGALRM, SIGTERM}) {
    signal(signal_number, SIG_DFL);
  }
  sigset_t no_signals;
  sigemptyset(&no_signals);
  sigprocmask(SIG_SETMASK, &no_signals, nullptr);
  alarm(time_limit_s);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = open("/dev/null", O_RDWR);
  if (nowhere >= 0) {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  }
  Writer writer(pipe);
  std::string message;
  try {
    send(writer, read_with_assimp(source.file, source.bytes, source.format));
    _exit(0);
  } catch (const std::exception& error) {
    message = error.what();
  } catch (...) {
    message = "an unknown failure";
  }
  writer.value('E');
  writer.list(message);
  _exit(1);
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

/// Forks, collects the child's answer and its end. Throws std::runtime_error for a crash or a hang.
Scene import_in_child(const Source& source, unsigned time_limit_s) {
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe to the importer");
  const pid_t child = fork();
  if (child == 0) {
    close(pipe_ends[0]);
    run_child(pipe_ends[1], source, time_limit_s);
  }
  close(pipe_ends[1]);
  std::string answer;
  std::vector<char> buffer(1U << 20U);
  while (child > 0) {
    const ssize_t size = read(pipe_ends[0], buffer.data(), buffer.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    answer.append(buffer.data(), static_cast<std::size_t>(size));
  }
  close(pipe_ends[0]);
  if (child < 0) throw std::runtime_error("no process for the importer");
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) {
    const int signal_number = WTERMSIG(status);
    if (signal_number == SIGALRM) {
      throw std::runtime_error("it did not finish within " + std::to_string(time_limit_s) + " s");
    }
    throw std::runtime_error("it crashed with signal " + std::to_string(signal_number));
  }
  if (answer.empty()) throw std::runtime_error("it ended without an answer");
  return receive(answer);
}

/// Some editors begin a text with a byte-order mark, which must not become a part of its first
/// word. A file without one stays to be read by the importer itself.
void leave_out_mark(Source& source) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  std::string bytes = source.bytes ? std::move(*source.bytes) : read_bytes(source.file);
  if (bytes.starts_with(mark)) {
    source.bytes = bytes.substr(mark.size());
  } else if (source.bytes) {
    source.bytes = std::move(bytes);
  }
}

}  // namespace

Scene import_mesh_file(const std::filesystem::path& file, unsigned time_limit_s) {
  require_file(file);
  Source source{file.string(), std::nullopt, lower_extension(file)};
  std::filesystem::path stem = file.stem();
  if (source.format == "gz") {
    source.format = lower_extension(stem);
    stem = stem.stem();
    source.bytes = read_gzipped_bytes(file);
  }
  if (source.format.empty()) {
    throw InputError(file.string() + " has no extension that tells its format, such as .ply");
  }
  if (source.format == "obj") leave_out_mark(source);
  check_mesh_bytes(source.bytes ? *source.bytes : read_bytes(file), source.format, file.string());
  Scene scene;
  try {
    scene = import_in_child(source, time_limit_s);
  } catch (const std::runtime_error& error) {
    throw InputError(file.string() + " cannot be imported: " + one_line(error.what()));
  }
  if (scene.objects.empty()) {
    throw InputError(file.string() + " holds no triangle; a scene needs at least one");
  }
  scene.name = stem.string();
  return scene;
}

}  // namespace vislab
