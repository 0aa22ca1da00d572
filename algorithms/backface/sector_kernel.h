// Which part of the view each of many boxes is seen in.
//
// The plane at distance 1 in front of the eye is cut by lines across and along; a box's rectangle
// are the lines around what is seen of it. Boxes are in a mesh's frame, relative to its middle,
// one coordinate a row, and tested many at a time.
// Guarantee: a rectangle holds the direction to every point of its box, under rounding: quotients
//   are widened by more than their error. Float operations are rounded one by one and in a fixed
//   order, so that every instruction set gives the same rectangles.
// Cost: about 150 float operations a box, 4 to 16 boxes at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/mesh_eye.h"

namespace vislab::backface_culling {

/// Boxes around some points of a mesh, relative to its middle.
class PointBoxes {
 public:
  static constexpr std::size_t padding = 16;

  explicit PointBoxes(std::size_t count = 0);

  std::size_t count() const { return count_; }
  /// Makes box `box` hold the point.
  void add(std::size_t box, const glm::dvec3& point);
  /// Rows: min x, y, z, max x, y, z; each may be read up to `padding` floats beyond its end.
  const float* row(std::size_t i) const { return values_.data() + i * stride_; }
  std::size_t bytes() const { return values_.capacity() * sizeof(float); }

 private:
  std::size_t count_;
  std::size_t stride_;
  std::vector<float> values_;
};

/// From a mesh's frame, relative to its middle, to a camera's: x to the right, y up, z forward.
struct CameraRows {
  float x[4], y[4], z[4];  // factors of the three coordinates, and what is added
  float error = 0.0F;      // bound on the error of x, y and z as computed in float
};

/// Takes points that an object places by `transform` to the frame of a camera.
CameraRows camera_rows(const Camera& camera, const glm::dmat4x3& transform, const MeshFrame& mesh);

/// Numbers of lines: what is seen lies between x lines `left` and `right`, and y lines `bottom` and
/// `top`. `right` is 0 where nothing is known: the box reaches beyond the last lines, or to where
/// there is no quotient, beside or behind the eye.
struct Rectangle {
  std::uint8_t left = 0, right = 0, bottom = 0, top = 0;

  bool known() const { return right != 0; }
  /// Between neighbouring lines.
  bool is_one_sector() const { return right == left + 1 && top == bottom + 1; }
  friend bool operator==(const Rectangle&, const Rectangle&) = default;
};

/// The lines x / z = const and y / z = const, ascending, at most 255 of each.
struct ViewLines {
  std::vector<float> x, y;
};

/// Rectangles of the boxes [first, first + count), to `rectangles`.
void find_rectangles(const CameraRows& rows, const ViewLines& lines, const PointBoxes& boxes,
                     std::size_t first, std::size_t count, Rectangle* rectangles);

/// The same, one box after the other.
void find_rectangles_scalar(const CameraRows& rows, const ViewLines& lines, const PointBoxes& boxes,
                            std::size_t first, std::size_t count, Rectangle* rectangles);

}  // namespace vislab::backface_culling
