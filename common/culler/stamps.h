// Membership marks for objects, forgotten in O(1).
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/scene.h"

namespace vislab {

/// A set of objects that can be emptied without touching its memory.
class ObjectStamps {
 public:
  /// Room for ids below `object_count`; empties the set.
  void resize(std::size_t object_count) {
    stamps_.assign(object_count, 0);
    current_ = 1;
  }
  void clear() {
    if (++current_ == 0) resize(stamps_.size());  // the counter wrapped around
  }
  /// True if the object was not in the set before.
  bool insert(ObjectId object) {
    if (stamps_[object] == current_) return false;
    stamps_[object] = current_;
    return true;
  }
  bool contains(ObjectId object) const { return stamps_[object] == current_; }
  std::size_t bytes() const { return stamps_.capacity() * sizeof(std::uint32_t); }

 private:
  std::vector<std::uint32_t> stamps_;
  std::uint32_t current_ = 1;
};

}  // namespace vislab
