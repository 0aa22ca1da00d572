// Compiled once for each instruction set, by Highway. Byte permutations of AVX-512 have a file of
// their own: another choice of instruction sets for one file alone would confuse Highway's tables.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/mask_kernel.cpp"
#include "algorithms/backface/mask_kernel.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "algorithms/backface/mask_permute.h"
#include "common/simd/simd_target.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::backface_culling::HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 || \
    HWY_TARGET == HWY_SSSE3

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::CappedTag<std::uint8_t, 64>;
using SignedBytes = hn::RebindToSigned<Bytes>;
constexpr std::size_t lanes = HWY_MIN(HWY_LANES(std::uint8_t), 64);
constexpr std::size_t vectors_in_word = 64 / lanes;
constexpr std::size_t pieces_in_half = 8;

/// A mask as differences of its pieces.
class Table {
 public:
  HWY_INLINE void load(const BackMask& mask) {
    const Bytes d;
    const hn::Full128<std::uint8_t> d16;
    for (std::size_t k = 0; k < 2 * pieces_in_half; ++k) {
      auto piece = hn::LoadDup128(d, mask.bytes.data() + 16 * k);
      if (k % pieces_in_half != 0) {
        piece = hn::Xor(piece, hn::LoadDup128(d, mask.bytes.data() + 16 * (k - 1)));
      }
      hn::Store(piece, d, pieces_[k]);
    }
    // Behind the last piece that is not zero stands its own difference to zero, and then nothing: a
    // direction cube of 16 x 16 squares a side needs 13 pieces of the 16.
    high_pieces_ = pieces_in_half;
    while (high_pieces_ > 0 &&
           hn::AllTrue(d16, hn::Eq(hn::Load(d16, mask.bytes.data() +
                                                     16 * (pieces_in_half + high_pieces_ - 1)),
                                   hn::Zero(d16)))) {
      --high_pieces_;
    }
    if (high_pieces_ > 0 && high_pieces_ < pieces_in_half) ++high_pieces_;
  }
  HWY_INLINE std::uint64_t word(const std::uint8_t* offsets, const std::uint8_t* bits) const {
    const Bytes d;
    const SignedBytes ds;
    const auto sixteen = hn::Set(ds, std::int8_t{16});
    const auto flip = hn::Set(d, std::uint8_t{0x80});
    // Two vectors at a time: each piece is loaded once for both.
    std::uint64_t word = 0;
    constexpr std::size_t step = HWY_MIN(vectors_in_word, 2);
    for (std::size_t v = 0; v < vectors_in_word; v += step) {
      hn::Vec<SignedBytes> low[step];
      hn::Vec<SignedBytes> high[step];
      hn::Vec<Bytes> byte[step];
      for (std::size_t i = 0; i < step; ++i) {
        const auto offset = hn::LoadU(d, offsets + (v + i) * lanes);
        low[i] = hn::BitCast(ds, offset);
        high[i] = hn::BitCast(ds, hn::Xor(offset, flip));
        byte[i] = hn::Zero(d);
      }
      for (std::size_t k = 0; k < pieces_in_half; ++k) {
        const auto piece = hn::Load(d, pieces_[k]);
        for (std::size_t i = 0; i < step; ++i) {
          // A shuffle takes the lowest 4 bits, and answers 0 for negative numbers, which stay
          // negative because the subtraction does not go below -128.
          byte[i] = hn::Xor(byte[i], hn::TableLookupBytesOr0(piece, hn::BitCast(d, low[i])));
          low[i] = hn::SaturatedSub(low[i], sixteen);
        }
      }
      for (std::size_t k = 0; k < high_pieces_; ++k) {
        const auto piece = hn::Load(d, pieces_[pieces_in_half + k]);
        for (std::size_t i = 0; i < step; ++i) {
          byte[i] = hn::Xor(byte[i], hn::TableLookupBytesOr0(piece, hn::BitCast(d, high[i])));
          high[i] = hn::SaturatedSub(high[i], sixteen);
        }
      }
      for (std::size_t i = 0; i < step; ++i) {
        const auto own = hn::LoadU(d, bits + (v + i) * lanes);
        const auto set = hn::Ne(hn::And(byte[i], own), hn::Zero(d));
        std::array<std::uint8_t, 8> mask_bytes{};
        hn::StoreMaskBits(d, set, mask_bytes.data());
        std::uint64_t part = 0;
        std::memcpy(&part, mask_bytes.data(), sizeof part);
        word |= part << ((v + i) * lanes);
      }
    }
    return word;
  }

 private:
  alignas(64) std::uint8_t pieces_[2 * pieces_in_half][lanes];
  std::size_t high_pieces_ = pieces_in_half;
};

#else

/// A mask as it is.
class Table {
 public:
  void load(const BackMask& mask) { mask_ = &mask; }
  std::uint64_t word(const std::uint8_t* offsets, const std::uint8_t* bits) const {
    std::uint64_t word = 0;
    look_up_scalar(*mask_, offsets, bits, 64, &word);
    return word;
  }

 private:
  const BackMask* mask_ = nullptr;
};

#endif

void look_up_all(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
                 std::size_t words, std::uint64_t* back) {
  Table table;
  table.load(mask);
  for (std::size_t w = 0; w < words; ++w) {
    back[w] = table.word(offsets + 64 * w, bits + 64 * w);
  }
}

void look_up_each(const BackMask* masks, const std::uint16_t* numbers, const std::uint8_t* offsets,
                  const std::uint8_t* bits, std::size_t words, std::uint64_t* back) {
  Table table;
  for (std::size_t w = 0; w < words; ++w) {
    if (w == 0 || numbers[w] != numbers[w - 1]) table.load(masks[numbers[w]]);
    back[w] = table.word(offsets + 64 * w, bits + 64 * w);
  }
}

void count_points(const SidePoints& points, std::size_t count, float limit, std::uint32_t* above) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<float, 16> f;
  const hn::RebindToUnsigned<hn::CappedTag<float, 16>> u;
  const auto one = hn::Set(u, std::uint32_t{1});
  const auto least = hn::Set(f, limit);
  for (std::size_t j = 0; j < SidePoints::most; j += hn::Lanes(f)) {
    const auto row = hn::Load(f, points.rows.data() + j);
    auto sum = hn::Zero(u);
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = hn::Add(row, hn::Set(f, points.columns[i]));
      sum = hn::Add(sum, hn::IfThenElseZero(hn::RebindMask(u, hn::Gt(value, least)), one));
    }
    hn::StoreU(sum, u, above + j);
  }
}

}  // namespace
}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

HWY_EXPORT(look_up_all);
HWY_EXPORT(look_up_each);
HWY_EXPORT(count_points);

void count_above(const SidePoints& points, std::size_t count, float limit, std::uint32_t* above) {
  HWY_DYNAMIC_DISPATCH(count_points)(points, count, limit, above);
}

void look_up_words(const BackMask* masks, const std::uint16_t* numbers, const std::uint8_t* offsets,
                   const std::uint8_t* bits, std::size_t words, std::uint64_t* back) {
  if (simd_byte_permutations()) {
    permute_each(masks, numbers, offsets, bits, words, back);
    return;
  }
  HWY_DYNAMIC_DISPATCH(look_up_each)(masks, numbers, offsets, bits, words, back);
}

void look_up(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
             std::size_t count, std::uint64_t* back) {
  const std::size_t words = (count + 63) / 64;
  if (simd_byte_permutations()) {
    permute_all(mask, offsets, bits, words, back);
  } else {
    HWY_DYNAMIC_DISPATCH(look_up_all)(mask, offsets, bits, words, back);
  }
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
