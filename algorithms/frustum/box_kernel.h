// The inner loops of frustum.flat: many boxes against the float planes of a FrustumFilter, 64 to a
// word of the answer.
//
// Layout: blocks of 64 boxes, each coordinate a row of 64 floats. Of the six rows, a plane needs
//   three (which ones depends on the signs of its normal alone: the p-vertex), and every memory
//   access is one run of consecutive floats. Planes are the outer loop within a block, so that the
//   four numbers of a plane are loaded once for 64 boxes.
// Guarantee: the answers are those of FrustumFilter, lane by lane; how the sums are rounded depends
//   on the instruction set, so what is undecided may differ, but never what is decided.
// Cost: per box and plane three fused multiply-adds and a minimum; 24 bytes read a box.
// Source: Assarsson and Moeller 2000 (p-vertex).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/geometry/frustum_filter.h"

namespace vislab::frustum_culling {

inline constexpr std::size_t block_size = 64;

/// 64 boxes relative to the filter's origin, one coordinate a row: min x, y, z, max x, y, z. A box
/// that the filter may not decide about has NaN in all six.
struct alignas(64) BoxBlock {
  enum Row { min_x, min_y, min_z, max_x, max_y, max_z };
  std::array<std::array<float, block_size>, 6> rows;
};

/// What is known of a block from a box around its boxes: bit i is set if plane i has to be asked
/// for the boxes themselves; `outside_block` if they all are outside of one plane.
using BlockState = std::uint8_t;
inline constexpr BlockState outside_block = 0x80;

/// One bit a box, lowest first. A box is out if its bit is neither in `kept` nor in `undecided`.
struct BoxWord {
  std::uint64_t kept = 0;       // sure to be kept
  std::uint64_t undecided = 0;  // the double test has to decide
};

/// Every box against every plane. `words` has one entry a block.
void test_boxes(std::span<const FilterPlane> planes, std::span<const BoxBlock> blocks,
                std::span<BoxWord> words);

/// Every box against the planes that the state of its block names; boxes of outside blocks are out.
/// `states` and `words` have one entry a block.
void test_boxes(std::span<const FilterPlane> planes, std::span<const BoxBlock> blocks,
                std::span<const BlockState> states, std::span<BoxWord> words);

/// The states of blocks from the boxes around them, 64 of which are one BoxBlock here. `states` has
/// 64 entries for each. A box with NaN gives all planes.
void test_block_boxes(std::span<const FilterPlane> planes, std::span<const BoxBlock> boxes,
                      std::span<BlockState> states);

/// The box around all 64 boxes of a block becomes box `lane` of `outer`. No NaN in the block.
void enclose_block(const BoxBlock& block, BoxBlock& outer, std::size_t lane);

}  // namespace vislab::frustum_culling
