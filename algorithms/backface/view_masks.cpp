#include "algorithms/backface/view_masks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "algorithms/backface/magnitudes.h"

namespace vislab::backface_culling {
namespace {

constexpr std::size_t part_count = 16;
/// Of the hash table of rectangles, a power of two; half of it is used at most.
constexpr std::size_t entry_count = 4096;
constexpr std::size_t most_masks = entry_count / 2;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

std::size_t slot_of(const glm::dmat3& linear) {
  std::uint64_t hash = 0;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(linear[column][row])) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 32U;
    }
  }
  return hash % part_count;
}

}  // namespace

ViewMasks::ViewMasks(DirectionCube cube, int sectors)
    : cube_(std::move(cube)), sectors_(sectors), parts_(part_count), entries_(entry_count) {
  masks_.reserve(most_masks);
}

void ViewMasks::start(const Camera& camera, std::uint64_t frame_index) {
  if (started_ && camera == camera_ && frame_index == frame_index_) return;
  started_ = true;
  camera_ = camera;
  frame_index_ = frame_index;
  for (Part& part : parts_) part.used = false;
  part_ = nullptr;
  if (!orthographic()) lines_ = SectorLines(camera.lens, sectors_);
}

void ViewMasks::select(const glm::dmat3& linear) {
  if (part_ != nullptr && part_->linear == linear) return;
  forget_rectangles();
  part_ = &parts_[slot_of(linear)];
  if (part_->used && part_->linear == linear) return;
  part_->used = true;
  part_->linear = linear;
  part_->inverse = glm::inverse(linear);
  // With |linear * inverse - 1| < 1/2 the true inverse is at most twice the computed one.
  const bool regular = row_sum(linear * part_->inverse - glm::dmat3(1.0)) < 0.5;
  part_->inverse_size = regular ? row_sum(part_->inverse) : std::numeric_limits<double>::infinity();
  const auto lines = static_cast<std::size_t>(lines_.count());
  part_->corner.assign(lines * lines, 0);
  part_->masks.clear();
}

void ViewMasks::forget_rectangles() {
  masks_.assign(1, BackMask{});
  if (++round_ == 0) {
    std::ranges::fill(entries_, Entry{});
    round_ = 1;
  }
}

void ViewMasks::make_room(std::size_t count) {
  if (masks_.size() + count > most_masks) forget_rectangles();
}

std::uint16_t ViewMasks::number_of(const Rectangle& rectangle) {
  if (!rectangle.known()) return 0;
  for (std::size_t at = (rectangle.key() * 0x9E3779B1U) >> 20U;; ++at) {
    Entry& entry = entries_[at % entry_count];
    if (entry.round != round_) {
      entry = {rectangle, static_cast<std::uint16_t>(masks_.size()), round_};
      BackMask common = corner_mask(rectangle.left, rectangle.bottom);
      common = common & corner_mask(rectangle.right, rectangle.bottom);
      common = common & corner_mask(rectangle.left, rectangle.top);
      common = common & corner_mask(rectangle.right, rectangle.top);
      masks_.push_back(common);
    } else if (entry.rectangle != rectangle) {
      continue;
    }
    return entry.number;
  }
}

const BackMask& ViewMasks::orthographic_mask() {
  if (part_->masks.empty()) part_->masks.push_back(test(-camera_.pose.back));
  return part_->masks.front();
}

const BackMask& ViewMasks::corner_mask(int x, int y) {
  std::uint16_t& index = part_->corner[static_cast<std::size_t>(y * lines_.count() + x)];
  if (index == 0) {
    const Pose& pose = camera_.pose;
    part_->masks.push_back(test(lines_.x(x) * pose.right + lines_.y(y) * pose.up - pose.back));
    index = static_cast<std::uint16_t>(part_->masks.size());
  }
  return part_->masks[index - 1U];
}

BackMask ViewMasks::test(const glm::dvec3& direction) {
  ++directions_tested_;
  const glm::dmat3& linear = part_->linear;
  const glm::dvec3 local = part_->inverse * direction;
  // What is left over when the direction is taken back to the world bounds how far off it is. The
  // direction's own rounding and that of the camera's axes count in it, by the length of what was
  // added up, which is at most 3 times the greatest part of x right + y up - back and more than 1.
  const glm::dmat3 sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
  const glm::dvec3 rest = glm::abs(linear * local - direction) +
                          8.0 * epsilon * (sizes * glm::abs(local)) +
                          glm::dvec3(64.0 * epsilon * (1.0 + glm::length(direction)));
  const double off = 2.0 * part_->inverse_size * largest(rest);
  const double size = largest(local);
  MeshDirection scaled;
  scaled.direction = glm::vec3(local / size);
  scaled.error = static_cast<float>(std::min(off / size * (1.0 + 0x1p-20) + 0x1p-24, 2.0));
  return cube_.facing_away(scaled);
}

}  // namespace vislab::backface_culling
