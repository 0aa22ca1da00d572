// The walk of a WideBvh against the planes of a frustum, compiled for each instruction set.
#pragma once

#include "common/geometry/frustum_filter.h"
#include "common/spatial/wide_bvh.h"

namespace vislab {

/// The parts of a hierarchy that a walk reads. `objects` can be read eight ids beyond its end.
struct WideBvhView {
  const WideNode* nodes;
  const BoxBlock* leaves;
  const ObjectId* objects;
};

/// Adds to `out` what is surely kept, and to out.undecided what double has to decide. Runs of at
/// least `shortest_run` objects go to out.places, others to out.loose, which must have room for all
/// objects and eight more. Takes no heed of which objects are present: absent ones have no box.
void walk_wide_bvh(const WideBvhView& tree, const FrustumFilter& filter,
                   const WideBvh::QueryOptions& options, std::uint32_t shortest_run,
                   WideSelection& out);

}  // namespace vislab
