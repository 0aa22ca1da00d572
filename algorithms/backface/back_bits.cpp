#include "algorithms/backface/back_bits.h"

#include <algorithm>

namespace vislab::backface_culling {
namespace {

/// First position in [from, end) whose bit is `set`; end if there is none.
std::uint32_t find(std::span<const std::uint64_t> bits, std::uint32_t from, std::uint32_t end,
                   bool set) {
  if (from >= end) return end;
  const std::uint64_t flip = set ? 0 : ~std::uint64_t{0};
  std::uint32_t word = from / 64;
  std::uint64_t rest = (bits[word] ^ flip) & (~std::uint64_t{0} << (from & 63U));
  while (rest == 0) {
    if (++word * 64 >= end) return end;
    rest = bits[word] ^ flip;
  }
  return std::min(end, word * 64 + static_cast<std::uint32_t>(std::countr_zero(rest)));
}

}  // namespace

void append_kept(const TriangleRange& offered, std::span<const std::uint64_t> back,
                 std::uint32_t base, std::vector<TriangleRange>& kept) {
  const std::uint32_t end = offered.first - base + offered.count;
  std::uint32_t first = find(back, offered.first - base, end, false);
  while (first < end) {
    const std::uint32_t last = find(back, first, end, true);
    kept.push_back({offered.object, base + first, last - first});
    first = find(back, last, end, false);
  }
}

}  // namespace vislab::backface_culling
