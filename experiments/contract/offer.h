// Parts of a frame's objects, in every form in which candidates can be offered.
#pragma once

#include <string_view>
#include <vector>

#include "common/culler/visible_set.h"

namespace vislab {

enum class OfferKind { everything, objects, ranges, even_objects, odd_objects };

std::string_view to_string(OfferKind kind);

/// Candidates and the memory that they are views of.
class Offer {
 public:
  /// - everything;
  /// - objects: four shown objects out of five, last first, in three runs, one of them empty;
  /// - ranges: two thirds of the triangles of most shown objects, in pieces that alternate between
  ///   the objects, in two runs;
  /// - even_objects, odd_objects: every other shown object; together everything.
  Offer(OfferKind kind, const Scene& scene, const Frame& frame);
  Offer(const Offer&) = delete;
  Offer& operator=(const Offer&) = delete;

  const Candidates& candidates() const { return candidates_; }
  /// The triangles offered.
  const VisibleSet& set() const { return set_; }

 private:
  void fill_objects(OfferKind kind, const Frame& frame);
  void fill_ranges(const Scene& scene, const Frame& frame);

  std::vector<ObjectId> objects_;
  std::vector<TriangleRange> ranges_;
  std::vector<std::span<const ObjectId>> object_runs_;
  std::vector<std::span<const TriangleRange>> range_runs_;
  Candidates candidates_;
  VisibleSet set_;
};

/// The triangles of `a` that are not in `b`.
VisibleSet without(const VisibleSet& a, const VisibleSet& b);
/// The triangles of both; they have none in common.
VisibleSet united(const VisibleSet& a, const VisibleSet& b);

}  // namespace vislab
