#include "algorithms/occlusion/box_queries.h"

#include <algorithm>
#include <string>

#include "common/render/query_bounds.h"
#include "common/scene/error.h"

namespace vislab::occlusion_culling {

void BoxView::start(const Frame& frame) {
  camera_ = frame.camera;
  viewport_ = frame.viewport;
  frustum_ = frustum_of(frame.camera);
}

BoxPlace BoxView::place(const Aabb& box, Aabb& asked) const {
  const bool outside = std::ranges::any_of(
      frustum_.span(), [&](const Plane& plane) { return surely_outside(plane, box); });
  return outside ? BoxPlace::outside : place_inside(box, asked);
}

BoxPlace BoxView::place_inside(const Aabb& box, Aabb& asked) const {
  if (!box.valid()) return BoxPlace::unaskable;
  asked = enlarged_for_query(camera_, viewport_, box);
  return touches_near_region(camera_, asked) ? BoxPlace::unaskable : BoxPlace::askable;
}

double nearness(const Camera& camera, const Aabb& box) {
  if (!box.valid()) return 0.0;
  if (camera.lens.projection == Projection::perspective) {
    return distance_squared(box, camera.pose.eye);
  }
  const glm::dvec3 reach = glm::abs(camera.pose.back) * box.half_size();
  return camera.planar_depth(box.center()) - (reach.x + reach.y + reach.z);
}

ParameterSpec threshold_parameter() {
  return ParameterSpec::integer(
      "threshold_px", 0, 0, 1'000'000, "pixels", ParameterSpec::Stage::query,
      "objects whose box shows no more pixels than this are left out; above 0 small things vanish "
      "from the image");
}

RenderDevice& required_device(std::string_view culler, const BuildContext& context) {
  if (context.device == nullptr) {
    throw InputError(std::string(culler) +
                     ": there is no graphics device to ask; it needs a run that draws");
  }
  return *context.device;
}

}  // namespace vislab::occlusion_culling
