#include "experiments/results/files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/scene/error.h"

namespace vislab {

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream content;
  std::error_code code;
  if (std::filesystem::is_directory(file, code) || !in || !(content << in.rdbuf())) {
    // An empty file sets failbit on the stream that copies it: that is not an error.
    if (std::filesystem::is_regular_file(file, code) && std::filesystem::is_empty(file, code)) {
      return "";
    }
    throw InputError("cannot read " + file.string());
  }
  return std::move(content).str();
}

void write_file(const std::filesystem::path& file, const std::string& content) {
  const std::filesystem::path temporary = file.string() + "." + std::to_string(::getpid()) + ".tmp";
  std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  std::error_code code;
  if (out) std::filesystem::rename(temporary, file, code);
  if (!out || code) {
    const std::string why = code ? code.message() : std::strerror(errno);
    std::filesystem::remove(temporary, code);
    throw WriteError("cannot write " + file.string() + ": " + why);
  }
}

}  // namespace vislab
