#include "algorithms/portal/pvs_rows.h"

namespace vislab::portal_culling {

void CompressedRows::clear(std::size_t bits_in_row) {
  bits_in_row_ = bits_in_row;
  first_.assign(1, 0);
  bytes_.clear();
}

void CompressedRows::add(std::span<const std::uint64_t> words) {
  const std::size_t count = (bits_in_row_ + 7) / 8;
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint8_t>(words[i / 8] >> (8 * (i % 8)) & 0xFFU);
  };
  for (std::size_t i = 0; i < count;) {
    const std::uint8_t value = byte(i++);
    bytes_.push_back(value);
    if (value != 0) continue;
    std::uint8_t run = 1;
    while (i < count && run < 255 && byte(i) == 0) {
      ++run;
      ++i;
    }
    bytes_.push_back(run);
  }
  first_.push_back(static_cast<std::uint32_t>(bytes_.size()));
}

void CompressedRows::finish() {
  first_.shrink_to_fit();
  bytes_.shrink_to_fit();
}

void CompressedRows::unite(std::size_t row, std::span<std::uint64_t> words) const {
  std::size_t to = 0;
  for (std::uint32_t i = first_[row]; i < first_[row + 1]; ++i) {
    if (bytes_[i] == 0) {
      to += bytes_[++i];
    } else {
      words[to / 8] |= std::uint64_t{bytes_[i]} << (8 * (to % 8));
      ++to;
    }
  }
}

}  // namespace vislab::portal_culling
