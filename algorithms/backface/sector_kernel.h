// Which part of the view each of many boxes is seen in.
//
// The plane at distance 1 in front of the eye is cut by lines across and along; a box's rectangle
// are the lines around what is seen of it. Boxes are in a mesh's frame, relative to its middle,
// one coordinate a row, and tested many at a time. Coordinates are taken to a frame in which lines
// are at whole numbers, so that a quotient has only to be rounded down or up.
// Guarantee: a rectangle holds the direction to every point of its box, under rounding: quotients
//   are widened by more than their error. Float operations are rounded one by one and in a fixed
//   order, so that every instruction set gives the same rectangles.
// Cost: about 150 float operations a box, 4 to 16 boxes at a time.
#pragma once

#include <bit>
#include <cstdint>
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
  const float* row(std::size_t i) const { return values_.data() + i * count_; }
  std::size_t bytes() const { return values_.capacity() * sizeof(float); }

 private:
  std::size_t count_;
  std::vector<float> values_;
};

/// The lines of a perspective view. From line `lines_beyond` on, `sectors` + 1 lines cut it into
/// equal parts, the first and the last at its borders. The others lie beyond the borders, each step
/// twice as wide as the one before: 1, 2, 4, 8, 16 parts.
class SectorLines {
 public:
  static constexpr int lines_beyond = 5;
  static constexpr int most_sectors = 32;

  SectorLines() = default;
  /// `sectors` a side, 1 … most_sectors.
  SectorLines(const Lens& lens, int sectors);

  int sectors() const { return sectors_; }
  /// How many lines there are each way.
  int count() const { return sectors_ + 1 + 2 * lines_beyond; }
  /// x / z and y / z on line i, z being the distance in front of the eye.
  double x(int i) const { return left_ + position(i) * width_; }
  double y(int i) const { return bottom_ + position(i) * height_; }

  double left() const { return left_; }
  double bottom() const { return bottom_; }
  double width() const { return width_; }  // of a sector
  double height() const { return height_; }

 private:
  /// In terms of a sector, from the border.
  double position(int i) const;

  int sectors_ = 1;
  double left_ = -1.0, bottom_ = -1.0, width_ = 2.0, height_ = 2.0;
};

/// From a mesh's frame, relative to its middle, to a frame in which x / z and y / z are whole
/// numbers on the lines within the view, and z is the distance in front of the eye.
struct SectorRows {
  float x[4], y[4], z[4];  // factors of the three coordinates, and what is added
  float error_x = 0.0F, error_y = 0.0F, error_z = 0.0F;  // bounds on the errors in float
  float sectors = 1.0F;
};

/// Takes points that an object places by `transform` to the sectors of a perspective camera.
SectorRows sector_rows(const Camera& camera, const SectorLines& lines,
                       const glm::dmat4x3& transform, const MeshFrame& mesh);

/// Numbers of lines: what is seen lies between x lines `left` and `right`, and y lines `bottom` and
/// `top`. `right` is 0 where nothing is known: the box reaches beyond the last lines, or to where
/// there is no quotient, beside or behind the eye.
struct Rectangle {
  std::uint8_t left = 0, right = 0, bottom = 0, top = 0;

  bool known() const { return right != 0; }
  /// Between neighbouring lines.
  bool is_one_sector() const { return right == left + 1 && top == bottom + 1; }
  /// All four in one number.
  std::uint32_t key() const { return std::bit_cast<std::uint32_t>(*this); }
  friend bool operator==(const Rectangle& a, const Rectangle& b) { return a.key() == b.key(); }
};

/// Rectangles of the boxes [first, first + count), to `rectangles`.
void find_rectangles(const SectorRows& rows, const PointBoxes& boxes, std::size_t first,
                     std::size_t count, Rectangle* rectangles);

/// The same, one box after the other.
void find_rectangles_scalar(const SectorRows& rows, const PointBoxes& boxes, std::size_t first,
                            std::size_t count, Rectangle* rectangles);

}  // namespace vislab::backface_culling
