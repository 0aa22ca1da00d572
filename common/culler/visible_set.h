// The set that a culler kept, as the harness records, hashes, stores and judges it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/culler/candidates.h"

namespace vislab {

/// A set of triangles of the scene as sorted, disjoint, non-adjacent runs of TriangleId. Sets are
/// compared without regard to the order of drawing.
class VisibleSet {
 public:
  struct Run {
    TriangleId first = 0;
    std::uint32_t count = 0;
    friend bool operator==(const Run&, const Run&) = default;
  };

  VisibleSet() = default;
  /// Sorts and merges; throws std::logic_error if a triangle is in two runs.
  explicit VisibleSet(std::vector<Run> runs);

  const std::vector<Run>& runs() const { return runs_; }
  /// O(log runs).
  bool contains(TriangleId triangle) const;
  /// Does any triangle in [first, first + count) belong to the set? O(log runs).
  bool intersects(TriangleId first, std::uint32_t count) const;
  std::uint64_t triangle_count() const;
  /// 32 hexadecimal digits.
  std::string hash() const;

  friend bool operator==(const VisibleSet&, const VisibleSet&) = default;

 private:
  std::vector<Run> runs_;
};

/// A sink that copies what it is given, in order. Reusable: clear() keeps the memory.
class RecordingSink : public DrawSink {
 public:
  /// `frame` says what "everything" is and outlives the recording.
  void start(const Scene& scene, const Frame& frame);

  void everything() override;
  void objects(std::span<const ObjectId> ids) override;
  void ranges(std::span<const TriangleRange> ranges) override;
  void flush() override { ++flushes_; }

  /// Everything emitted since start(), in draw order; whole objects as one range.
  const std::vector<TriangleRange>& emitted() const { return emitted_; }
  std::uint64_t flushes() const { return flushes_; }
  /// The set emitted since start(). Throws std::logic_error if a triangle was emitted twice.
  VisibleSet set() const;

 private:
  const Scene* scene_ = nullptr;
  const Frame* frame_ = nullptr;
  std::vector<TriangleRange> emitted_;
  std::uint64_t flushes_ = 0;
};

}  // namespace vislab
