#include "common/culler/cost_table.h"

#include <array>

namespace vislab {

CostTable CostTable::typical() {
  CostTable table;
  table.triangle = Cost::exactly(250.0);
  table.draw = Cost::exactly(260.0);
  table.piece = Cost::exactly(200.0);
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
