#include "experiments/bench/detail/workload.h"

#include <numbers>
#include <stdexcept>

#include "algorithms/all_cullers.h"
#include "common/scene/generators/generators.h"

namespace vislab {

DetailSide::DetailSide(const std::string& spec, const Scene& scene) {
  register_all_cullers(registry_);
  culler_ = registry_.make(spec);
  BuildContext context;
  context.cullers = &registry_;
  culler_->build(scene, context);
  culler_->reset(1);
  sink_.kept.reserve(scene.object_count());
}

void DetailSide::cull(const Frame& frame) {
  sink_.kept.clear();
  culler_->update(frame, {});
  culler_->cull(frame, Candidates::everything(), sink_);
}

void DetailSide::Sink::everything() {
  throw std::logic_error("a culler of the bench kept everything");
}
void DetailSide::Sink::objects(std::span<const ObjectId> ids) {
  kept.insert(kept.end(), ids.begin(), ids.end());
}
void DetailSide::Sink::ranges(std::span<const TriangleRange>) {
  throw std::logic_error("a culler of the bench emitted triangles");
}

Scene all_around(Shape shape) {
  BoxFieldParameters parameters;
  parameters.count = 20'000;
  parameters.extent_m = 60.0;
  parameters.clear_radius_m = 6.0;
  BumpySphereParameters sphere;
  sphere.subdivisions = 4;
  Scene scene = shape == Shape::box ? make_box_field(parameters)
                                    : make_mesh_field(bumpy_sphere_mesh(sphere), parameters);
  scene.finish();
  return scene;
}

Camera wide_camera() {
  return {look_at({0.0, 0.0, 0.0}, {1.0, 0.3, -2.0}),
          perspective_lens(2.0 * std::numbers::pi / 3.0, 1.0, 0.1, 300.0)};
}

}  // namespace vislab
