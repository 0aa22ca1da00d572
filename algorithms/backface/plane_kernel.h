// Many planes against one eye: which triangles are surely seen from behind, 64 to a word.
//
// Layout: the four numbers of the planes in an array each, 16 bytes a triangle, so that a run of
//   triangles may begin anywhere and every access is one run of floats.
// Guarantee: conservative. The float value decides only beyond behind_limit_float; what lies nearer
//   to a plane is not marked. Products and sums are rounded one by one and in a fixed order, so
//   that every instruction set gives the same bits. Coordinates are scaled by powers of two, so
//   that meshes of any size and eyes at any distance stay far from the ends of float.
// Cost: four multiplications and three additions a triangle; for large meshes the time it takes to
//   read 16 bytes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "algorithms/backface/mesh_eye.h"
#include "common/spatial/huge_pages.h"

namespace vislab::backface_culling {

/// scaled_plane of a triangle, its distance in terms of MeshFrame::unit(), rounded to float.
std::array<float, 4> rounded_plane(const Mesh& mesh, const MeshFrame& frame,
                                   std::uint32_t triangle);

/// The rounded planes of a mesh's triangles.
class PlaneArrays {
 public:
  /// O(triangles).
  PlaneArrays(const Mesh& mesh, const MeshFrame& frame);

  std::uint32_t count() const { return count_; }
  /// The rows of x, y, z of the normals and of the distances; each may be read
  /// up to `padding` floats beyond its end.
  const float* row(std::size_t i) const { return values_.data() + i * count_; }
  std::size_t bytes() const { return values_.capacity() * sizeof(float); }

  static constexpr std::size_t padding = 16;

 private:
  std::uint32_t count_;
  std::vector<float, HugePageAllocator<float>> values_;
};

/// The eye as the kernel takes it, in the units of one mesh's planes: a triangle is surely seen
/// from behind if (n.x x + n.y y) + (n.z z + d w) < -limit.
struct PlaneTest {
  float x = 0.0F, y = 0.0F, z = 0.0F, w = 0.0F, limit = 0.0F;
};

PlaneTest plane_test(const MeshEye& eye, const MeshFrame& frame);

/// Writes words_of(count) words to `back`: bit i tells that triangle first + i is surely seen from
/// behind; bits beyond `count` are 0. first + count <= planes.count().
void mark_behind(const PlaneArrays& planes, const PlaneTest& test, std::uint32_t first,
                 std::uint32_t count, std::uint64_t* back);

/// The same bits, one triangle after the other.
void mark_behind_scalar(const PlaneArrays& planes, const PlaneTest& test, std::uint32_t first,
                        std::uint32_t count, std::uint64_t* back);

}  // namespace vislab::backface_culling
