// Lists of triangles that are marked together, as short as they can be kept.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/error.h"

namespace vislab::backface_culling {

/// Runs of consecutive triangles of a mesh, 4 bytes each: at most 32 triangles that lie in one word
/// of 64, so that marking a run is one operation on one word.
class RunList {
 public:
  static constexpr std::uint32_t longest = 32;
  static constexpr std::uint32_t most_triangles = 1U << 27U;

  /// Throws InputError for a mesh that has too many triangles to be numbered here.
  static void check(std::size_t triangles);

  /// Appends ascending triangles.
  void append(std::span<const std::uint32_t> triangles);

  /// Sets the bits of the triangles of runs [first, end).
  void mark(std::uint32_t first, std::uint32_t end, std::uint64_t* bits) const {
    for (std::uint32_t i = first; i < end; ++i) bits[word(i)] |= mask(i);
  }
  /// Sets the bits of those triangles of runs [first, end) for which the bit of `chosen` is set:
  /// bit i is the i-th of their triangles. No more than 64 of them.
  void mark_chosen(std::uint32_t first, std::uint32_t end, std::uint64_t chosen,
                   std::uint64_t* bits) const {
    std::uint32_t before = 0;
    for (std::uint32_t i = first; i < end; ++i) {
      const std::uint32_t rest = runs_[i] % longest;  // count - 1
      bits[word(i)] |= ((chosen >> before) & ((std::uint64_t{2} << rest) - 1))
                       << (runs_[i] / longest % 64);
      before += rest + 1;
    }
  }
  /// Clears them.
  void unmark(std::uint32_t first, std::uint32_t end, std::uint64_t* bits) const {
    for (std::uint32_t i = first; i < end; ++i) bits[word(i)] &= ~mask(i);
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(runs_.size()); }
  void shrink() { runs_.shrink_to_fit(); }
  std::size_t bytes() const { return runs_.capacity() * sizeof(std::uint32_t); }

 private:
  std::uint32_t word(std::uint32_t run) const { return runs_[run] / (longest * 64); }
  std::uint64_t mask(std::uint32_t run) const {
    return ((std::uint64_t{2} << (runs_[run] % longest)) - 1) << (runs_[run] / longest % 64);
  }

  std::vector<std::uint32_t> runs_;  // first triangle * longest + count - 1
};

/// Words of 64 triangles and which of them are meant, 12 bytes each: shorter than runs where many
/// triangles are scattered.
class WordList {
 public:
  /// Appends ascending triangles.
  void append(std::span<const std::uint32_t> triangles);
  /// How many words these would be.
  static std::uint32_t words_for(std::span<const std::uint32_t> triangles);

  /// Sets the bits of the triangles of words [first, end).
  void mark(std::uint32_t first, std::uint32_t end, std::uint64_t* bits) const {
    for (std::uint32_t i = first; i < end; ++i) bits[words_[i]] |= masks_[i];
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(words_.size()); }
  void shrink() {
    words_.shrink_to_fit();
    masks_.shrink_to_fit();
  }
  std::size_t bytes() const {
    return words_.capacity() * sizeof(std::uint32_t) + masks_.capacity() * sizeof(std::uint64_t);
  }

 private:
  std::vector<std::uint32_t> words_;
  std::vector<std::uint64_t> masks_;
};

}  // namespace vislab::backface_culling
