// Compiled once for each instruction set, by Highway; also for AVX-512 with byte permutations.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/mask_kernel.cpp"
#define HWY_WANT_AVX3_DL
#include "algorithms/backface/mask_kernel.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace vislab::backface_culling::HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_AVX3_DL

void look_up_words(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
                   std::size_t words, std::uint64_t* back) {
  const __m512i low_0 = _mm512_load_si512(mask.bytes.data());
  const __m512i low_1 = _mm512_load_si512(mask.bytes.data() + 64);
  const __m512i high_0 = _mm512_load_si512(mask.bytes.data() + 128);
  const __m512i high_1 = _mm512_load_si512(mask.bytes.data() + 192);
  for (std::size_t w = 0; w < words; ++w) {
    const __m512i offset = _mm512_loadu_si512(offsets + 64 * w);
    // The lowest 7 bits choose among the 128 bytes of two registers.
    const __m512i low = _mm512_permutex2var_epi8(low_0, offset, low_1);
    const __m512i high = _mm512_permutex2var_epi8(high_0, offset, high_1);
    const __m512i byte = _mm512_mask_blend_epi8(_mm512_movepi8_mask(offset), low, high);
    back[w] = _mm512_test_epi8_mask(byte, _mm512_loadu_si512(bits + 64 * w));
  }
}

#elif HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 || \
    HWY_TARGET == HWY_SSSE3

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::CappedTag<std::uint8_t, 64>;
using SignedBytes = hn::RebindToSigned<Bytes>;
constexpr std::size_t lanes = HWY_MIN(HWY_LANES(std::uint8_t), 64);
constexpr std::size_t vectors_in_word = 64 / lanes;
constexpr std::size_t pieces_in_half = 8;

bool is_zero(const BackMask& mask, std::size_t piece) {
  const auto first = mask.bytes.begin() + static_cast<std::ptrdiff_t>(16 * piece);
  return std::all_of(first, first + 16, [](std::uint8_t byte) { return byte == 0; });
}

void look_up_words(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
                   std::size_t words, std::uint64_t* back) {
  const Bytes d;
  const SignedBytes ds;
  HWY_ALIGN std::uint8_t pieces[2 * pieces_in_half][lanes];
  for (std::size_t k = 0; k < 2 * pieces_in_half; ++k) {
    auto piece = hn::LoadDup128(d, mask.bytes.data() + 16 * k);
    if (k % pieces_in_half != 0) {
      piece = hn::Xor(piece, hn::LoadDup128(d, mask.bytes.data() + 16 * (k - 1)));
    }
    hn::Store(piece, d, pieces[k]);
  }
  // Behind the last piece that is not zero stands its own difference to zero, and then nothing: a
  // direction cube of 16 x 16 squares a side needs 13 pieces of the 16.
  std::size_t high_pieces = pieces_in_half;
  while (high_pieces > 0 && is_zero(mask, pieces_in_half + high_pieces - 1)) --high_pieces;
  if (high_pieces > 0 && high_pieces < pieces_in_half) ++high_pieces;
  const auto sixteen = hn::Set(ds, std::int8_t{16});
  const auto flip = hn::Set(d, std::uint8_t{0x80});
  for (std::size_t w = 0; w < words; ++w) {
    // Two vectors at a time: each piece is loaded once for both.
    std::uint64_t word = 0;
    constexpr std::size_t step = HWY_MIN(vectors_in_word, 2);
    for (std::size_t v = 0; v < vectors_in_word; v += step) {
      hn::Vec<SignedBytes> low[step];
      hn::Vec<SignedBytes> high[step];
      hn::Vec<Bytes> byte[step];
      for (std::size_t i = 0; i < step; ++i) {
        const auto offset = hn::LoadU(d, offsets + 64 * w + (v + i) * lanes);
        low[i] = hn::BitCast(ds, offset);
        high[i] = hn::BitCast(ds, hn::Xor(offset, flip));
        byte[i] = hn::Zero(d);
      }
      for (std::size_t k = 0; k < pieces_in_half; ++k) {
        const auto piece = hn::Load(d, pieces[k]);
        for (std::size_t i = 0; i < step; ++i) {
          // A shuffle takes the lowest 4 bits, and answers 0 for negative numbers, which stay
          // negative because the subtraction does not go below -128.
          byte[i] = hn::Xor(byte[i], hn::TableLookupBytesOr0(piece, hn::BitCast(d, low[i])));
          low[i] = hn::SaturatedSub(low[i], sixteen);
        }
      }
      for (std::size_t k = 0; k < high_pieces; ++k) {
        const auto piece = hn::Load(d, pieces[pieces_in_half + k]);
        for (std::size_t i = 0; i < step; ++i) {
          byte[i] = hn::Xor(byte[i], hn::TableLookupBytesOr0(piece, hn::BitCast(d, high[i])));
          high[i] = hn::SaturatedSub(high[i], sixteen);
        }
      }
      for (std::size_t i = 0; i < step; ++i) {
        const auto own = hn::LoadU(d, bits + 64 * w + (v + i) * lanes);
        const auto set = hn::Ne(hn::And(byte[i], own), hn::Zero(d));
        std::array<std::uint8_t, 8> mask_bytes{};
        hn::StoreMaskBits(d, set, mask_bytes.data());
        std::uint64_t part = 0;
        std::memcpy(&part, mask_bytes.data(), sizeof part);
        word |= part << ((v + i) * lanes);
      }
    }
    back[w] = word;
  }
}

#else

void look_up_words(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
                   std::size_t words, std::uint64_t* back) {
  look_up_scalar(mask, offsets, bits, 64 * words, back);
}

#endif

}  // namespace
}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

HWY_EXPORT(look_up_words);

void look_up(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
             std::size_t count, std::uint64_t* back) {
  const std::size_t words = (count + 63) / 64;
  HWY_DYNAMIC_DISPATCH(look_up_words)(mask, offsets, bits, words, back);
  if (count % 64 != 0) back[words - 1] &= ~std::uint64_t{0} >> (64 - count % 64);
}

void look_up_scalar(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
                    std::size_t count, std::uint64_t* back) {
  std::fill_n(back, (count + 63) / 64, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_back = (mask.bytes[offsets[i]] & bits[i]) != 0;
    back[i / 64] |= std::uint64_t{is_back} << (i % 64);
  }
}

}  // namespace vislab::backface_culling
#endif
