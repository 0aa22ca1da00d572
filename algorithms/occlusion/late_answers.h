// Draws what the answers of some frames ago say, and asks at the end of the frame for later ones.
// The base of occlusion.last_frame and of a negative control.
//
// Idea: an engine that never waits takes whatever answer has arrived: that of a frame, or a few,
//   ago. Answers are kept by place; an object's place is its id, unless a control says otherwise.
// Guarantee: none for the image; see last_frame.cpp.
// Cost: O(n log n) for n candidates, a question for each in the view, and a byte a place and frame
//   of memory, cleared in every frame.
#pragma once

#include <vector>

#include "algorithms/occlusion/object_list.h"
#include "common/culler/culler.h"

namespace vislab::occlusion_culling {

class LateAnswers : public ICuller {
 public:
  /// `frames_late` >= 1.
  LateAnswers(CullerInfo info, std::size_t frames_late);
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override;
  void reset(std::uint64_t seed) override;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override;
  std::size_t bytes() const override;
  Counters counters() const override;

 protected:
  /// Where an object's answers are kept; less than the number of the scene's objects.
  virtual std::size_t place_of(ObjectId object) const { return object; }

 private:
  struct Asked {
    QueryId query;
    ObjectId object = 0;
  };

  /// Forgets the answers that are too old, once a frame.
  void start(std::uint64_t frame);
  std::vector<std::uint8_t>& hidden_in(std::uint64_t frame) {
    return hidden_[frame % hidden_.size()];
  }

  CullerInfo info_;
  std::size_t frames_late_;
  RenderDevice* device_ = nullptr;
  ObjectList list_;
  KeptObjects kept_;
  std::vector<Asked> asked_;
  /// Of this frame and frames_late before, by frame modulo their number: 1 where a place's object
  /// was asked about and found hidden.
  std::vector<std::vector<std::uint8_t>> hidden_;
  std::uint64_t next_frame_ = 0;
  std::uint64_t occluded_ = 0;
};

}  // namespace vislab::occlusion_culling
