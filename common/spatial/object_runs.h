// Many short lists of object ids that grow and shrink, in one array.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"

namespace vislab {

/// The lists of the nodes of a spatial structure. Each lies in a block whose size is a power of
/// two; blocks that are given back are used again, so that churn does not let the array grow, and
/// the same calls after clear() allocate nothing. At most 2^32 ids.
class ObjectRuns {
 public:
  /// One list; the default is an empty one that has no block. To be changed by ObjectRuns only.
  struct Run {
    std::uint32_t start = 0;
    std::uint32_t count = 0;
    std::uint8_t size_class = 0;  // the block holds 2^size_class ids; 0: there is no block
  };

  /// Valid until any run changes.
  std::span<const ObjectId> of(const Run& run) const {
    return {ids_.data() + run.start, run.count};
  }
  /// Appends. O(1) amortised.
  void push(Run& run, ObjectId object);
  /// Takes out the id at `position`; the last one takes its place. O(1) amortised.
  void take_out(Run& run, std::uint32_t position);
  /// Takes out this id, which must be in it. O(run).
  void take_out_object(Run& run, ObjectId object);
  /// The run becomes empty.
  void release(Run& run);
  /// Forgets all runs, but keeps the memory.
  void clear();
  std::size_t bytes() const { return ids_.capacity() * sizeof(ObjectId); }

 private:
  static constexpr std::uint8_t smallest_class = 2;

  void relocate(Run& run, std::uint8_t size_class);

  std::vector<ObjectId> ids_;
  // By size class: the first free block, whose first id holds the start of the next one.
  std::array<std::uint32_t, 33> free_ = no_blocks();

  static constexpr std::array<std::uint32_t, 33> no_blocks() {
    std::array<std::uint32_t, 33> none{};
    none.fill(none_id);
    return none;
  }
};

/// A structure that repeats objects does not split leaves beyond this many entries: what is
/// everywhere would fill the memory.
inline std::uint64_t entry_limit(std::size_t objects) {
  return std::max<std::uint64_t>(64 * std::uint64_t{objects}, std::uint64_t{1} << 18U);
}

}  // namespace vislab
