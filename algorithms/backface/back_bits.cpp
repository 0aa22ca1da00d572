#include "algorithms/backface/back_bits.h"

namespace vislab::backface_culling {

void append_kept(const TriangleRange& offered, std::span<const std::uint64_t> back,
                 std::uint32_t base, std::vector<TriangleRange>& kept) {
  if (offered.count == 0) return;
  const std::uint32_t first = offered.first - base;
  const std::uint32_t end = first + offered.count;
  const std::uint32_t last_word = (end - 1) / 64;
  std::uint32_t start = 0;
  bool open = false;
  std::uint64_t before = 0;  // was the triangle before this word kept?
  for (std::uint32_t word = first / 64; word <= last_word; ++word) {
    std::uint64_t now = ~back[word];
    if (word == first / 64) now &= ~std::uint64_t{0} << (first % 64);
    if (word == last_word) now &= ~std::uint64_t{0} >> (63 - (end - 1) % 64);
    // Runs begin and end in turn where a triangle differs from the one before it.
    for (std::uint64_t turns = now ^ ((now << 1U) | before); turns != 0; turns &= turns - 1) {
      const std::uint32_t at = word * 64 + static_cast<std::uint32_t>(std::countr_zero(turns));
      if (open) {
        kept.push_back({offered.object, base + start, at - start});
      } else {
        start = at;
      }
      open = !open;
    }
    before = now >> 63U;
  }
  if (open) kept.push_back({offered.object, base + start, end - start});
}

}  // namespace vislab::backface_culling
