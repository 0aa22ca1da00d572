#include "experiments/show/recorded_device.h"

#include <algorithm>

namespace vislab {

void RecordedDevice::begin_frame(const Frame& frame) {
  device_->begin_frame(frame);
  states_.assign(1, {});
  places_.clear();
  flushes_ = 0;
}

RecordedState& RecordedDevice::state(bool asks) {
  if (states_.empty() || states_.back().asks != asks) {
    states_.emplace_back();
    states_.back().asks = asks;
  }
  return states_.back();
}

void RecordedDevice::draw(std::span<const ObjectId> objects) {
  device_->draw(objects);
  if (objects.empty()) return;
  std::vector<ObjectId>& drawn = state(false).drawn;
  drawn.insert(drawn.end(), objects.begin(), objects.end());
}

void RecordedDevice::draw(std::span<const TriangleRange> ranges) {
  device_->draw(ranges);
  ObjectId last = none_id;
  for (const TriangleRange& range : ranges) {
    if (range.count == 0 || range.object == last) continue;
    state(false).drawn.push_back(range.object);
    last = range.object;
  }
}

QueryId RecordedDevice::query(std::span<const Aabb> boxes) {
  const QueryId id = device_->query(boxes);
  std::vector<RecordedQuery>& queries = state(true).queries;
  places_.push_back({id, states_.size() - 1, queries.size()});
  queries.push_back({{boxes.begin(), boxes.end()}, std::nullopt});
  return id;
}

void RecordedDevice::flush() {
  device_->flush();
  ++flushes_;
}

std::uint64_t RecordedDevice::samples(QueryId query) {
  const std::uint64_t samples = device_->samples(query);
  // Answers are mostly read soon after the question.
  const auto found = std::find_if(places_.rbegin(), places_.rend(),
                                  [&](const Place& place) { return place.query == query; });
  if (found != places_.rend()) states_[found->state].queries[found->index].samples = samples;
  return samples;
}

}  // namespace vislab
