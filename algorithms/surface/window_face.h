// A triangle in the window of a frame, row by row, for the hidden-surface algorithms: the pixels
// are those that every rasteriser of the lab covers (common/raster/triangle_setup.h), and nearness
// and cuts are lines in double.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/raster/triangle_setup.h"
#include "common/scene/scene.h"

namespace vislab::surface {

/// What is linear in the window: a, b its steps by pixel and c its value at the centre of pixel
/// (from_x, from_y), which is near to the face, so that small faces keep their digits.
struct WindowLine {
  double a = 0.0, b = 0.0, c = 0.0;
  int from_x = 0, from_y = 0;

  /// x is in pixels from the centre of pixel 0. Along a row the value never turns back, in floating
  /// point either: it rises (a > 0) or falls.
  double at(double x, int y) const { return (b * (y - from_y) + c) + a * (x - from_x); }
};

/// Pixels [x0, x1) of a row; none if x0 >= x1.
struct RowSpan {
  int x0 = 0, x1 = 0;
  bool empty() const { return x0 >= x1; }
};

/// Where the edges of a face cross a row, in pixels from the centre of pixel 0: no more than row.x0
/// and no less than row.x1 - 1.
struct RowEnds {
  double left = 0.0, right = 0.0;
};

/// What of a row lies where the line is greater than 0 (positive), or is not. Of every pixel
/// exactly one of the two answers is true, so the two sides of a cut neither overlap nor leave a
/// crack.
RowSpan on_side(RowSpan row, const WindowLine& line, int y, bool positive);

class WindowFace {
 public:
  /// Returns false if it covers no pixel of the viewport. `corners` as window.mesh() gives them.
  bool set(const WindowTransform& window, const std::array<WindowPoint, 3>& corners);

  /// Of the nearness; see WindowTransform.
  const WindowLine& nearness() const { return nearness_; }
  /// The line along which a value that is linear in space is 0, if it has these values at the
  /// corners: its sign is that of the value on the face.
  WindowLine line(const std::array<double, 3>& values) const;

  /// Calls f(y, row, ends) for what each row has of it, once for each piece that clipping left:
  /// these are disjoint. Ends at the far plane.
  template <typename Function>
  void for_each_row(Function&& f) const {
    for (int i = 0; i < count_; ++i) {
      const SetupTriangle& piece = pieces_[static_cast<std::size_t>(i)];
      for (int y = piece.y0; y < piece.y1; ++y) {
        RowEnds ends;
        RowSpan row = covered(piece, y, ends);
        if (cut_by_far_ && !row.empty()) row = on_side(row, before_far_, y, true);
        if (!row.empty()) f(y, row, ends);
      }
    }
  }

 private:
  static RowSpan covered(const SetupTriangle& piece, int y, RowEnds& ends);

  std::array<glm::dvec3, 3>
      corners_;  // x, y and w before the division by w, from pixel (from_x_, …)
  int from_x_ = 0, from_y_ = 0;
  double determinant_ = 0.0;
  WindowLine nearness_;
  WindowLine before_far_;  // greater than 0 before the far plane
  bool cut_by_far_ = false;
  int count_ = 0;
  std::array<SetupTriangle, max_setup_pieces> pieces_;
};

}  // namespace vislab::surface
