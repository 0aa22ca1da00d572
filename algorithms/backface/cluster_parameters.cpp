#include "algorithms/backface/cluster_parameters.h"

#include "algorithms/backface/facing_culler.h"

namespace vislab::backface_culling {

std::vector<ParameterSpec> cluster_parameters(std::uint32_t size) {
  using Stage = ParameterSpec::Stage;
  return {
      ParameterSpec::integer(
          "size", size, 1, 65536, "triangles", Stage::build,
          "triangles in a cluster before the cost model joins any; small meshes get smaller ones. "
          "Larger: fewer tests and less memory, but fewer clusters face one way"),
      ParameterSpec::choice(
          "origin", "centre", {"mesh", "centre", "best"}, Stage::build,
          "the origin about which a cluster is tested: that of its mesh, the middle of its box, or "
          "whichever of that and the corners makes d greatest. With mesh, nothing is culled in "
          "meshes far from their own origin"),
      ParameterSpec::real(
          "eye_distance", ClusterSettings().eye_distance, 2.0, 1e6, "mesh sizes", Stage::build,
          "how far eyes usually are, in half the longest side of the mesh's box. Smaller: clusters "
          "are tighter in space; larger: in their normals"),
      ParameterSpec::choice(
          "costs", "typical", {"typical", "measured"}, Stage::build,
          "what the cost model takes the test of a cluster and the drawing of a triangle to cost: "
          "declared figures, or those of this machine, with which answers depend on it"),
      open_parameter()};
}

ClusterSettings cluster_settings(const ParameterValues& values, const BuildContext& context) {
  ClusterSettings settings;
  settings.size = static_cast<std::uint32_t>(values.integer("size"));
  settings.eye_distance = values.real("eye_distance");
  const std::string& origin = values.choice("origin");
  settings.origin = origin == "mesh"     ? Origin::mesh
                    : origin == "centre" ? Origin::centre
                                         : Origin::best;
  const bool measured = values.choice("costs") == "measured" && context.costs != nullptr;
  const CostTable costs = measured ? *context.costs : CostTable::typical();
  settings.test_cost = costs.cluster_test_over_triangle();
  return settings;
}

}  // namespace vislab::backface_culling
