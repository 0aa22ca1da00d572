// Probes of visibility by rays that are aimed or traced otherwise than the truth's.
#pragma once

#include <memory>

#include "common/culler/ray_probe.h"

namespace vislab {

/// The scene outlives the probe. Throws InputError for settings that are out of range or that this
/// machine cannot do.
std::unique_ptr<RayProbe> make_ray_probe(const Scene& scene, const RaySampling& sampling);

}  // namespace vislab
