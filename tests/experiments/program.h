// Runs the vislab program as a user does.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace vislab {

struct ProgramResult {
  int exit_code = -1;  // -1: ended by a signal
  std::string out, err;
};

/// Runs `vislab ARGUMENTS` in the repository and waits for it.
ProgramResult run_vislab(const std::vector<std::string>& arguments);

/// The same where no file may grow beyond so many bytes: writing more fails, as on a full disk.
ProgramResult run_vislab_on_full_disk(const std::vector<std::string>& arguments,
                                      std::uint64_t largest_file);

/// Starts it, waits until `when` is true, or a minute at most, sends it the signal and waits for
/// its end. SIGINT also goes to the processes that it started, as from a terminal.
ProgramResult signal_vislab(const std::vector<std::string>& arguments, int signal,
                            const std::function<bool()>& when);

/// The same with Ctrl-C, twice, as from a terminal.
ProgramResult interrupt_vislab_twice(const std::vector<std::string>& arguments,
                                     const std::function<bool()>& when);

/// Starts it, waits `after_ms`, kills it and whatever it started.
void kill_vislab(const std::vector<std::string>& arguments, int after_ms);

}  // namespace vislab
