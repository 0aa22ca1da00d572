#include "experiments/context/context.h"

#include <sys/utsname.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include "common/judge/truth.h"
#include "common/scene/error.h"
#include "experiments/context/sources.h"
#include "experiments/results/hash.h"

#include "common/culler/registry.h"

namespace vislab {
namespace {

std::string first_line(const char* file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// The value behind "key   : value" in /proc/cpuinfo.
std::string cpu_fact(const std::string& key) {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(key)) {
      const auto colon = line.find(':');
      if (colon != std::string::npos && colon + 2 <= line.size()) return line.substr(colon + 2);
    }
  }
  return "";
}

/// The flags that matter to the lab's kernels, in a stable order.
std::string cpu_flags() {
  std::istringstream in(cpu_fact("flags"));
  std::string kept;
  for (std::string flag; in >> flag;) {
    if (flag.starts_with("sse") || flag.starts_with("avx") || flag == "fma" || flag == "bmi2") {
      kept += (kept.empty() ? "" : " ") + flag;
    }
  }
  return kept;
}

/// What a command prints, first line; "" if it fails.
std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  if (!pipe) return "";
  std::array<char, 256> buffer{};
  if (std::fgets(buffer.data(), buffer.size(), pipe.get()) == nullptr) return "";
  std::string line(buffer.data());
  while (!line.empty() && line.back() == '\n') line.pop_back();
  return line;
}

/// "2026-11-23", in universal time.
std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm date{};
  ::gmtime_r(&now, &date);
  std::array<char, 16> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d", &date);
  return text.data();
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

}  // namespace

std::string chain_source_hash(std::string_view canonical_chain) {
  std::string text;
  for (const CullerSpec& stage : parse_chain(canonical_chain)) {
    const auto known = family_source_hashes().find(stage.name.substr(0, stage.name.find('.')));
    // A culler that was registered by hand, as tests do, has no family folder.
    text += known != family_source_hashes().end() ? known->second : stage.name;
    text += '\n';
  }
  return hash_text(text);
}

std::map<std::string, std::string> run_context(const std::filesystem::path& repository) {
  std::map<std::string, std::string> context;
  utsname system{};
  ::uname(&system);
  const std::string cpu = cpu_fact("model name");
  context["cpu"] = cpu;
  context["cpu_flags"] = cpu_flags();
  context["cores"] = std::to_string(std::thread::hardware_concurrency());
  // An id that tells machines apart and gives nothing else away.
  context["machine"] =
      hash_text(first_line("/etc/machine-id") + cpu + system.nodename).substr(0, 12);
  context["system"] = std::string(system.sysname) + " " + system.release + " " + system.machine;
  context["compiler"] = "g++ " __VERSION__;
  context["compiler_flags"] = VISLAB_COMPILER_FLAGS;
  context["build_type"] = VISLAB_BUILD_TYPE;
  context["libraries"] = VISLAB_LIBRARY_VERSIONS;
  context["embree"] = RayCaster::engine();
  const std::string git = "git -C " + quoted(repository.string());
  context["revision"] = output_of(git + " rev-parse --short=12 HEAD 2>/dev/null");
  context["dirty"] = output_of(git + " status --porcelain --untracked-files=no 2>/dev/null").empty()
                         ? "no"
                         : "yes";
  context["date"] = today();
  context["load"] = first_line("/proc/loadavg").substr(0, 4);
  return context;
}

}  // namespace vislab
