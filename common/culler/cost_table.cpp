#include "common/culler/cost_table.h"

#include <array>

namespace vislab {

CostTable CostTable::typical() {
  CostTable table;
  table.triangle = Cost::exactly(250.0);
  table.draw = Cost::exactly(260.0);
  table.piece = Cost::exactly(200.0);
  // The kernel of backface.cluster as runs calibrate it, bounds in the first cache, on a processor
  // of 2023: 1.07 ns with AVX2, which is what is declared; 0.2 ns with AVX-512, 2.2 ns with SSE4. A
  // test in a walk down backface.cluster_tree, on meshes of 75,000 to a million triangles, takes
  // 1.1 to 1.6 ns with AVX-512. Little depends on it: from 0.1 to 5 ns the bunny and the bumpy
  // spheres of a million triangles get the same clusters.
  table.cluster_test = Cost::exactly(1.0);
  return table;
}

std::span<const CostQuantity> cost_quantities() {
  static constexpr std::array table = {
      CostQuantity{"triangle", &CostTable::triangle, "one small triangle drawn, in long runs (r)"},
      CostQuantity{"draw", &CostTable::draw, "one object drawn, without its triangles"},
      CostQuantity{"piece", &CostTable::piece, "one more piece of a mesh that is drawn in several"},
      CostQuantity{"cluster_test", &CostTable::cluster_test,
                   "one cluster of triangles tested against the eye (t_C)"},
  };
  return table;
}

}  // namespace vislab
