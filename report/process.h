// Runs the programs that the report is made with.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace vislab {

struct Program {
  std::string name;     // looked up in PATH
  std::string package;  // the Debian package that has it, for the message when it is missing
};

/// Runs the program with `arguments` in `folder` and waits for it. What it prints is kept in
/// `folder`/NAME.log. Throws InputError if the program is not there, fails (with the end of what it
/// printed), or has not ended after `limit`; it and its children are killed then.
void run_program(const Program& program, const std::vector<std::string>& arguments,
                 const std::filesystem::path& folder, std::chrono::seconds limit);

}  // namespace vislab
