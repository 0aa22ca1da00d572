#include "algorithms/backface/view_masks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace vislab::backface_culling {
namespace {

constexpr std::size_t part_count = 16;
constexpr int lines_beyond = 5;  // on either side: 31 times a sector's width
constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Lines between `low` and `high`, and those beyond. Their float values are the lines: rounding
/// moves them, and nothing else.
void make_lines(double low, double high, int sectors, std::vector<float>& lines) {
  lines.clear();
  const double width = (high - low) / sectors;
  const auto add = [&](double at) {
    lines.push_back(static_cast<float>(std::clamp(at, -1e30, 1e30)));
  };
  for (int i = lines_beyond; i > 0; --i) add(low - width * ((1 << i) - 1));
  for (int i = 0; i < sectors; ++i) add(low + width * i);
  add(high);
  for (int i = 1; i <= lines_beyond; ++i) add(high + width * ((1 << i) - 1));
}

double greatest_row_sum(const glm::dmat3& m) {
  const glm::dvec3 sums = glm::abs(m[0]) + glm::abs(m[1]) + glm::abs(m[2]);
  return std::max({sums.x, sums.y, sums.z});
}

double greatest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

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
    : cube_(std::move(cube)), sectors_(sectors), parts_(part_count) {}

void ViewMasks::start(const Camera& camera, std::uint64_t frame_index) {
  if (started_ && camera == camera_ && frame_index == frame_index_) return;
  started_ = true;
  camera_ = camera;
  frame_index_ = frame_index;
  for (Part& part : parts_) part.used = false;
  part_ = nullptr;
  lines_.x.clear();
  lines_.y.clear();
  const Lens& lens = camera.lens;
  if (lens.projection == Projection::perspective) {
    make_lines(lens.left / lens.near_m, lens.right / lens.near_m, sectors_, lines_.x);
    make_lines(lens.bottom / lens.near_m, lens.top / lens.near_m, sectors_, lines_.y);
  }
}

void ViewMasks::select(const glm::dmat3& linear) {
  if (part_ != nullptr && part_->linear == linear) return;
  last_ = {};
  part_ = &parts_[slot_of(linear)];
  if (part_->used && part_->linear == linear) return;
  part_->used = true;
  part_->linear = linear;
  part_->inverse = glm::inverse(linear);
  // With |linear * inverse - 1| < 1/2 the true inverse is at most twice the computed one.
  const bool regular = greatest_row_sum(linear * part_->inverse - glm::dmat3(1.0)) < 0.5;
  part_->inverse_size =
      regular ? greatest_row_sum(part_->inverse) : std::numeric_limits<double>::infinity();
  part_->corner.assign(std::max<std::size_t>(1, lines_.x.size() * lines_.y.size()), 0);
  part_->masks.clear();
}

const BackMask& ViewMasks::mask(const Rectangle& rectangle) {
  if (last_.known() && last_ == rectangle) return mask_;
  mask_ = corner_mask(rectangle.left, rectangle.bottom);
  mask_ = mask_ & corner_mask(rectangle.right, rectangle.bottom);
  mask_ = mask_ & corner_mask(rectangle.left, rectangle.top);
  mask_ = mask_ & corner_mask(rectangle.right, rectangle.top);
  last_ = rectangle;
  return mask_;
}

const BackMask& ViewMasks::orthographic_mask() {
  if (part_->masks.empty()) part_->masks.push_back(test(-camera_.pose.back));
  return part_->masks.front();
}

const BackMask& ViewMasks::corner_mask(std::size_t x, std::size_t y) {
  std::uint16_t& index = part_->corner[y * lines_.x.size() + x];
  if (index == 0) {
    const Pose& pose = camera_.pose;
    part_->masks.push_back(test(static_cast<double>(lines_.x[x]) * pose.right +
                                static_cast<double>(lines_.y[y]) * pose.up - pose.back));
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
  const double off = 2.0 * part_->inverse_size * greatest(rest);
  const double size = greatest(local);
  MeshDirection scaled;
  scaled.direction = glm::vec3(local / size);
  scaled.error = static_cast<float>(std::min(off / size * (1.0 + 0x1p-20) + 0x1p-24, 2.0));
  return cube_.facing_away(scaled);
}

}  // namespace vislab::backface_culling
