// Normal masks at work: which triangles of a mesh face away, by two bytes each and the masks of the
// sectors of the view that they are seen in. What backface.normal_mask does for each object.
#pragma once

#include <vector>

#include "algorithms/backface/view_masks.h"
#include "common/spatial/huge_pages.h"

namespace vislab::backface_culling {

/// The classes of a mesh's triangles.
class MaskedMesh {
 public:
  /// Triangles that share a rectangle of the view, whole words of the answer. Blocks of half the
  /// size find up to a tenth more on scanned meshes and take a third longer.
  static constexpr std::uint32_t block_size = 128;

  MaskedMesh() = default;
  /// O(triangles).
  MaskedMesh(const Mesh& mesh, const MeshFrame& frame, const DirectionCube& cube);

  /// By triangle, padded for the kernel. Bits of 0: of no class, never culled.
  const std::uint8_t* offsets() const { return offsets_.data(); }
  const std::uint8_t* bits() const { return bits_.data(); }
  /// Around one point of each triangle of a block, and around all of these points. One is enough:
  /// on which side of a triangle's plane the eye is can be asked at any of its points.
  const PointBoxes& blocks() const { return blocks_; }
  const PointBoxes& whole() const { return whole_; }
  /// Two a triangle, and 24 a block.
  std::size_t bytes() const;

 private:
  using Bytes = std::vector<std::uint8_t, HugePageAllocator<std::uint8_t>>;

  Bytes offsets_;
  Bytes bits_;
  PointBoxes blocks_;
  PointBoxes whole_;
};

/// Marks the triangles of one object after the other that face away.
class MaskMarker {
 public:
  /// `masks` outlives it.
  explicit MaskMarker(ViewMasks& masks) : masks_(&masks) {}

  /// The object whose triangles come next: a mesh that outlives the marker, placed by `transform`.
  /// ViewMasks::start was called for the camera.
  void start(const MaskedMesh& mesh, const MeshFrame& frame, const Camera& camera,
             const glm::dmat4x3& transform);
  /// Writes words_of(count) words to `back`: bit i tells that triangle first + i surely faces away;
  /// bits beyond `count` are of no matter. O(count).
  void mark(std::uint32_t first, std::uint32_t count, std::uint64_t* back);

 private:
  void mark_words(std::uint32_t first_word, std::uint32_t words, std::uint64_t* back);

  ViewMasks* masks_;
  const MaskedMesh* mesh_ = nullptr;
  const BackMask* mask_ = nullptr;  // of all of the object's triangles, if they share one
  SectorRows rows_{};
  std::vector<Rectangle> rectangles_;
  std::vector<std::uint16_t> numbers_;
  std::vector<std::uint64_t> words_;  // of ranges that begin within a word
};

}  // namespace vislab::backface_culling
