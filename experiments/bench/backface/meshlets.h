// Tests of the cones of meshoptimizer's clusters (algorithms/peers/meshopt_meshlets.h), without
// what peer.meshopt_cones does before and after them.
#pragma once

#include <cstdint>
#include <vector>

#include "algorithms/peers/meshopt_meshlets.h"
#include "experiments/bench/backface/cone_rows.h"

namespace vislab {

class Meshlets {
 public:
  /// How the test of meshoptimizer's header for perspective is written,
  ///   dot(normalize(cone_apex - camera_position), cone_axis) >= cone_cutoff
  /// with the length on the other side, which is faster than the division.
  enum class Form {
    loop,  // over all cones as the library gives them; makes a list of those kept
    rows   // ConeRows: nothing that meshoptimizer offers, but what its user can make of it
  };

  /// Meshlets of at most 64 vertices and 64 triangles, made for cones alone (weight 1): what
  /// catches most of the sizes that were tried.
  Meshlets(const Mesh& mesh, Form form);

  void test(const glm::dvec3& eye);
  /// Sets the bits of the mesh's triangles in meshlets that the last test() culled.
  void mark_left_out(std::vector<std::uint64_t>& bits) const;

 private:
  void test_loop(const glm::vec3& camera);
  std::vector<bool> culled() const;

  Form form_;
  peers::MeshoptMeshlets meshlets_;
  std::vector<std::uint32_t> kept_;  // numbers of meshlets, by test_loop()
  std::size_t kept_count_ = 0;
  ConeRows rows_;
  std::vector<std::uint8_t> culled_bits_;  // a bit a meshlet, of the rows
};

}  // namespace vislab
