// Whole files, written at once.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/scene/error.h"

namespace vislab {

/// A file could not be written: the disk is full, or the folder is not writable. Told apart from
/// other wrong input, so that a full disk is not put down to what was being measured.
class WriteError : public InputError {
 public:
  using InputError::InputError;
};

/// Does writing wait until the disk has it? That takes milliseconds, and is for what cannot be made
/// again in less.
enum class Flush { no, yes };

/// Writes to a temporary name in the same folder that no other call has, FILE.PID.COUNT.tmp, then
/// renames: the file is old or new, never half. Flushed, it is so also if the machine fails: the
/// content is on the disk before the name is. Throws WriteError that says why if that fails; the
/// temporary file is gone then.
void write_file(const std::filesystem::path& file, std::string_view content,
                Flush flush = Flush::no);

}  // namespace vislab
