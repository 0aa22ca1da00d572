// The occlusion horizon: what of each column of the image is hidden so far.
//
// Idea: one interval of rows for each column. Rectangles that are covered are joined to it; one
//   that does not touch a column's interval replaces it if it is taller.
// Limits: a column has one interval. What is covered above or below a gap is forgotten.
// Cost: O(columns of the rectangle).
// Source: Downs, Moeller and Sequin 2001, Occlusion horizons for driving through urban scenery,
//   who keep the upper end only.
#pragma once

#include <cstdint>
#include <vector>

#include "common/raster/box_window.h"

namespace vislab::depth_culling {

/// What is hidden below the lower end of what was covered.
enum class Ground {
  covered,  // nothing
  assumed   // everything: whatever hides stands on the ground (2½D)
};

class HorizonColumns {
 public:
  explicit HorizonColumns(Ground ground) : ground_(ground) {}

  /// Nothing is hidden.
  void begin(const Viewport& viewport);
  /// The rectangle is covered. Its nearness does not count.
  void add(const BoxWindow& rectangle);
  /// Is all of the rectangle covered? It is not empty and lies in the image.
  bool hides(const BoxWindow& rectangle) const;

  /// Rows [bottom, top) of a column; equal if nothing is covered.
  int bottom(int x) const { return bottom_[static_cast<std::size_t>(x)]; }
  int top(int x) const { return top_[static_cast<std::size_t>(x)]; }
  std::size_t bytes() const { return (bottom_.capacity() + top_.capacity()) * sizeof(int); }

 private:
  Ground ground_;
  std::vector<int> bottom_, top_;  // by column
};

}  // namespace vislab::depth_culling
