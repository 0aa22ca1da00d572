#include "experiments/results/files.h"

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

}  // namespace vislab
