// meshoptimizer's clusters and cones, used as its documentation shows.
#pragma once

#include <meshoptimizer.h>

#include <cstdint>
#include <vector>

#include "common/scene/scene.h"
#include "experiments/bench/backface/cone_rows.h"

namespace vislab {

class Meshlets {
 public:
  /// Meshlets of at most 64 vertices and 64 triangles, made for cones alone (weight 1): what
  /// catches most of the sizes that were tried.
  explicit Meshlets(const Mesh& mesh);

  /// The test of its header for perspective, in a loop over all cones:
  ///   dot(normalize(cone_apex - camera_position), cone_axis) >= cone_cutoff
  /// with the length on the other side, which compiles to a faster loop than the division.
  /// Returns how many meshlets are kept; their numbers are in kept().
  std::size_t test(const glm::dvec3& eye);
  const std::vector<std::uint32_t>& kept() const { return kept_; }

  /// The same test as a loop that the compiler turns into AVX2 where it can: numbers in rows, a
  /// byte for each meshlet. Nothing that meshoptimizer offers, but what its user can make of it.
  void test_rows(const glm::dvec3& eye);

  std::size_t count() const { return meshlets_.size(); }
  /// Sets the bits of the mesh's triangles that are in no kept meshlet.
  void mark_left_out(std::size_t kept_count, std::vector<std::uint64_t>& bits) const;

 private:
  std::vector<meshopt_Meshlet> meshlets_;
  std::vector<meshopt_Bounds> bounds_;
  std::vector<std::uint32_t> triangles_;  // of the mesh, meshlet by meshlet
  std::vector<std::uint32_t> first_;      // by meshlet, and the end
  std::vector<std::uint32_t> kept_;
  ConeRows rows_;
  std::vector<std::uint8_t> culled_;  // by meshlet, of test_rows()
};

}  // namespace vislab
