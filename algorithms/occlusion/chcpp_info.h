// What occlusion.chcpp declares of itself.
#pragma once

#include "common/culler/culler.h"

namespace vislab::occlusion_culling {

CullerInfo chcpp_info();

}  // namespace vislab::occlusion_culling
