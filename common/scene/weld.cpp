#include "common/scene/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace vislab {
namespace {

/// Ordered by bits, which orders NaN too.
std::array<std::uint32_t, 3> key_of(const glm::vec3& p) {
  const glm::vec3 unsigned_zero = p + 0.0F;
  return {std::bit_cast<std::uint32_t>(unsigned_zero.x),
          std::bit_cast<std::uint32_t>(unsigned_zero.y),
          std::bit_cast<std::uint32_t>(unsigned_zero.z)};
}

}  // namespace

std::vector<std::uint32_t> weld_positions(const std::vector<glm::vec3>& positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::array<std::uint32_t, 3> p = key_of(positions[a]);
    const std::array<std::uint32_t, 3> q = key_of(positions[b]);
    return p != q ? p < q : a < b;
  });
  std::vector<std::uint32_t> representative(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key_of(positions[order[i]]) == key_of(positions[order[i - 1]]);
    representative[order[i]] = same ? representative[order[i - 1]] : order[i];
  }
  return representative;
}

}  // namespace vislab
