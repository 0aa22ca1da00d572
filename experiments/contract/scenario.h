// A small scene made ready for checking cullers: the objects' state at every frame, truth, and what
// changes from any frame to any other.
#pragma once

#include <memory>

#include "common/judge/path_truth.h"
#include "experiments/contract/small_scenes.h"

namespace vislab {

class Scenario {
 public:
  /// Traces every frame of the scene's path.
  explicit Scenario(SmallScene small);

  const std::string& name() const { return small_->name; }
  const Scene& scene() const { return small_->scene; }
  std::size_t frame_count() const { return moments_.size(); }
  const PathTruth& truth() const { return *truth_; }
  RayCaster& caster() { return *caster_; }

  /// Any frame at any time; valid as long as the scenario.
  Frame frame(std::size_t index) const;

  /// What has to change after frame `from` to arrive at frame `to`.
  Changes changes(std::size_t from, std::size_t to) const;
  /// What has to change in the scene as built to arrive at frame `to`.
  Changes changes_from_start(std::size_t to) const;

 private:
  struct Moment {
    std::vector<glm::dmat4x3> transforms;
    std::vector<Aabb> bounds;
    std::vector<ObjectId> shown;
  };

  static Moment copied(const ObjectsView& view);
  static Changes between(const Moment& from, const Moment& to);

  std::unique_ptr<const SmallScene> small_;  // stays where it is: the others point into it
  Moment start_;
  std::vector<Moment> moments_;  // one a frame
  std::unique_ptr<RayCaster> caster_;
  std::unique_ptr<PathTruth> truth_;
};

}  // namespace vislab
