// Errors of the user's that tests expect.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "common/scene/error.h"

namespace vislab {

/// The message of the InputError that `action` throws; a failed test and "" if it throws none.
template <typename Action>
std::string input_error(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

/// True if a message is one line and has the part; says the message if not.
inline testing::AssertionResult says(const std::string& message, const std::string& part) {
  if (message.find('\n') != std::string::npos) {
    return testing::AssertionFailure() << "not one line: " << message;
  }
  if (message.find(part) == std::string::npos) {
    return testing::AssertionFailure() << "`" << part << "` is not in: " << message;
  }
  return testing::AssertionSuccess();
}

}  // namespace vislab
