// The part of the contract that can be read off a culler's declaration.
#pragma once

#include <string>

#include "common/culler/registry.h"

namespace vislab {

/// What is missing or contradictory in the declarations of the stages of `spec`; empty if nothing.
std::string incomplete_info(const Registry& registry, const std::string& spec);

/// A wrong parameter that some stage of `spec` takes, or refuses without saying which; empty if
/// none.
std::string accepted_nonsense(const Registry& registry, const std::string& spec);

}  // namespace vislab
