// Classes of directions: a cube around the sphere of normals, each side cut into n x n squares.
//
// Why a class may be tested by its corners. Let a square's corners be c1 … c4 on the cube's surface
//   and those of a part of the view d1 … d4, directions from the eye. A normal of the class points
//   along a sum of the c with weights of 0 and more (the square is their convex hull), a vector
//   from the eye to a point of that part along such a sum of the d. So if all 16 products
//   c . d are greater than 0, the product of normal and vector is greater than 0 as well: the
//   triangle faces away, wherever in that part it is. One point of a triangle is enough, because
//   the product is the same for all points of its plane.
// Under rounding. class_of() computes a normal in double, from float vertices. Each of its parts is
//   off by at most 4.01 x 2^-53 of the sum s of the absolute products that make it up, so the two
//   quotients that choose the square are off by less than 2^-22 as long as the greatest part is
//   more than 2^-28 s; a triangle thinner than that (or without area) has no class. Squares are
//   therefore taken as larger by 2^-20 on all sides, which also covers that their corners are
//   rounded to float (2^-25): a quotient that falls beside its square, or on the neighbouring side
//   of the cube, still lies in the enlarged one. The product with a direction whose parts are at
//   most 1 changes by at most 2 x (2^-20 + 2^-25) from a corner to the enlarged corner, by 3 e if
//   each part of the direction is off by e, and by 7 x 2^-24 in four float operations: more than
//   2^-18 + 3 e in float means more than 0.
// Source: Zhang and Hoff 1997; Zachmann, Computer-Graphik 2, SS 2012, slides 13-18.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "algorithms/backface/mask_kernel.h"
#include "common/scene/scene.h"

namespace vislab::backface_culling {

/// Where a class of normals is tested.
enum class ClassTest {
  corners,  // at the four corners of its square: all of its normals
  centre    // at the middle only, without a margin: wrong, for a negative control (F20)
};

/// A direction in a mesh's frame, scaled so that no part exceeds 1, and a bound on the error of
/// each part. Not finite: nothing is known.
struct MeshDirection {
  glm::vec3 direction{0.0F};
  float error = 0.0F;
};

class DirectionCube {
 public:
  /// One byte says which of 256 bytes holds a class, and 8 classes are in each: 2,048 classes are
  /// enough for n = 18 (1,944), and not for 19.
  static constexpr int max_n = 18;

  /// Throws InputError if n is not 1 … 18.
  explicit DirectionCube(int n, ClassTest test = ClassTest::corners);

  int n() const { return n_; }
  int class_count() const { return 6 * n_ * n_; }

  /// The class of a normal, whose parts are off by at most `error` each; nothing if that is too
  /// much to tell, as for 0.
  std::optional<int> class_of(const glm::dvec3& normal, double error) const;
  /// The class of a triangle's normal (eq. 2.1), counter-clockwise in the mesh; nothing if the
  /// triangle has no area or is too thin to tell.
  std::optional<int> class_of(const Mesh& mesh, std::uint32_t triangle) const;

  /// Corners of the square of a class on the cube [-1, 1]^3, in float as they are tested.
  std::array<glm::vec3, 4> corners(int class_index) const;

  /// The classes all of whose normals n have n . v > 0 for the direction v: triangles with such
  /// normals face away from an eye that looks along v at one of their points. About 0.5 us.
  BackMask facing_away(const MeshDirection& v) const;

 private:
  int n_;
  ClassTest test_;
  // Where rows and columns are tested: n + 1 lines, or with ClassTest::centre n middles.
  std::vector<float> lines_;
};

/// Classes that are in all of them.
BackMask operator&(const BackMask& a, const BackMask& b);

}  // namespace vislab::backface_culling
