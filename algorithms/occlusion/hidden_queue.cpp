#include "algorithms/occlusion/hidden_queue.h"

namespace vislab::occlusion_culling {

void HiddenQueue::start() {
  waiting_.clear();
  asked_.clear();
}

void HiddenQueue::add_again(Entry entry) {
  entry.alone = true;
  waiting_.push_back(entry);
  ++requeries_;
}

void HiddenQueue::ask(RenderDevice& device, const QueryHierarchy& hierarchy,
                      std::span<const Aabb> boxes) {
  members_.clear();
  group(hierarchy);
  std::uint32_t first = 0;
  for (const std::uint32_t end : ends_) {
    group_boxes_.clear();
    for (std::uint32_t i = first; i < end; ++i) {
      const Entry& entry = waiting_[candidates_[i].id];
      const std::span<const Aabb> own = boxes.subspan(entry.first_box, entry.box_count);
      group_boxes_.insert(group_boxes_.end(), own.begin(), own.end());
      members_.push_back(entry);
    }
    asked_.push_back({device.query(group_boxes_), first, end - first});
    ++queries_;
    shared_queries_ += end - first > 1 ? 1 : 0;
    first = end;
  }
  waiting_.clear();
}

void HiddenQueue::group(const QueryHierarchy& hierarchy) {
  candidates_.clear();
  ends_.clear();
  for (std::uint32_t i = 0; i < waiting_.size(); ++i) {
    if (sharing_ && !waiting_[i].alone) continue;
    candidates_.push_back({0, 0, 0, i});
    ends_.push_back(static_cast<std::uint32_t>(candidates_.size()));
  }
  const std::size_t alone = candidates_.size();
  if (alone == waiting_.size()) return;
  for (std::uint32_t i = 0; i < waiting_.size(); ++i) {
    const Entry& entry = waiting_[i];
    if (entry.alone) continue;
    candidates_.push_back({entry.hidden_frames,
                           static_cast<std::uint32_t>(hierarchy.triangles(entry.visit.node)),
                           entry.box_count, i});
  }
  group_multiqueries(*sharing_, persistence_, std::span(candidates_).subspan(alone), shared_ends_);
  for (const std::uint32_t end : shared_ends_) {
    ends_.push_back(static_cast<std::uint32_t>(alone) + end);
  }
}

void HiddenQueue::read(RenderDevice& device, std::uint64_t threshold_px,
                       std::vector<Answer>& answers) {
  answers.clear();
  for (const Asked& asked : asked_) {
    const bool visible = device.samples(asked.query) > threshold_px;
    for (Entry entry : std::span(members_).subspan(asked.first, asked.count)) {
      if (visible && asked.count > 1) {
        add_again(entry);
        continue;
      }
      if (entry.hidden_frames > 0) persistence_.note(entry.hidden_frames, !visible);
      entry.hidden_frames = 0;
      answers.push_back({entry, visible});
    }
  }
  asked_.clear();
}

std::size_t HiddenQueue::bytes() const {
  return (waiting_.capacity() + members_.capacity()) * sizeof(Entry) +
         asked_.capacity() * sizeof(Asked) + candidates_.capacity() * sizeof(MultiqueryCandidate) +
         (ends_.capacity() + shared_ends_.capacity()) * sizeof(std::uint32_t) +
         group_boxes_.capacity() * sizeof(Aabb);
}

}  // namespace vislab::occlusion_culling
