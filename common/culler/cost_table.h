// What drawing and testing cost on this machine: for methods that weigh one against the other, and
// for modelled times.
#pragma once

#include <span>
#include <string_view>

namespace vislab {

/// By the least of several times, and the quartiles of what single turns gave.
struct Cost {
  double ns = 0.0;
  double low_ns = 0.0, high_ns = 0.0;

  static constexpr Cost exactly(double ns) { return {ns, ns, ns}; }
  friend bool operator==(const Cost&, const Cost&) = default;
};

/// Measured by the harness and handed to cullers in BuildContext; nothing here reads a clock.
struct CostTable {
  Cost triangle;  // one more small triangle in a draw of one piece, until it is in the image
  Cost draw;      // one more object in a call of RenderDevice::draw, without its triangles
  Cost piece;     // one more piece of a mesh in an object's draw: its indices are copied together
  Cost cluster_test;  // one test of a cluster of triangles against an eye

  /// t_C / r of the cost model (Zachmann slides 28, 29).
  double cluster_test_over_triangle() const { return cluster_test.ns / triangle.ns; }

  /// Declared figures, near those of a processor of 2020 that draws itself. What is built from them
  /// does not depend on the machine.
  static CostTable typical();

  friend bool operator==(const CostTable&, const CostTable&) = default;
};

/// A figure of the table by name, for what is stored and shown.
struct CostQuantity {
  std::string_view name;
  Cost CostTable::*cost;
  std::string_view meaning;
};
std::span<const CostQuantity> cost_quantities();

}  // namespace vislab
