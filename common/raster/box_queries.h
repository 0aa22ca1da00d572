// Many boxes asked of one depth buffer: which of them may be seen.
//
// Idea: the boxes lie along the Z curve in blocks of sixteen, blocks in blocks of sixteen again up
//   to a single one. A block is placed in the window at once by SIMD: against the image's sides,
//   then its corners' window positions and nearness. A rectangle that the headers of the buffer's
//   tiles hide is hidden with all that is in it. Boxes that this leaves visible are tested by their
//   silhouette and true depths (box_silhouette.h).
// Guarantee: as project_box and hides_silhouette: what is reported hidden or outside shows no pixel
//   centre, in exact arithmetic and on a device. Boxes through the near plane and those that are
//   not valid, or reach beyond 10^12 m, are always visible. The same answers with every instruction
//   set.
// Cost: build O(n); a test O(what is visible + log n), at worst some 20 ns a box. 40 bytes a box.
// Source: own; headers of tiles as in Greene, Kass, Miller 1993.
#pragma once

#include <span>

#include "common/raster/box_blocks.h"
#include "common/raster/depth_raster.h"

namespace vislab {

class BoxQueries {
 public:
  /// The boxes have the ids 0, 1, … .
  explicit BoxQueries(std::span<const Aabb> boxes);

  std::size_t size() const { return places_.size(); }

  /// A box has moved: takes O(log n). What is asked gets slower as boxes leave their neighbours.
  void update(std::uint32_t id, const Aabb& box);

  /// Bit id % 64 of word id / 64: 1 if the box may be seen, else 0. `visible` has words_of(size())
  /// words, and all are written. Does not allocate from the second call on.
  void test(const DepthRaster& raster, std::span<std::uint64_t> visible);
  /// Only of some boxes: clears or sets their bits. O(ids).
  void test(const DepthRaster& raster, std::span<const std::uint32_t> ids,
            std::span<std::uint64_t> visible) const;

  static std::size_t words_of(std::size_t boxes) { return (boxes + 63) / 64; }

  /// Of the last test of all: blocks of sixteen placed, and boxes whose silhouettes were looked at.
  std::uint64_t blocks_placed() const { return walk_.blocks; }
  std::uint64_t silhouettes_tested() const { return walk_.silhouettes; }
  std::size_t bytes() const;

 private:
  void enclose(std::size_t level, std::size_t block);

  BoxLevels levels_;
  std::vector<std::uint32_t> ids_;     // by place: 16 * block + column
  std::vector<std::uint32_t> places_;  // by id
  BoxWalk walk_;
};

}  // namespace vislab
