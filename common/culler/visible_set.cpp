#include "common/culler/visible_set.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace vislab {

VisibleSet::VisibleSet(std::vector<Run> runs) : runs_(std::move(runs)) {
  std::erase_if(runs_, [](const Run& run) { return run.count == 0; });
  if (!std::ranges::is_sorted(runs_, {}, &Run::first)) std::ranges::sort(runs_, {}, &Run::first);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const Run run = runs_[i];
    if (kept > 0) {
      Run& last = runs_[kept - 1];
      if (run.first < last.first + last.count) {
        throw std::logic_error("triangle " + std::to_string(run.first) + " is in the set twice");
      }
      if (run.first == last.first + last.count) {
        last.count += run.count;
        continue;
      }
    }
    runs_[kept++] = run;
  }
  runs_.resize(kept);
}

bool VisibleSet::contains(TriangleId triangle) const { return intersects(triangle, 1); }

bool VisibleSet::intersects(TriangleId first, std::uint32_t count) const {
  // The last run that starts before the end of the interval decides.
  const auto after = std::ranges::lower_bound(runs_, first + count, {}, &Run::first);
  if (after == runs_.begin()) return false;
  const Run& run = *std::prev(after);
  return run.first + run.count > first;
}

std::uint64_t VisibleSet::triangle_count() const {
  std::uint64_t count = 0;
  for (const Run& run : runs_) count += run.count;
  return count;
}

std::string VisibleSet::hash() const {
  static_assert(sizeof(Run) == 8, "runs are hashed as they lie in memory");
  const XXH128_hash_t hash = XXH3_128bits(runs_.data(), runs_.size() * sizeof(Run));
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

void RecordingSink::start(const Scene& scene, const Frame& frame) {
  scene_ = &scene;
  frame_ = &frame;
  emitted_.clear();
  flushes_ = 0;
}

void RecordingSink::everything() { objects(frame_->objects.shown); }

void RecordingSink::objects(std::span<const ObjectId> ids) {
  for (const ObjectId id : ids) emitted_.push_back({id, 0, scene_->triangle_count(id)});
}

void RecordingSink::ranges(std::span<const TriangleRange> ranges) {
  emitted_.insert(emitted_.end(), ranges.begin(), ranges.end());
}

VisibleSet RecordingSink::set() const {
  std::vector<VisibleSet::Run> runs;
  runs.reserve(emitted_.size());
  for (const TriangleRange& range : emitted_) {
    runs.push_back({scene_->first_triangle(range.object) + range.first, range.count});
  }
  return VisibleSet(std::move(runs));
}

}  // namespace vislab
