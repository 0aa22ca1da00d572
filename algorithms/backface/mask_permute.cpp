#include "algorithms/backface/mask_permute.h"

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

namespace vislab::backface_culling {
namespace {

// The functions alone are compiled for these instructions, and called where the processor has them.
#define VISLAB_PERMUTES __attribute__((target("avx512f,avx512bw,avx512vbmi")))

/// A mask in registers.
struct Table {
  __m512i low_0, low_1, high_0, high_1;
};

VISLAB_PERMUTES inline void load(const BackMask& mask, Table& table) {
  table.low_0 = _mm512_load_si512(mask.bytes.data());
  table.low_1 = _mm512_load_si512(mask.bytes.data() + 64);
  table.high_0 = _mm512_load_si512(mask.bytes.data() + 128);
  table.high_1 = _mm512_load_si512(mask.bytes.data() + 192);
}

VISLAB_PERMUTES inline std::uint64_t word(const Table& table, const std::uint8_t* offsets,
                                          const std::uint8_t* bits) {
  const __m512i offset = _mm512_loadu_si512(offsets);
  // The lowest 7 bits choose among the 128 bytes of two registers, the highest between the two.
  const __m512i low = _mm512_permutex2var_epi8(table.low_0, offset, table.low_1);
  const __m512i high = _mm512_permutex2var_epi8(table.high_0, offset, table.high_1);
  const __m512i byte = _mm512_mask_blend_epi8(_mm512_movepi8_mask(offset), low, high);
  return _mm512_test_epi8_mask(byte, _mm512_loadu_si512(bits));
}

}  // namespace

VISLAB_PERMUTES void permute_all(const BackMask& mask, const std::uint8_t* offsets,
                                 const std::uint8_t* bits, std::size_t words, std::uint64_t* back) {
  Table table;
  load(mask, table);
  for (std::size_t w = 0; w < words; ++w) back[w] = word(table, offsets + 64 * w, bits + 64 * w);
}

VISLAB_PERMUTES void permute_each(const BackMask* masks, const std::uint16_t* numbers,
                                  const std::uint8_t* offsets, const std::uint8_t* bits,
                                  std::size_t words, std::uint64_t* back) {
  if (words == 0) return;
  Table table;
  load(masks[numbers[0]], table);
  for (std::size_t w = 0; w < words; ++w) {
    if (w > 0 && numbers[w] != numbers[w - 1]) load(masks[numbers[w]], table);
    back[w] = word(table, offsets + 64 * w, bits + 64 * w);
  }
}

}  // namespace vislab::backface_culling

#else

#include <stdexcept>

namespace vislab::backface_culling {

void permute_all(const BackMask&, const std::uint8_t*, const std::uint8_t*, std::size_t,
                 std::uint64_t*) {
  throw std::logic_error("this processor has no byte permutations");
}

void permute_each(const BackMask*, const std::uint16_t*, const std::uint8_t*, const std::uint8_t*,
                  std::size_t, std::uint64_t*) {
  throw std::logic_error("this processor has no byte permutations");
}

}  // namespace vislab::backface_culling

#endif
