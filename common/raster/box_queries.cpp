#include "common/raster/box_queries.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/spatial/morton.h"

namespace vislab {
namespace {

constexpr std::size_t width = BoxColumns::width;
}  // namespace

BoxQueries::BoxQueries(std::span<const Aabb> boxes) : places_(boxes.size()) {
  Aabb domain;
  for (const Aabb& box : boxes) {
    if (BoxColumns::says_something(box)) domain.extend(glm::vec3(box.center()));
  }
  std::vector<MortonKey> keys(boxes.size()), scratch;
  const MortonGrid grid(domain.empty() ? Aabb{glm::vec3(0.0F), glm::vec3(0.0F)} : domain);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const glm::vec3 center =
        BoxColumns::says_something(boxes[i]) ? glm::vec3(boxes[i].center()) : glm::vec3(0.0F);
    keys[i] = {grid.code(center), static_cast<std::uint32_t>(i)};
  }
  sort_by_code(keys, scratch);

  std::size_t blocks = std::max<std::size_t>(1, (boxes.size() + width - 1) / width);
  ids_.resize(blocks * width);
  levels_.emplace_back(blocks);
  for (std::size_t place = 0; place < keys.size(); ++place) {
    const std::uint32_t id = keys[place].index;
    ids_[place] = id;
    places_[id] = static_cast<std::uint32_t>(place);
    levels_[0][place / width].put(place % width, boxes[id]);
  }
  while (blocks > 1) {
    const std::size_t below = blocks;
    blocks = (blocks + width - 1) / width;
    levels_.emplace_back(blocks);
    for (std::size_t block = 0; block < below; ++block) enclose(levels_.size() - 2, block);
  }
}

/// Writes a block's box to the block above.
void BoxQueries::enclose(std::size_t level, std::size_t block) {
  const BoxColumns& from = levels_[level][block];
  BoxColumns& above = levels_[level + 1][block / width];
  Aabb box;
  for (std::uint32_t left = from.present & ~from.always; left != 0; left &= left - 1) {
    box.extend(from.box(static_cast<std::size_t>(std::countr_zero(left))));
  }
  if (from.always != 0) box = Aabb{};  // not valid: always looked into
  above.put(block % width, box);
}

void BoxQueries::update(std::uint32_t id, const Aabb& box) {
  std::size_t place = places_[id];
  levels_[0][place / width].put(place % width, box);
  for (std::size_t level = 0; level + 1 < levels_.size(); ++level) {
    place /= width;
    enclose(level, place);
  }
}

void BoxQueries::test(const DepthRaster& raster, std::span<std::uint64_t> visible) {
  std::ranges::fill(visible, 0);
  const ColumnView view(raster.window(), raster.coverage());
  const PixelRays rays(raster.window(), raster.coverage());
  walk_.blocks = walk_.silhouettes = 0;
  find_visible(view, rays, raster.tiles(), levels_, ids_.data(), walk_, visible.data());
}

void BoxQueries::test(const DepthRaster& raster, std::span<const std::uint32_t> ids,
                      std::span<std::uint64_t> visible) const {
  const ColumnView view(raster.window(), raster.coverage());
  const PixelRays rays(raster.window(), raster.coverage());
  for (std::size_t first = 0; first < ids.size(); first += width) {
    const std::size_t count = std::min(width, ids.size() - first);
    BoxColumns block;
    for (std::size_t column = 0; column < count; ++column) {
      const std::uint32_t place = places_[ids[first + column]];
      const BoxColumns& from = levels_[0][place / width];
      const std::uint32_t always = (from.always >> (place % width)) & 1U;
      block.present |= 1U << column;
      block.always |= always << column;
      for (std::size_t row = 0; row < 6; ++row) {
        block.rows[row][column] = from.rows[row][place % width];
      }
    }
    const std::uint32_t open = visible_columns(view, rays, raster.tiles(), block);
    for (std::size_t column = 0; column < count; ++column) {
      const std::uint32_t id = ids[first + column];
      const std::uint64_t bit = std::uint64_t{1} << (id % 64);
      visible[id / 64] =
          ((open >> column) & 1U) != 0 ? visible[id / 64] | bit : visible[id / 64] & ~bit;
    }
  }
}

std::size_t BoxQueries::bytes() const {
  std::size_t sum =
      (ids_.capacity() + places_.capacity() + walk_.now.capacity() + walk_.next.capacity()) *
      sizeof(std::uint32_t);
  for (const auto& level : levels_) sum += level.capacity() * sizeof(BoxColumns);
  return sum;
}

}  // namespace vislab
