// Potentially visible sets: which cells can be seen from anywhere in a cell.
//
// Idea: what is seen from a cell is seen along a line that crosses a sequence of portals. From each
//   portal as a source, sequences are followed as deep as a line can cross them: planes that
//   separate the source from the portal last passed bound all lines through both, and what they
//   leave of the next portal is passed in turn; the source is cut in the same way seen from there.
//   What can at best be seen behind each portal is found first by the portals' sides alone; a
//   sequence that can add nothing to what its source is known to see is not followed.
// Guarantee: conservative but for gaps narrower than a hundredth of a millimetre: no cell is left
//   out that a line in space reaches through portals. Nothing is known of what stands in the cells.
//   Cells need not be convex. A source whose sequences are too many to follow (`given_up`) sees all
//   that the sides of the portals allow.
// Cost: O(portals^2) for the sides; sequences are exponential in the worst case, and bounded by
//   PvsLimits. Portals go by batches, the ones that see least first, and what a batch has found
//   bounds the next: hence the answer does not depend on the number of threads.
// Sources: Teller and Sequin 1991, Visibility Preprocessing for Interactive Walkthroughs; the
//   portal flow of Quake's vis (id Software 1996), as to bounding sets and separating planes.
#pragma once

#include <cstdint>

#include "algorithms/portal/portal_graph.h"
#include "algorithms/portal/pvs_rows.h"

namespace vislab::portal_culling {

struct PvsLimits {
  /// Portals passed from one source before it is given up.
  std::uint64_t most_passes = 20'000'000;
  int threads = 1;
};

struct PvsTable {
  /// A row for each cell; each cell sees itself. Symmetric if every portal has one with the same
  /// corners that leads back.
  CompressedRows cells;
  std::uint64_t passes = 0;    // portals passed, from all sources
  std::uint64_t given_up = 0;  // sources
};

PvsTable find_visible_cells(const PortalGraph& graph, const PvsLimits& limits);

}  // namespace vislab::portal_culling
