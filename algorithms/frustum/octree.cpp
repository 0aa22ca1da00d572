// frustum.octree: walks an octree that has every object in all the leaves it touches.
//
// Idea: the cube around the scene is halved into octants until a leaf is small or has few objects.
//   Octants outside of the frustum are skipped, those inside are taken with all their objects
//   untested, and objects in leaves that the frustum cuts are tested. An object in several leaves
//   is looked at once.
// Guarantee: conservative. What is kept is a subset of what frustum.flat with the same test keeps:
// an
//   object all of whose leaves are outside is left out, even if it is outside of no single plane.
// Cost: O(nodes that the frustum's planes cut + entries in leaves that are not outside).
// Limits: objects that are large beside the leaves are entered into many of them; a query pays for
//   each entry. Too shallow: many objects to test. Too deep: many nodes and entries (the U-curve of
//   the thesis). Moving objects leave and enter all their leaves.
// Sources: Kowalka 2016 (thesis, HAW Hamburg), 2.5.4, 4.1; Assarsson and Moeller 2000.

#include "algorithms/frustum/structure_culler.h"
#include "common/culler/registry.h"
#include "common/spatial/leaf_octree.h"

namespace vislab {
namespace {

using frustum_culling::StructureCuller;

CullerInfo describe() {
  CullerInfo info = frustum_culling::structure_culler_info(
      "frustum.octree", Repeatability::path,
      {ParameterSpec::integer(
           "depth", 4, 0, 16, "levels", ParameterSpec::Stage::build,
           "how often cells are halved at most; too small leaves many objects to "
           "test, too great makes many nodes and entries"),
       ParameterSpec::integer("leaf_size", 64, 1, 1'000'000, "objects", ParameterSpec::Stage::build,
                              "a leaf with so many objects is not halved")},
      frustum_culling::node_policy_parameter());
  info.summary =
      "Walks an octree over the scene with each object in all the leaves it touches; octants "
      "outside of the frustum are skipped, those inside taken whole.";
  info.cost = "O(nodes that the frustum's planes cut + entries in leaves that are not outside)";
  info.limits =
      "Large objects are in many leaves; moving objects are costly. Keeps what is outside of the "
      "frustum but whose leaves and box are outside of no single plane.";
  info.sources = {"Kowalka 2016 (thesis, HAW Hamburg), 2.5.4 and 4.1",
                  "Assarsson and Moeller 2000, Optimized View Frustum Culling Algorithms for "
                  "Bounding Boxes"};
  return info;
}

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  LeafOctree::Limits limits;
  limits.depth = static_cast<int>(values.integer("depth"));
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return std::make_unique<StructureCuller<LeafOctree>>(describe(), limits, values);
}

}  // namespace

namespace cullers {

CullerEntry frustum_octree() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
