// Whole files, read and written at once.
#pragma once

#include <filesystem>
#include <string>

#include "common/scene/error.h"

namespace vislab {

/// Throws InputError if the file cannot be read.
std::string read_file(const std::filesystem::path& file);

/// A file could not be written: the disk is full, or the folder is not writable. Told apart from
/// other wrong input, so that a full disk is not put down to what was being measured.
class WriteError : public InputError {
 public:
  using InputError::InputError;
};

/// Writes to a temporary name in the same folder, then renames: the file is old or new, never half.
/// Throws WriteError that says why if that fails.
void write_file(const std::filesystem::path& file, const std::string& content);

}  // namespace vislab
