// Groups of things that are probably hidden, each to be confirmed by one query.
//
// Idea: if several things are hidden, one query for the boxes of all says so; if one of them is
//   not, the query was in vain and they are asked about one by one. So they are taken in the order
//   of how likely they are to stay hidden, and as many form a group as make its expected value, its
//   benefit divided by its cost, greatest; then the next group is begun.
//   With i(M) the product of the chances p(t) of what is in group M:
//     slides: cost 1 + c1 · boxes in M, benefit i(M) · triangles in M (a constant factor c2 changes
//             no maximum);
//     paper:  cost 1 + (1 - i(M)) · |M|, benefit |M|: so many queries in place of |M|.
// Guarantee: each group is the prefix of greatest value among all prefixes of what is left; of
// equal
//   ones the shortest. Everything is in exactly one group.
// Cost: O(b log b) for sorting b candidates, O(b) at most a group; no allocation once `ends` is
// long
//   enough. Scanning ends as soon as no longer prefix can be better.
// Limits: greedy: the groups together need not be the best of all ways to divide the candidates;
//   the chances are taken as independent, which neighbours are not.
//   By the paper's model the value of a hopeless group grows to 1 with its size: what is likely
//   visible is asked about together, where the slides' model asks about it alone.
// Sources: Zachmann, Computer-Graphik 2, SS 2012, slides 64-68 (slides); Mattausch, Bittner, Wimmer
//   2008, CHC++, section 4 (paper), as the engine guacamole has it too.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/occlusion/persistence.h"

namespace vislab::occlusion_culling {

enum class MultiqueryCost { slides, paper };

struct MultiqueryModel {
  MultiqueryCost cost = MultiqueryCost::paper;
  /// c1 of the slides' model: what a box costs, as a share of what a query costs besides.
  double box_cost = 0.1;
};

/// Something that was hidden and is to be asked about.
struct MultiqueryCandidate {
  std::uint32_t hidden_frames = 0;  // without a break, before this frame
  std::uint32_t triangles = 0;      // not drawn if it is hidden; read by the slides' model
  std::uint32_t boxes = 1;          // that its query has; read by the slides' model
  std::uint32_t id = 0;             // the caller's, different for each; decides ties
};

/// Sorts `candidates` (longest hidden first, then by id) and divides them into groups: group g is
/// candidates[ends[g - 1] … ends[g] - 1], the first from 0. `ends` is overwritten; empty for none.
void group_multiqueries(const MultiqueryModel& model, const Persistence& persistence,
                        std::span<MultiqueryCandidate> candidates,
                        std::vector<std::uint32_t>& ends);

}  // namespace vislab::occlusion_culling
