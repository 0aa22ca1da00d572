// What detail.screen_size and its wrong variants share: objects that cover less of the image than a
// threshold are left out.
#pragma once

#include <vector>

#include "algorithms/detail/image_shift.h"
#include "algorithms/detail/object_sizes.h"
#include "common/culler/culler.h"

namespace vislab::detail_culling {

struct DetailSettings {
  SizeMeasure measure = SizeMeasure::sphere;
  double threshold_px = 4.0;
  double motion_px = 0.0;   // 0: the threshold holds at any speed
  double hysteresis = 0.0;  // share of the threshold, below 1
};

/// threshold_px, motion and hysteresis; `measure` is the culler's own affair.
std::vector<ParameterSpec> threshold_parameters();
DetailSettings read_threshold(const ParameterValues& values);

/// Leaves out an object whose size is at most the threshold, and what lies wholly before the near
/// plane. With `motion_px` the threshold of an object is the share of `threshold_px` that its shift
/// in the image (image_shift.h) is of motion_px, and the whole of it from there on. With
/// `hysteresis` an object that is drawn is left out at (1 - hysteresis) of the threshold only, and
/// one that is left out is drawn again above the whole threshold: what is lost is never more.
class DetailCuller : public ICuller {
 public:
  DetailCuller(CullerInfo info, const DetailSettings& settings);

  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext& context) override;
  void reset(std::uint64_t seed) override;
  void update(const Frame& frame, const Changes& changes) override;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override;
  std::size_t bytes() const override;
  Counters counters() const override;

 private:
  double threshold_of(ObjectId object, const Frame& frame) const;
  bool keeps(ObjectId object, const Frame& frame, const ProjectedArea& areas);

  CullerInfo info_;
  DetailSettings settings_;
  ObjectSizes sizes_;
  ImageShift shift_;
  std::vector<std::uint8_t> left_out_;  // by object, when it was last asked; hysteresis only
  std::vector<ObjectId> kept_;
  std::uint64_t objects_tested_ = 0;
};

}  // namespace vislab::detail_culling
