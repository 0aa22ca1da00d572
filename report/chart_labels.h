// Places small labels beside points so that they hide neither points nor each other.
#pragma once

#include <vector>

namespace vislab {

/// In pixels, y upwards.
struct ChartBox {
  double left = 0.0, bottom = 0.0, right = 0.0, top = 0.0;

  double overlap(const ChartBox& other) const;  // area, px²
};

struct PlacedLabel {
  double x = 0.0, y = 0.0;  // centre of the label
  bool leader = false;      // so far from its point that a line should join them
};

struct LabelRequest {
  double x = 0.0, y = 0.0;           // the point
  double width = 0.0, height = 0.0;  // of the label
};

/// One label a request, inside `frame` and off the `obstacles` (marks, error bars) where that can
/// be done. Greedy in the order of requests; each takes the free place nearest to its point, else
/// the least covered one. O(requests × (requests + obstacles)).
std::vector<PlacedLabel> place_labels(const std::vector<LabelRequest>& requests,
                                      const std::vector<ChartBox>& obstacles,
                                      const ChartBox& frame);

}  // namespace vislab
