#include "algorithms/detail/detail_culler.h"

#include <algorithm>

#include "common/geometry/frustum.h"

namespace vislab::detail_culling {

std::vector<ParameterSpec> threshold_parameters() {
  const auto query = ParameterSpec::Stage::query;
  return {
      ParameterSpec::real("threshold_px", DetailSettings().threshold_px, 0.0, 1e6, "px", query,
                          "objects that cover at most this area are left out; the larger, the "
                          "faster and the more is missing; 0 leaves out nothing that can be seen"),
      ParameterSpec::real("motion", DetailSettings().motion_px, 0.0, 1e4, "px", query,
                          "the threshold grows with the speed at which the camera's motion moves "
                          "an object over the image, from 0 at rest to the whole threshold at this "
                          "many pixels a frame; 0: the whole threshold at any speed"),
      ParameterSpec::real("hysteresis", DetailSettings().hysteresis, 0.0, 0.99, "", query,
                          "an object that is drawn is left out only where it is smaller than the "
                          "threshold by this share; the larger, the less flickers, and the less is "
                          "left out")};
}

DetailSettings read_threshold(const ParameterValues& values) {
  DetailSettings settings;
  settings.threshold_px = values.real("threshold_px");
  settings.motion_px = values.real("motion");
  settings.hysteresis = values.real("hysteresis");
  return settings;
}

DetailCuller::DetailCuller(CullerInfo info, const DetailSettings& settings)
    : info_(std::move(info)), settings_(settings), sizes_(settings.measure) {
  if (settings.motion_px > 0.0 || settings.hysteresis > 0.0) {
    info_.repeatability = Repeatability::path;
  }
}

void DetailCuller::build(const Scene& scene, const BuildContext&) {
  sizes_.build(scene);
  kept_.reserve(scene.object_count());
  if (settings_.hysteresis > 0.0) left_out_.assign(scene.object_count(), 0);
  shift_.forget();
}

void DetailCuller::reset(std::uint64_t) {
  sizes_.reset();
  shift_.forget();
  std::ranges::fill(left_out_, std::uint8_t{0});
}

void DetailCuller::update(const Frame& frame, const Changes& changes) {
  sizes_.update(frame, changes);
  shift_.advance(frame.camera, frame.viewport);
}

double DetailCuller::threshold_of(ObjectId object, const Frame& frame) const {
  if (settings_.motion_px == 0.0) return settings_.threshold_px;
  const double shift_px = shift_.of(frame.objects.bounds[object].center());
  return settings_.threshold_px * std::min(1.0, shift_px / settings_.motion_px);
}

bool DetailCuller::keeps(ObjectId object, const Frame& frame, const ProjectedArea& areas) {
  double threshold_px = threshold_of(object, frame);
  const bool remembers = settings_.hysteresis > 0.0;
  if (remembers && left_out_[object] == 0) threshold_px *= 1.0 - settings_.hysteresis;
  // Nothing is so small that a threshold of nothing leaves it out; NaN is kept.
  const bool keep = !(threshold_px > 0.0) || !(sizes_.of(object, frame, areas) <= threshold_px);
  if (remembers) left_out_[object] = keep ? 0 : 1;
  return keep;
}

void DetailCuller::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  const ProjectedArea areas(frame.camera, frame.viewport);
  const Plane near = frustum_of(frame.camera).planes[Frustum::near];
  kept_.clear();
  for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
    objects_tested_ += run.size();
    for (const ObjectId object : run) {
      if (surely_outside(near, frame.objects.bounds[object])) continue;
      if (keeps(object, frame, areas)) kept_.push_back(object);
    }
  });
  out.objects(kept_);
}

std::size_t DetailCuller::bytes() const {
  return sizes_.bytes() + left_out_.capacity() + kept_.capacity() * sizeof(ObjectId);
}

Counters DetailCuller::counters() const { return {{"objects_tested", objects_tested_}}; }

}  // namespace vislab::detail_culling
