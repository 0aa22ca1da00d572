#include "common/spatial/morton.h"

#include <array>

namespace vislab {
namespace {

constexpr float cells = 1024.0F;

/// Ten bits, with two zeros between any two.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | (bits << 16U)) & 0x030000FFU;
  bits = (bits | (bits << 8U)) & 0x0300F00FU;
  bits = (bits | (bits << 4U)) & 0x030C30C3U;
  return (bits | (bits << 2U)) & 0x09249249U;
}

}  // namespace

MortonGrid::MortonGrid(const Aabb& domain) : low_(domain.min), cells_per_m_(0.0F) {
  if (domain.empty()) return;
  const glm::dvec3 size = domain.half_size() * 2.0;
  for (int axis = 0; axis < 3; ++axis) {
    // Of extents so small that the quotient is infinite, all is one cell.
    const auto scale = static_cast<float>(static_cast<double>(cells) / size[axis]);
    if (scale <= std::numeric_limits<float>::max()) cells_per_m_[axis] = scale;
  }
}

std::uint32_t MortonGrid::code(const glm::vec3& p) const {
  const glm::vec3 cell = glm::clamp((p - low_) * cells_per_m_, 0.0F, cells - 1.0F);
  return spread(static_cast<std::uint32_t>(cell.x)) |
         (spread(static_cast<std::uint32_t>(cell.y)) << 1U) |
         (spread(static_cast<std::uint32_t>(cell.z)) << 2U);
}

void sort_by_code(std::vector<MortonKey>& keys, std::vector<MortonKey>& scratch) {
  // Three passes of ten bits, least significant first; all counts are taken in one go.
  constexpr std::uint32_t bits = 10;
  constexpr std::uint32_t mask = (1U << bits) - 1;
  std::array<std::array<std::uint32_t, mask + 1>, 3> first{};
  for (const MortonKey& key : keys) {
    for (std::uint32_t pass = 0; pass < 3; ++pass) {
      ++first[pass][(key.code >> (bits * pass)) & mask];
    }
  }
  scratch.resize(keys.size());
  for (std::uint32_t pass = 0; pass < 3; ++pass) {
    std::uint32_t sum = 0;
    for (std::uint32_t& entry : first[pass]) {
      const std::uint32_t count = entry;
      entry = sum;
      sum += count;
    }
    for (const MortonKey& key : keys) {
      scratch[first[pass][(key.code >> (bits * pass)) & mask]++] = key;
    }
    keys.swap(scratch);
  }
}

}  // namespace vislab
