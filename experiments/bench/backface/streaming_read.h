// How fast two arrays of bytes can be read at all.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vislab {

/// Sum modulo 2^64 of all words of 8 bytes in [a, a + count) and [b, b + count), count a
/// multiple of 128: one addition a load, with the widest loads of this processor.
std::uint64_t streaming_read(const std::uint8_t* a, const std::uint8_t* b, std::size_t count);

}  // namespace vislab
