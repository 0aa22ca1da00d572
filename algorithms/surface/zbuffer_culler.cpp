#include "algorithms/surface/zbuffer_culler.h"

#include <algorithm>
#include <cmath>

namespace vislab::surface {

double DepthFormat::stored(double reversed) const {
  const double depth = convention == DepthConvention::standard ? 1.0 - reversed : reversed;
  if (bits == 0) {
    const volatile float rounded = static_cast<float>(depth);  // see common/geometry/rounding.h
    return rounded;
  }
  // As a share of the greatest integer, which double keeps exactly enough to tell 2^32 apart.
  const double greatest = std::ldexp(1.0, bits) - 1.0;
  return std::floor(depth * greatest + 0.5) / greatest;
}

void ZBuffer::paint(const Frame& frame, const Candidates& candidates) {
  const WindowTransform window(frame.camera, frame.viewport);
  const double far_value = window.nearness(frame.camera.lens.far_m);
  const double scale = 1.0 / (window.nearness(frame.camera.lens.near_m) - far_value);
  const DepthFormat comparison{rules_.comparison, rules_.format.bits};
  depths_.assign(image().owners().size(), DepthFormat{rules_.clear, rules_.format.bits}.clear());
  for_each_face(window, frame, candidates, [&](TriangleId triangle, const WindowFace& face) {
    face.for_each_row([&](int y, RowSpan row, const RowEnds&) {
      for (int x = row.x0; x < row.x1; ++x) {
        const double reversed = (face.nearness().at(x, y) - far_value) * scale;
        const double depth = rules_.format.stored(std::clamp(reversed, 0.0, 1.0));
        double& kept = depths_[image().index(x, y)];
        ++tests_;
        if (!comparison.nearer(depth, kept)) continue;
        kept = depth;
        image().at(x, y) = triangle;
        ++writes_;
      }
    });
  });
}

}  // namespace vislab::surface
