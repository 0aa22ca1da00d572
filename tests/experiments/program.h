// Runs the vislab program as a user does.
#pragma once

#include <string>
#include <vector>

namespace vislab {

struct ProgramResult {
  int exit_code = -1;  // -1: ended by a signal
  std::string out, err;
};

/// Runs `vislab ARGUMENTS` in the repository and waits for it.
ProgramResult run_vislab(const std::vector<std::string>& arguments);

/// Starts it, waits `after_ms`, kills it and whatever it started.
void kill_vislab(const std::vector<std::string>& arguments, int after_ms);

}  // namespace vislab
