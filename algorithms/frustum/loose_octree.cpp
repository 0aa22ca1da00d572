// frustum.loose_octree: walks an octree for moving objects, strict or with cells that overlap.
//
// Idea: an object stands at the smallest node that holds its bounding sphere; node boxes are
//   enlarged by `overlap`. With overlap=0 objects on the main planes stay in the root, and with
//   intersecting=keep they are then always drawn, as in the report. Objects that move climb from
//   their node as far as they must and sink again.
// Guarantee: conservative. With intersecting=refine the same as frustum.flat with the same test.
// Cost: O(nodes that the frustum's planes cut + objects at them); update O(moved objects), each a
//   few levels.
// Limits: as overlap grows, fewer objects stay near the root, but the enlarged nodes touch the
//   frustum more often: there is a best value for each scene. Objects outside of the root that was
//   laid around the scene as built are tested one by one until they are the majority.
// Sources: Gschwantner and Hebart 2007 (engine report), 2.2.1-2.2.3 and 3; Ulrich 2000, Loose
// Octrees.

#include "common/spatial/loose_octree.h"
#include "algorithms/frustum/structure_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using frustum_culling::StructureCuller;

CullerInfo describe() {
  constexpr auto build = ParameterSpec::Stage::build;
  CullerInfo info = frustum_culling::structure_culler_info(
      "frustum.loose_octree", Repeatability::stateless,
      {ParameterSpec::real("overlap", 5.0, 0.0, 1e9, "m", build,
                           "by how much node boxes are enlarged on each side: 0 is strict and "
                           "leaves what straddles planes near the root, 5 is the report's value, "
                           "half a cell's edge is Ulrich's loose octree on that level; too great "
                           "and nodes touch the frustum more often"),
       ParameterSpec::integer("depth", 5, 0, 20, "levels", build,
                              "how often cells are halved at most"),
       ParameterSpec::real("min_cell", 0.0, 0.0, 1e9, "m", build,
                           "cells are not halved into smaller ones"),
       ParameterSpec::integer("leaf_size", 64, 0, 1'000'000, "objects", build,
                              "a cell with so many objects is not halved; 0 puts each object into "
                              "the smallest cell that holds it, as in the report")},
      frustum_culling::node_policy_parameter());
  info.summary =
      "Walks an octree for moving objects, each at the smallest node that holds its sphere, with "
      "nodes enlarged by an overlap.";
  info.cost =
      "O(nodes that the frustum's planes cut + objects at them); update O(moved objects), each a "
      "few levels";
  info.limits =
      "Without overlap, objects on the main planes are looked at in every frame; with much of it, "
      "too many nodes touch the frustum. Objects outside of the root are tested one by one.";
  info.sources = {"Gschwantner and Hebart 2007 (engine report), 2.2.1-2.2.3 and 3",
                  "Ulrich 2000, Loose Octrees (Game Programming Gems)",
                  "Assarsson and Moeller 2000, Optimized View Frustum Culling Algorithms for "
                  "Bounding Boxes"};
  return info;
}

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  LooseOctree::Limits limits;
  limits.overlap_m = values.real("overlap");
  limits.depth = static_cast<int>(values.integer("depth"));
  limits.least_edge_m = values.real("min_cell");
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return std::make_unique<StructureCuller<LooseOctree>>(describe(), limits, values);
}

}  // namespace

namespace cullers {

CullerEntry frustum_loose_octree() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
