// frustum.bsp: walks a binary partition of the objects by axis-aligned planes.
//
// Idea: planes across one axis part the objects; what straddles a plane stays at its node, goes to
//   both sides, or goes where its centre is. Nodes are known by the tight boxes of what is in them:
//   those outside of the frustum are skipped, those inside taken whole.
// Guarantee: conservative. With intersecting=refine the same as frustum.flat with the same test;
// with
//   straddlers=both a subset of that, because the parts of an object may be outside of different
//   planes.
// Cost: O(nodes that the frustum's planes cut + objects in leaves that are not outside).
// Limits: planes stay where they were when a leaf was split: objects that move far and all together
//   make the tree unbalanced, and only reset() builds it anew.
// Sources: Kowalka 2016 (thesis, HAW Hamburg), 2.5.3; MacDonald and Booth 1990.

#include "common/spatial/bsp.h"
#include "algorithms/frustum/structure_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using frustum_culling::StructureCuller;

CullerInfo describe() {
  constexpr auto build = ParameterSpec::Stage::build;
  CullerInfo info = frustum_culling::structure_culler_info(
      "frustum.bsp", Repeatability::stateless,
      {ParameterSpec::choice("straddlers", "centre", {"node", "both", "centre"}, build,
                             "objects across a plane stay at its node and are looked at whenever "
                             "it is cut, go into both children and are met twice, or go where "
                             "their centre is, and the children's boxes overlap"),
       ParameterSpec::choice(
           "split", "cost", {"midpoint", "median", "cost"}, build,
           "planes halve the box of a node, halve its objects, or are the best of "
           "45 by the surface-area heuristic"),
       ParameterSpec::integer("depth", 24, 0, 48, "levels", build,
                              "how often nodes are split at most"),
       ParameterSpec::integer("leaf_size", 64, 1, 1'000'000, "objects", build,
                              "a leaf with so many objects is not split")},
      frustum_culling::node_policy_parameter());
  info.summary =
      "Walks a binary partition of the objects by axis-aligned planes; nodes outside of the "
      "frustum "
      "are skipped, those inside taken whole.";
  info.cost = "O(nodes that the frustum's planes cut + objects in leaves that are not outside)";
  info.limits =
      "Planes are not chosen again when objects move. Keeps what is outside of the frustum but of "
      "no single plane.";
  info.sources = {"Kowalka 2016 (thesis, HAW Hamburg), 2.5.3",
                  "Fuchs, Kedem and Naylor 1980, On Visible Surface Generation by A Priori Tree "
                  "Structures",
                  "MacDonald and Booth 1990, Heuristics for Ray Tracing Using Space Subdivision"};
  return info;
}

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  AxisBsp::Limits limits;
  const std::string& straddlers = values.choice("straddlers");
  if (straddlers == "node") limits.straddlers = AxisBsp::Straddlers::node;
  if (straddlers == "both") limits.straddlers = AxisBsp::Straddlers::both;
  if (straddlers == "centre") limits.straddlers = AxisBsp::Straddlers::centre;
  const std::string& split = values.choice("split");
  if (split == "midpoint") limits.split = AxisBsp::Split::midpoint;
  if (split == "median") limits.split = AxisBsp::Split::median;
  if (split == "cost") limits.split = AxisBsp::Split::cost;
  limits.depth = static_cast<int>(values.integer("depth"));
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return std::make_unique<StructureCuller<AxisBsp>>(describe(), limits, values);
}

}  // namespace

namespace cullers {

CullerEntry frustum_bsp() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
