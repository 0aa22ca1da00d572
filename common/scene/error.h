// The one exception for wrong input: files, parameters, matrices and results that users hand in.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace vislab {

/// What is wrong, where, and what would be right, in one line. Programs end with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "`unknown` is not a <kind>; known: a, b, c" as an InputError.
InputError unknown_name(const std::string& kind, const std::string& unknown,
                        const std::vector<std::string>& known);

}  // namespace vislab
