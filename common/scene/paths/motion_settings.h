// The table `motion` of a path's description.
#pragma once

#include "common/scene/paths/motion.h"
#include "common/scene/paths/path_points.h"
#include "common/scene/settings.h"

namespace vislab {

/// Keys of all kinds: `kind` = revolve | drift | churn | depart | slide | toggle, `duration_s` (for
/// the whole path), `seed`. The others are named as the members of the kind's struct in motion.h;
/// `share`, `border`, `factor` and `max_spin_deg_s` have its defaults, `center` is the middle of
/// the scene's box unless it is given, `object` is 0 unless it is given. Throws InputError.
Motion read_motion(const Settings& table, const PathPoints& points, const Scene& scene);

}  // namespace vislab
