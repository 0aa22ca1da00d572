// Many small things that are as large together as one: for methods that ask each object for its
// size. Like all generators' scenes: the same everywhere for the same parameters, y up, metres, not
// finished yet (Scene::finish). The keys of a description's table `generator` are the members'
// names.
#pragma once

#include <cstdint>

#include "common/scene/scene.h"

namespace vislab {

struct SwarmParameters {
  std::uint32_t count = 1000;
  double area_m2 = 100.0;  // of the discs as which the things' spheres are seen, in sum
  double width_m = 20.0;   // of the square, seen along z, in which their middles lie
  double depth_m = 10.0;   // over which they are spread along z
  std::uint64_t seed = 1;
};

/// Cubes in random places and orientations about the origin, all of one size, which goes with
/// 1 / sqrt(count). Their places do not depend on the count: a larger swarm has those of a smaller
/// one, too. They may overlap.
Scene make_swarm(const SwarmParameters& parameters);

}  // namespace vislab
