#include "algorithms/portal/image_window.h"

namespace vislab::portal_culling {

bool ImagePolygon::cut_by(const ImagePolygon& window) {
  for (std::uint32_t i = 0; i < window.count_; ++i) {
    const glm::dvec2& from = window.corners_[i];
    const glm::dvec2 edge = window.corners_[i + 1 == window.count_ ? 0 : i + 1] - from;
    const double length = glm::length(edge);
    if (!(length > 1e-12)) continue;
    const glm::dvec2 inward = glm::dvec2(-edge.y, edge.x) / length;
    const double offset = window_slack - glm::dot(inward, from);
    std::array<double, capacity> distance;
    bool any_outside = false;
    bool any_inside = false;
    for (std::uint32_t k = 0; k < count_; ++k) {
      distance[k] = glm::dot(inward, corners_[k]) + offset;
      (distance[k] < 0.0 ? any_outside : any_inside) = true;
    }
    if (!any_outside) continue;
    if (!any_inside) return false;
    if (count_ + 1 >= capacity) continue;
    std::array<glm::dvec2, capacity> kept;
    std::uint32_t count = 0;
    for (std::uint32_t k = 0; k < count_; ++k) {
      const std::uint32_t next = k + 1 == count_ ? 0 : k + 1;
      if (distance[k] >= 0.0) kept[count++] = corners_[k];
      if ((distance[k] < 0.0) != (distance[next] < 0.0)) {
        kept[count++] = corners_[k] + (corners_[next] - corners_[k]) *
                                          (distance[k] / (distance[k] - distance[next]));
      }
    }
    count_ = count;
    corners_ = kept;
  }
  bounds_ = {};
  for (const glm::dvec2& p : corners()) bounds_.extend(p);
  return count_ >= 3;
}

}  // namespace vislab::portal_culling
