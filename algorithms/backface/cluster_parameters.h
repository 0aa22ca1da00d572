// The parameters that the cullers of clusters share.
#pragma once

#include <vector>

#include "algorithms/backface/triangle_clusters.h"
#include "common/culler/culler.h"

namespace vislab::backface_culling {

/// size, of that default, origin, eye_distance, costs and open.
std::vector<ParameterSpec> cluster_parameters(std::uint32_t size);
/// Where all are read for every eye, there should be no more than a cache holds; a walk down a tree
/// meets few of them.
inline constexpr std::uint32_t flat_cluster_size = 8;
inline constexpr std::uint32_t tree_cluster_size = 8;

/// What they say. `costs=measured` takes the table of the context, if it has one.
ClusterSettings cluster_settings(const ParameterValues& values, const BuildContext& context);

}  // namespace vislab::backface_culling
