#include "algorithms/backface/run_list.h"

#include <string>

namespace vislab::backface_culling {

void RunList::check(std::size_t triangles) {
  if (triangles > most_triangles) {
    throw InputError("a mesh of " + std::to_string(triangles) +
                     " triangles is too large for clusters of back faces: at most " +
                     std::to_string(most_triangles));
  }
}

void RunList::append(std::span<const std::uint32_t> triangles) {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  for (const std::uint32_t triangle : triangles) {
    const bool follows =
        count > 0 && count < longest && triangle == first + count && triangle % 64 != 0;
    if (follows) {
      ++runs_.back();
      ++count;
    } else {
      runs_.push_back(triangle * longest);
      first = triangle;
      count = 1;
    }
  }
}

void WordList::append(std::span<const std::uint32_t> triangles) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i == 0 || triangles[i] / 64 != triangles[i - 1] / 64) {
      words_.push_back(triangles[i] / 64);
      masks_.push_back(0);
    }
    masks_.back() |= std::uint64_t{1} << (triangles[i] % 64);
  }
}

std::uint32_t WordList::words_for(std::span<const std::uint32_t> triangles) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    count += i == 0 || triangles[i] / 64 != triangles[i - 1] / 64 ? 1 : 0;
  }
  return count;
}

}  // namespace vislab::backface_culling
