// Whole files in memory, gunzipped where the name says so.
#pragma once

#include <filesystem>
#include <string>

namespace vislab {

/// The extension of a file's name in lower case, without the dot; empty if there is none.
std::string lower_extension(const std::filesystem::path& file);

/// Throws InputError unless `file` is a regular file that is not empty.
void require_file(const std::filesystem::path& file);

/// The content of a file. Throws InputError if it is missing, a directory, empty or unreadable.
std::string read_bytes(const std::filesystem::path& file);

/// The content of a .gz file, decompressed. Throws InputError as read_bytes, and for data that is
/// damaged or ends too early.
std::string read_gzipped_bytes(const std::filesystem::path& file);

}  // namespace vislab
