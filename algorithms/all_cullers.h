// Every culler of the lab in one call. The definition is written by CMake.
#pragma once

#include "common/culler/registry.h"

namespace vislab {

void register_all_cullers(Registry& registry);

}  // namespace vislab
