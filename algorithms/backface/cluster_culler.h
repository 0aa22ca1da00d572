// The culler behind backface.cluster, for it and for the wrong variant that joins clusters by the
// rule as it is printed (backface.wrong).
#pragma once

#include <functional>
#include <memory>

#include "algorithms/backface/triangle_clusters.h"
#include "common/culler/culler.h"

namespace vislab::backface_culling {

/// Clusters of every mesh are made with what this returns; called while the culler is built.
using ClusterSettingsOf = std::function<ClusterSettings(const BuildContext& context)>;

/// `info` as the culler describes itself.
std::unique_ptr<ICuller> make_cluster_culler(CullerInfo info, bool cull_open,
                                             ClusterSettingsOf settings);

}  // namespace vislab::backface_culling
