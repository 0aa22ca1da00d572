#include "common/spatial/object_runs.h"

#include <algorithm>
#include <stdexcept>

namespace vislab {

void ObjectRuns::push(Run& run, ObjectId object) {
  if (run.size_class == 0) {
    relocate(run, smallest_class);
  } else if (run.count == std::uint32_t{1} << run.size_class) {
    relocate(run, static_cast<std::uint8_t>(run.size_class + 1));
  }
  ids_[run.start + run.count++] = object;
}

void ObjectRuns::take_out(Run& run, std::uint32_t position) {
  --run.count;
  ids_[run.start + position] = ids_[run.start + run.count];
  if (run.count == 0) {
    release(run);
  } else if (run.size_class > smallest_class &&
             run.count <= (std::uint32_t{1} << run.size_class) / 4) {
    // Only at a quarter: a list that goes up and down around a power of two stays where it is.
    relocate(run, static_cast<std::uint8_t>(run.size_class - 1));
  }
}

void ObjectRuns::take_out_object(Run& run, ObjectId object) {
  const std::span<const ObjectId> ids = of(run);
  const auto found = std::ranges::find(ids, object);
  if (found == ids.end()) throw std::logic_error("the object is not in the run");
  take_out(run, static_cast<std::uint32_t>(found - ids.begin()));
}

void ObjectRuns::release(Run& run) {
  if (run.size_class != 0) {
    ids_[run.start] = free_[run.size_class];
    free_[run.size_class] = run.start;
  }
  run = {};
}

void ObjectRuns::clear() {
  ids_.clear();
  free_ = no_blocks();
}

void ObjectRuns::relocate(Run& run, std::uint8_t size_class) {
  Run moved{0, run.count, size_class};
  if (free_[size_class] != none_id) {
    moved.start = free_[size_class];
    free_[size_class] = ids_[moved.start];
  } else {
    moved.start = static_cast<std::uint32_t>(ids_.size());
    ids_.resize(ids_.size() + (std::size_t{1} << size_class));
  }
  std::copy_n(ids_.begin() + run.start, run.count, ids_.begin() + moved.start);
  release(run);
  run = moved;
}

}  // namespace vislab
