#include "experiments/contract/scenario.h"

#include <algorithm>
#include <iterator>

namespace vislab {

Scenario::Scenario(SmallScene small)
    : small_(std::make_unique<SmallScene>(std::move(small))),
      caster_(std::make_unique<RayCaster>(small_->scene, TruthSettings{})),
      truth_(std::make_unique<PathTruth>(small_->scene)) {
  SceneState state(small_->scene);
  start_ = copied(state.view());
  for (const PathFrame& frame : small_->path.frames) {
    state.apply(frame.changes);
    moments_.push_back(copied(state.view()));
  }
  for (std::size_t i = 0; i < frame_count(); ++i) truth_->add(caster_->trace(frame(i)));
}

Frame Scenario::frame(std::size_t index) const {
  const Moment& moment = moments_[index];
  return {index,
          small_->path.frames[index].camera,
          small_->viewport,
          {moment.transforms, moment.bounds, moment.shown},
          0.0};
}

Changes Scenario::changes(std::size_t from, std::size_t to) const {
  return between(moments_[from], moments_[to]);
}

Changes Scenario::changes_from_start(std::size_t to) const { return between(start_, moments_[to]); }

Scenario::Moment Scenario::copied(const ObjectsView& view) {
  return {{view.transforms.begin(), view.transforms.end()},
          {view.bounds.begin(), view.bounds.end()},
          {view.shown.begin(), view.shown.end()}};
}

Changes Scenario::between(const Moment& from, const Moment& to) {
  Changes changes;
  for (ObjectId object = 0; object < to.transforms.size(); ++object) {
    if (from.transforms[object] == to.transforms[object]) continue;
    changes.moved.push_back(object);
    changes.transforms.push_back(to.transforms[object]);
  }
  std::ranges::set_difference(to.shown, from.shown, std::back_inserter(changes.shown));
  std::ranges::set_difference(from.shown, to.shown, std::back_inserter(changes.hidden));
  return changes;
}

}  // namespace vislab
