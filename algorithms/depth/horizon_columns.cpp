#include "algorithms/depth/horizon_columns.h"

#include <algorithm>

namespace vislab::depth_culling {

void HorizonColumns::begin(const Viewport& viewport) {
  bottom_.assign(static_cast<std::size_t>(viewport.width), 0);
  top_.assign(static_cast<std::size_t>(viewport.width), 0);
}

void HorizonColumns::add(const BoxWindow& rectangle) {
  const int y0 = ground_ == Ground::assumed ? 0 : rectangle.y0;
  const int y1 = rectangle.y1;
  for (auto x = static_cast<std::size_t>(rectangle.x0); x < static_cast<std::size_t>(rectangle.x1);
       ++x) {
    if (y0 <= top_[x] && y1 >= bottom_[x] && bottom_[x] < top_[x]) {
      bottom_[x] = std::min(bottom_[x], y0);
      top_[x] = std::max(top_[x], y1);
    } else if (y1 - y0 > top_[x] - bottom_[x]) {
      bottom_[x] = y0;
      top_[x] = y1;
    }
  }
}

bool HorizonColumns::hides(const BoxWindow& rectangle) const {
  // Whole blocks without a branch, so that they are compared side by side.
  constexpr int block = 32;
  for (int from = rectangle.x0; from < rectangle.x1; from += block) {
    const int to = std::min(from + block, rectangle.x1);
    int open = 0;
    for (auto x = static_cast<std::size_t>(from); x < static_cast<std::size_t>(to); ++x) {
      open |=
          static_cast<int>(bottom_[x] > rectangle.y0) | static_cast<int>(top_[x] < rectangle.y1);
    }
    if (open != 0) return false;
  }
  return true;
}

}  // namespace vislab::depth_culling
