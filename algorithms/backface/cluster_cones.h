// Many cones of normals against one eye: which clusters are surely seen from behind, 64 to a word.
//
// Layout: blocks of 64 clusters, each number a row of 64 floats: 28 bytes a cluster with an apex,
//   32 with a sphere.
// Test: with w = apex - eye, t = axis . w - limit: t > 0 and t^2 >= sine^2 |w|^2. With a sphere,
//   w = centre - eye and t is less by the radius. Orthographic: w is the direction away from the
//   viewer for all clusters, and there is no radius.
// Guarantee: conservative. The axis is what its floats say, and the sine is measured around it; the
//   apex is checked after rounding; the sine is enlarged by what the float sums may be wrong by in
//   terms of |w|, and the limit by what the eye may be off. Products and sums are rounded one by
//   one and in a fixed order, so that every instruction set gives the same bits. Coordinates are
//   scaled by a power of two, so that squares stay far from the ends of float.
// Cost: nine multiplications, eight additions and two comparisons a cluster, no root.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// What bounds the places of a cluster's triangles.
enum class ConeForm {
  apex,   // a point behind all planes
  sphere  // a sphere around the triangles
};

/// The cones of a mesh's clusters.
class ClusterCones {
 public:
  ClusterCones(ConeForm form, const MeshFrame& frame);

  /// Appends a cluster. `planes` as unit_plane gives them, `vertices` relative to the mesh's middle
  /// (to the rounding of double); these are only looked at for ConeForm::sphere. A cluster without
  /// a cone is never seen from behind.
  void add(std::span<const glm::dvec4> planes, std::span<const glm::dvec3> vertices);
  /// Appends a cluster that is never seen from behind.
  void add_untested();

  std::uint32_t count() const { return count_; }
  ConeForm form() const { return form_; }
  /// A power of two that no coordinate of the mesh relative to its middle exceeds.
  double unit() const { return unit_; }
  std::size_t bytes() const {
    return apexes_.capacity() * sizeof(Block<7>) + spheres_.capacity() * sizeof(Block<8>);
  }

  enum Row { axis_x, axis_y, axis_z, point_x, point_y, point_z, squared_sine, radius };
  template <std::size_t rows>
  struct alignas(64) Block {
    std::array<std::array<float, 64>, rows> row;
  };
  /// One block for each 64 clusters; what is beyond count() is never seen from behind.
  std::span<const Block<7>> apexes() const { return apexes_; }
  std::span<const Block<8>> spheres() const { return spheres_; }

 private:
  float& at(Row row);

  ConeForm form_;
  double unit_;
  std::uint32_t count_ = 0;
  std::vector<Block<7>> apexes_;   // ConeForm::apex
  std::vector<Block<8>> spheres_;  // ConeForm::sphere
};

/// What the clusters of cones are made with.
ClusterSettings cone_clusters(std::uint32_t size = 8);

/// The cones of the clusters below `tested`. O(triangles) expected.
ClusterCones cones_of(const Mesh& mesh, const MeshFrame& frame, const TriangleClusters& clusters,
                      ConeForm form);

/// The eye as the kernel takes it, in units of the cones.
struct ConeEye {
  float x, y, z;  // perspective: the eye; orthographic: the direction to the viewer
  float limit;    // infinite if nothing can be told
  bool perspective;

  ConeEye(const MeshEye& eye, double unit);
};

/// Writes words_of(cones.count()) words: bit i tells that cluster i is surely seen from behind;
/// bits beyond count() are 0.
void mark_cones(const ClusterCones& cones, const ConeEye& eye, std::uint64_t* back);

/// The same bits, one cluster after the other.
void mark_cones_scalar(const ClusterCones& cones, const ConeEye& eye, std::uint64_t* back);

}  // namespace vislab::backface_culling
