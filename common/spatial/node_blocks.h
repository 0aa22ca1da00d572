// Indices of nodes, given out in blocks of siblings and taken back.
#pragma once

#include <cstdint>
#include <vector>

namespace vislab {

/// 0 is the root and always there. Siblings are neighbours. Deterministic: what was given back last
/// is given out first.
class NodeBlocks {
 public:
  explicit NodeBlocks(std::uint32_t siblings) : siblings_(siblings) {}

  /// The first index of a block.
  std::uint32_t take() {
    if (!free_.empty()) {
      const std::uint32_t first = free_.back();
      free_.pop_back();
      return first;
    }
    const std::uint32_t first = size_;
    size_ += siblings_;
    return first;
  }
  void give_back(std::uint32_t first) { free_.push_back(first); }
  /// All but the root are free; memory is kept.
  void clear() {
    free_.clear();
    size_ = 1;
  }
  /// All indices given out so far are below.
  std::uint32_t size() const { return size_; }
  /// Nodes in use.
  std::uint32_t used() const {
    return size_ - static_cast<std::uint32_t>(free_.size()) * siblings_;
  }
  std::size_t bytes() const { return free_.capacity() * sizeof(std::uint32_t); }

 private:
  std::uint32_t siblings_;
  std::uint32_t size_ = 1;
  std::vector<std::uint32_t> free_;
};

}  // namespace vislab
