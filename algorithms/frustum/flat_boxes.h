// The boxes of all objects as frustum.flat's SIMD kernel wants them: blocks of 64, in the order of
// ids or in groups of near neighbours.
//
// Idea: a linear scan that answers with a bitmask. Boxes are float coordinates relative to the
//   middle of the scene; FrustumFilter decides nearly all of them, and the double test the rest. In
//   groups, boxes are ordered by splitting them at the median along the longer side, again and
//   again, down to the blocks; a block whose own box is outside of a plane or inside of all is
//   decided at once, and its boxes are compared only with the planes that cut the block's box.
// Guarantee: a bit is 0 exactly if surely_outside() holds of a plane, or the object is hidden.
// Cost: six planes a box, or six a block and few planes for the boxes of blocks that the frustum's
//   surface passes through. Ordering: O(n log n) once. A move: O(1), and O(64) for its block.
// Limits: what moves keeps its place in the order, so groups widen; they are ordered again when
//   their boxes have twice the surface, but not before 256 frames have paid for it. Boxes far
//   outside of where most are, and boxes that are not valid, go to the double test.
// Sources: Assarsson and Moeller 2000 (p-vertex, plane masking), with a hierarchy of two levels.
#pragma once

#include <tbb/task_arena.h>

#include <vector>

#include "algorithms/frustum/box_kernel.h"
#include "common/scene/frame.h"

namespace vislab::frustum_culling {

class FlatBoxes {
 public:
  enum class Order { ids, groups };

  explicit FlatBoxes(Order order, int threads = 1);

  /// Boxes by object id, world frame; all are shown. The same boxes give the same order.
  void build(std::span<const Aabb> boxes);
  /// Follows moved, shown and hidden objects; `boxes` as they are now. Once a frame.
  void update(std::span<const Aabb> boxes, const Changes& changes);

  /// One bit a slot, lowest first: is the object to be kept? `boxes` as at the last build or
  /// update. The last word's bits beyond the objects are 0. Valid until the next call.
  std::span<const std::uint64_t> cull(const Frustum& frustum, std::span<const Aabb> boxes);

  /// The objects by slot, with some padding at the end.
  std::span<const ObjectId> objects_by_slot() const { return object_at_; }
  std::uint32_t slot_of(ObjectId object) const { return slot_of_[object]; }
  std::size_t object_count() const { return slot_of_.size(); }
  std::size_t shown_count() const { return shown_count_; }

  /// Planes that boxes and blocks were compared with since the start.
  std::uint64_t plane_tests() const { return plane_tests_; }
  std::size_t bytes() const;

 private:
  struct Center {
    std::array<float, 3> at;
    ObjectId object;
  };

  void arrange(std::span<const Aabb> boxes);
  void choose_origin(std::span<const Aabb> boxes);
  void choose_order(std::span<const Aabb> boxes);
  void split(std::size_t first, std::size_t last);
  /// Writes the box of a slot, or NaN if the filter may not decide about it.
  void place(std::size_t slot, const Aabb& box);
  void set_shown(ObjectId object, bool shown);
  /// Brings the box around a block's boxes up to date.
  void enclose(std::size_t block);
  double surface_of(std::size_t block) const;
  std::uint64_t cull_blocks(const Frustum& frustum, const FrustumFilter& filter,
                            std::span<const Aabb> boxes, std::size_t first, std::size_t last);
  std::uint64_t resolve(const Frustum& frustum, std::span<const Aabb> boxes, std::size_t block,
                        std::uint64_t undecided) const;

  Order order_;
  int threads_;
  tbb::task_arena arena_;

  glm::vec3 origin_{0.0F};
  float extent_ = 1.0F;
  std::vector<float> scratch_;          // while choosing them
  std::vector<ObjectId> object_at_;     // by slot, padded to whole blocks
  std::vector<std::uint32_t> slot_of_;  // by object
  std::vector<BoxBlock> blocks_;
  std::vector<std::uint64_t> shown_;    // one bit a slot
  std::vector<std::uint64_t> strays_;   // one bit a slot: has NaN instead of its box
  std::vector<std::uint8_t> is_shown_;  // by object
  std::size_t shown_count_ = 0;
  std::size_t stray_count_ = 0;
  std::size_t strays_at_build_ = 0;

  // Only in groups.
  std::vector<BoxBlock> block_boxes_;  // around each block's boxes, 64 a BoxBlock
  std::vector<BlockState> states_;     // by block
  std::vector<std::uint8_t> dirty_;    // by block
  std::vector<std::uint32_t> dirty_list_;
  std::vector<Center> centers_;  // while ordering
  double surface_ = 0.0;         // of all blocks' boxes, square metres
  double surface_at_build_ = 0.0;
  int frames_since_build_ = 0;

  std::vector<BoxWord> words_;       // by block
  std::vector<std::uint64_t> kept_;  // the answer
  std::uint64_t plane_tests_ = 0;
};

/// Writes the ids whose bit is set to `out`, in order, 64 ids to a word, and returns how many.
std::size_t select_ids(std::span<const std::uint64_t> words, std::span<const ObjectId> ids,
                       ObjectId* out);

}  // namespace vislab::frustum_culling
