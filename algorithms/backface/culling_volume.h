// From how much of space a cluster is seen from behind, and whether two clusters should be one.
//
// Idea: the test of a cluster is one half-space in each octant about its origin; the part of a box
//   of possible eyes that lies in them, octant by octant, is the probability P that the cluster is
//   culled. Two clusters are joined if the expected time to test and draw them becomes less.
// Sources: Zachmann slides 24, 27-29. The culling volume is closed only if n < 0 < m and d > 0: for
// a
//   flat patch it is not, so it has to be clipped to the box of possible eyes.
#pragma once

#include "algorithms/backface/cluster_bound.h"

namespace vislab::backface_culling {

/// Volume of the points of a box from which if(e - c; n, m).(e - c) <= d, in closed form. Of an
/// empty box, 0. Both in the same unit.
double culling_volume(const ClusterBound& bound, const Aabb& box);

/// Which sign stands before t_C / r in the rule for joining.
enum class JoinRule {
  derived,  // P(C) > (P(A) n_A + P(B) n_B - t_C / r) / (n_A + n_B): what T(C) < T(A) + T(B) gives
  printed   // + t_C / r, as slide 29 has it: joins next to nothing
};

/// A cluster as the cost model sees it.
struct ClusterOdds {
  double probability = 0.0;  // P: of being culled
  double triangles = 0.0;    // n
};

/// Are A and B better tested and drawn as the one cluster C? `test_cost` is t_C / r: the time of a
/// test in that of drawing a triangle.
bool should_join(const ClusterOdds& a, const ClusterOdds& b, double joined_probability,
                 double test_cost, JoinRule rule);

}  // namespace vislab::backface_culling
