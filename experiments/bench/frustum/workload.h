// The boxes and views that all contests of frustum cullers share.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/frame.h"

namespace vislab {

/// Axis-aligned boxes uniform in ±500 m, half sizes 0.2 to 2 m, and 16 views from the origin all
/// around, 60 degrees high, 16:9, near 0.3 m, and far such that 11.2 % of the boxes are visible.
/// The same for the same count.
class FrustumWorkload {
 public:
  explicit FrustumWorkload(std::size_t count);

  const Scene& scene() const { return scene_; }
  std::span<const Aabb> boxes() const { return state_.view().bounds; }
  std::size_t view_count() const { return views_.size(); }
  /// Frame `view`: all objects are shown.
  Frame frame(std::size_t view) const;

  /// What no plane of the view excludes by the definition, surely_outside(): one bit a box in the
  /// order of ids, 64 to a word.
  const std::vector<std::uint64_t>& kept(std::size_t view) const { return kept_[view]; }
  /// Does an answer, of the same form, differ from the definition's only in boxes whose p-vertex is
  /// nearer to a plane than `error_m`?
  bool is_right(std::size_t view, const std::vector<std::uint64_t>& answer, double error_m) const;

 private:
  Scene scene_;
  SceneState state_;
  std::vector<Camera> views_;
  std::vector<std::vector<std::uint64_t>> kept_;
};

}  // namespace vislab
