#include "algorithms/detail/image_shift.h"

#include <limits>

namespace vislab::detail_culling {
namespace {

/// Where a point is in the image, in pixels; nothing if it lies before the near plane.
std::optional<glm::dvec2> place_in_image(const Camera& camera, const Viewport& viewport,
                                         const glm::dvec3& world) {
  const Lens& lens = camera.lens;
  const glm::dvec3 p = world - camera.pose.eye;
  const double depth = -glm::dot(p, camera.pose.back);
  if (!(depth >= lens.near_m)) return std::nullopt;
  glm::dvec2 at(glm::dot(p, camera.pose.right), glm::dot(p, camera.pose.up));
  if (lens.projection == Projection::perspective) at *= lens.near_m / depth;
  return (at - glm::dvec2(lens.left, lens.bottom)) /
         glm::dvec2(lens.right - lens.left, lens.top - lens.bottom) *
         glm::dvec2(viewport.width, viewport.height);
}

}  // namespace

void ImageShift::forget() {
  before_.reset();
  now_.reset();
}

void ImageShift::advance(const Camera& camera, const Viewport& viewport) {
  before_ = now_;
  now_ = camera;
  viewport_ = viewport;
}

bool ImageShift::moving() const { return before_ && *before_ != *now_; }

double ImageShift::of(const glm::dvec3& world) const {
  if (!moving()) return 0.0;
  const auto was = place_in_image(*before_, viewport_, world);
  const auto is = place_in_image(*now_, viewport_, world);
  if (!was || !is) return std::numeric_limits<double>::infinity();
  return glm::distance(*was, *is);
}

}  // namespace vislab::detail_culling
