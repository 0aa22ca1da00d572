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

}  // namespace vislab::backface_culling
