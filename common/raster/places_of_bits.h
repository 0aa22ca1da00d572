// Which bits of a byte are set, to pack lanes of vectors: Highway's own packing copies its table at
// every call for some instruction sets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace vislab {

/// By byte: the places of the bits that are set, in order; then zeros.
alignas(64) inline constexpr auto places_of_bits = [] {
  std::array<std::array<std::uint8_t, 8>, 256> places{};
  for (std::size_t bits = 0; bits < places.size(); ++bits) {
    std::size_t count = 0;
    for (std::uint8_t bit = 0; bit < 8; ++bit) {
      if ((bits >> bit & 1U) != 0) places[bits][count++] = bit;
    }
  }
  return places;
}();

}  // namespace vislab
