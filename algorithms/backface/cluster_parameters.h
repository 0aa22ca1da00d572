// The parameters that the cullers of clusters share.
#pragma once

#include <vector>

#include "algorithms/backface/triangle_clusters.h"
#include "common/culler/culler.h"

namespace vislab::backface_culling {

/// size, origin, eye_distance, costs and open.
std::vector<ParameterSpec> cluster_parameters();

/// What they say. `costs=measured` takes the table of the context, if it has one.
ClusterSettings cluster_settings(const ParameterValues& values, const BuildContext& context);

}  // namespace vislab::backface_culling
