// Whole files, read at once; and what writes them.
#pragma once

#include <filesystem>
#include <string>

#include "common/scene/write_file.h"

namespace vislab {

/// Throws InputError if the file cannot be read.
std::string read_file(const std::filesystem::path& file);

}  // namespace vislab
