// What the methods without a hierarchy share: the list of a frame's objects from near to far, with
// the boxes to ask about, and the list of those that are kept.
//
// Cost: O(n log n) for n candidates; nothing is allocated once the lists have their size.
// Source: Zachmann, Computer-Graphik 2, SS 2012, slide 59.
#pragma once

#include <span>
#include <vector>

#include "algorithms/occlusion/box_queries.h"

namespace vislab::occlusion_culling {

/// An object in the view.
struct ListedObject {
  double nearness = 0.0;
  ObjectId object = 0;
  bool askable = false;
  Aabb asked;  // if askable
};

/// The candidates of one call of cull() that are in the view, near ones first; equally near ones by
/// their ids.
class ObjectList {
 public:
  void reserve(std::size_t objects) { listed_.reserve(objects); }
  void fill(const Frame& frame, const Candidates& candidates);

  std::span<const ListedObject> objects() const { return listed_; }
  /// Candidates that were left out so far because they are surely outside of the view.
  std::uint64_t outside() const { return outside_; }
  std::size_t bytes() const { return listed_.capacity() * sizeof(ListedObject); }

 private:
  BoxView view_;
  std::vector<ListedObject> listed_;
  std::uint64_t outside_ = 0;
};

/// What a call of cull() keeps, in the order of drawing, and how much of it was emitted.
class KeptObjects {
 public:
  void reserve(std::size_t objects) { kept_.reserve(objects); }
  /// Before every call of cull(). Spans that were emitted are no longer needed.
  void clear() {
    kept_.clear();
    emitted_ = 0;
  }
  void add(ObjectId object) { kept_.push_back(object); }
  /// Emits what was added since the last time. False if there is nothing.
  bool emit(DrawSink& out);
  /// Has what was added drawn now: what is asked afterwards is asked against it.
  void draw(DrawSink& out) {
    if (emit(out)) out.flush();
  }
  std::size_t bytes() const { return kept_.capacity() * sizeof(ObjectId); }

 private:
  std::vector<ObjectId> kept_;
  std::size_t emitted_ = 0;
};

}  // namespace vislab::occlusion_culling
