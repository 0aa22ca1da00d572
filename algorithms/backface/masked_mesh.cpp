#include "algorithms/backface/masked_mesh.h"

#include <algorithm>

#include "algorithms/backface/back_bits.h"

namespace vislab::backface_culling {

MaskedMesh::MaskedMesh(const Mesh& mesh, const MeshFrame& frame, const DirectionCube& cube)
    : offsets_(mesh.triangles.size() + mask_kernel_padding, 0),
      bits_(mesh.triangles.size() + mask_kernel_padding, 0),
      blocks_((mesh.triangles.size() + block_size - 1) / block_size),
      whole_(1) {
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    if (const std::optional<int> found = cube.class_of(mesh, triangle)) {
      offsets_[triangle] = static_cast<std::uint8_t>(*found / 8);
      bits_[triangle] = static_cast<std::uint8_t>(1 << (*found % 8));
    }
    const glm::dvec3 point = glm::dvec3(mesh.positions[mesh.triangles[triangle].x]) - frame.middle;
    blocks_.add(triangle / block_size, point);
    whole_.add(0, point);
  }
}

std::size_t MaskedMesh::bytes() const {
  return offsets_.capacity() + bits_.capacity() + blocks_.bytes() + whole_.bytes();
}

void MaskMarker::start(const MaskedMesh& mesh, const MeshFrame& frame, const Camera& camera,
                       const glm::dmat4x3& transform) {
  mesh_ = &mesh;
  masks_->select(glm::dmat3(transform[0], transform[1], transform[2]));
  if (masks_->orthographic()) {
    mask_ = &masks_->orthographic_mask();
    return;
  }
  rows_ = sector_rows(camera, masks_->lines(), transform, frame);
  Rectangle whole;
  find_rectangles(rows_, mesh.whole(), 0, 1, &whole);
  mask_ = nullptr;
  if (whole.known() && (whole.is_one_sector() || mesh.blocks().count() == 1)) {
    masks_->make_room(1);
    const std::uint16_t number = masks_->number_of(whole);
    mask_ = masks_->masks() + number;
  }
}

void MaskMarker::mark(std::uint32_t first, std::uint32_t count, std::uint64_t* back) {
  if (count == 0) return;
  if (mask_ != nullptr) {
    look_up(*mask_, mesh_->offsets() + first, mesh_->bits() + first, count, back);
    return;
  }
  const std::uint32_t first_word = first / 64;
  const std::uint32_t words = (first + count - 1) / 64 - first_word + 1;
  const std::uint32_t shift = first % 64;
  if (shift == 0) {
    mark_words(first_word, words, back);
    return;
  }
  words_.resize(std::max<std::size_t>(words_.size(), words + 1));
  mark_words(first_word, words, words_.data());
  words_[words] = 0;
  for (std::size_t w = 0; w < words_of(count); ++w) {
    back[w] = words_[w] >> shift | words_[w + 1] << (64 - shift);
  }
}

/// Words of the whole mesh's answer.
void MaskMarker::mark_words(std::uint32_t first_word, std::uint32_t words, std::uint64_t* back) {
  static_assert(MaskedMesh::block_size % 64 == 0);
  constexpr std::uint32_t words_in_block = MaskedMesh::block_size / 64;
  // The rectangles of so many words at a time have room among the masks.
  constexpr std::uint32_t most = 1024;
  rectangles_.resize(most);
  numbers_.resize(most);
  for (std::uint32_t done = 0; done < words; done += most) {
    const std::uint32_t first = first_word + done;
    const std::uint32_t count = std::min(most, words - done);
    const std::uint32_t first_block = first / words_in_block;
    const std::uint32_t blocks = (first + count - 1) / words_in_block - first_block + 1;
    find_rectangles(rows_, mesh_->blocks(), first_block, blocks, rectangles_.data());
    masks_->make_room(blocks);
    std::uint16_t number = 0;
    std::uint32_t word = 0;
    for (std::uint32_t block = 0; block < blocks; ++block) {
      const bool again = block > 0 && rectangles_[block] == rectangles_[block - 1];
      if (!again) number = masks_->number_of(rectangles_[block]);
      const std::uint32_t end = std::min((first_block + block + 1) * words_in_block - first, count);
      while (word < end) numbers_[word++] = number;
    }
    look_up_words(masks_->masks(), numbers_.data(), mesh_->offsets() + std::size_t{64} * first,
                  mesh_->bits() + std::size_t{64} * first, count, back + done);
  }
}

}  // namespace vislab::backface_culling
