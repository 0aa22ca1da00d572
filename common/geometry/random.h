// The lab's only source of random numbers: seeded, and the same on every machine.
#pragma once

#include <cstdint>

namespace vislab {

/// SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014):
/// 64 bits of state, every seed gives another sequence. The standard library's distributions differ
/// between implementations, so those that are needed stand here. Not for cryptography.
class Random {
 public:
  /// Random(seed + n * increment) goes on where Random(seed) stands after n numbers.
  static constexpr std::uint64_t increment = 0x9E3779B97F4A7C15ULL;

  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// All 64 bits are equally good.
  std::uint64_t bits() {
    state_ += increment;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform in 0 … count - 1, for 0 < count < 2^32; the bias of any value is below 2^-32.
  std::uint64_t below(std::uint64_t count) {
    const std::uint64_t high = bits() >> 32U;
    return (high * count) >> 32U;
  }

 private:
  std::uint64_t state_;
};

}  // namespace vislab
