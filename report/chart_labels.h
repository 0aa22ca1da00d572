// Places small labels beside points so that they hide neither points nor each other.
#pragma once

#include <string>
#include <vector>

namespace vislab {

/// In pixels, y upwards.
struct ChartBox {
  double left = 0.0, bottom = 0.0, right = 0.0, top = 0.0;

  double overlap(const ChartBox& other) const;  // area, px²
};

struct PlacedLabel {
  double x = 0.0, y = 0.0;  // centre of the label
  bool leader = false;  // a line should join it and its point: they are far, or another is nearer
  /// False: there was no place where it hides next to nothing, and should be left out.
  bool is_legible = true;
};

struct LabelRequest {
  double x = 0.0, y = 0.0;           // the point
  double width = 0.0, height = 0.0;  // of the label
};

/// One label a request, inside `frame` and off the `obstacles` (marks, error bars) where that can
/// be done. Greedy in the order of requests; each takes the free place nearest to its point, else
/// the least covered one. Legible labels never overlap each other, nor does the line that joins one
/// to its point cross another or its line. O(requests × (requests + obstacles)).
std::vector<PlacedLabel> place_labels(const std::vector<LabelRequest>& requests,
                                      const std::vector<ChartBox>& obstacles,
                                      const ChartBox& frame);

struct NumberedPoint {
  double x = 0.0, y = 0.0;
  std::size_t number = 0;
};

/// Points that lie so near each other that they share a label.
struct PointGroup {
  double x = 0.0, y = 0.0;  // the mean of the points
  std::vector<std::size_t> numbers;
};

/// Each point joins the first group whose first point is at most `reach` away in x and in y, or
/// begins one, in the order of the points.
std::vector<PointGroup> group_points(const std::vector<NumberedPoint>& points, double reach);

/// "3, 5–8": the numbers in ascending order.
std::string number_list(std::vector<std::size_t> numbers);

}  // namespace vislab
