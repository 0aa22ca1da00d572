// The circumstances of a measurement: machine, compiler, revision, libraries, load.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace vislab {

/// Facts by name: machine (an anonymous id), cpu, cpu_flags, cores, compiler, compiler_flags,
/// build_type, revision, dirty, date (universal time), load (one-minute average at the call), and
/// the versions of Embree, assimp and the operating system. Takes milliseconds (runs git in
/// `repository`).
std::map<std::string, std::string> run_context(const std::filesystem::path& repository);

}  // namespace vislab
