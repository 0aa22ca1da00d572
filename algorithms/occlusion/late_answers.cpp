#include "algorithms/occlusion/late_answers.h"

#include <algorithm>

namespace vislab::occlusion_culling {

LateAnswers::LateAnswers(CullerInfo info, std::size_t frames_late)
    : info_(std::move(info)), frames_late_(frames_late) {}

void LateAnswers::build(const Scene& scene, const BuildContext& context) {
  device_ = &required_device(info_.name, context);
  list_.reserve(scene.object_count());
  kept_.reserve(scene.object_count());
  asked_.reserve(scene.object_count());
  hidden_.assign(frames_late_ + 1, std::vector<std::uint8_t>(scene.object_count(), 0));
}

void LateAnswers::reset(std::uint64_t) {
  for (std::vector<std::uint8_t>& answers : hidden_) std::ranges::fill(answers, 0);
  next_frame_ = 0;
}

void LateAnswers::start(std::uint64_t frame) {
  if (frame < next_frame_) return;  // a further call of the same frame
  // Frames that were skipped were not asked about either.
  const std::uint64_t skipped = std::min<std::uint64_t>(frame - next_frame_, frames_late_);
  for (std::uint64_t i = frame - skipped; i <= frame; ++i) std::ranges::fill(hidden_in(i), 0);
  next_frame_ = frame + 1;
}

void LateAnswers::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  start(frame.index);
  kept_.clear();
  asked_.clear();
  list_.fill(frame, candidates);
  for (const ListedObject& listed : list_.objects()) {
    const bool hidden = listed.askable && frame.index >= frames_late_ &&
                        hidden_in(frame.index - frames_late_)[place_of(listed.object)] != 0;
    if (hidden) {
      ++occluded_;
    } else {
      kept_.add(listed.object);
    }
  }
  kept_.draw(out);
  for (const ListedObject& listed : list_.objects()) {
    if (listed.askable) {
      asked_.push_back({device_->query({&listed.asked, 1}), listed.object});
    }
  }
  if (asked_.empty()) return;
  device_->flush();
  std::vector<std::uint8_t>& answers = hidden_in(frame.index);
  for (const Asked& asked : asked_) {
    answers[place_of(asked.object)] = device_->samples(asked.query) == 0 ? 1 : 0;
  }
}

std::size_t LateAnswers::bytes() const {
  std::size_t bytes = list_.bytes() + kept_.bytes() + asked_.capacity() * sizeof(Asked);
  for (const std::vector<std::uint8_t>& answers : hidden_) bytes += answers.capacity();
  return bytes;
}

Counters LateAnswers::counters() const {
  return {{"occluded", occluded_}, {"outside", list_.outside()}};
}

}  // namespace vislab::occlusion_culling
