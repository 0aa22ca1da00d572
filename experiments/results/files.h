// Whole files, read and written at once.
#pragma once

#include <filesystem>
#include <string>

namespace vislab {

/// Throws InputError if the file cannot be read.
std::string read_file(const std::filesystem::path& file);

/// Writes to a temporary name in the same folder, then renames: the file is old or new, never half.
/// Throws InputError if that fails.
void write_file(const std::filesystem::path& file, const std::string& content);

}  // namespace vislab
