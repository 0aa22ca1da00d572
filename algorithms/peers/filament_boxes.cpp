#include "algorithms/peers/filament_boxes.h"

#include <filament/Frustum.h>
#include <math/mat4.h>
#include <math/vec3.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace filament {

/// The library has this class but no header of it. What is called here is what its symbols say
/// (Debian's libfilament1.9 1.9.25): sets bit `bit` of results[i] if box i, given by centre and
/// half size, may be in the frustum; the count is a multiple of 8.
class Culler {
 public:
  static void intersects(std::uint8_t* results, const Frustum& frustum, const math::float3* centers,
                         const math::float3* half_sizes, std::size_t count, std::size_t bit);
};

}  // namespace filament

namespace vislab::peers {

namespace {

/// Filament takes boxes eight at a time.
std::size_t padded(std::size_t count) { return (count + 7) / 8 * 8; }

}  // namespace

struct FilamentBoxes::State {
  std::vector<filament::math::float3> centers;
  std::vector<filament::math::float3> half_sizes;
  std::vector<std::uint8_t> results;
  std::size_t count = 0;
  Aabb all;

  void set(ObjectId object, const Aabb& box) {
    const glm::vec3 center(box.center());
    const glm::vec3 half(box.half_size());
    centers[object] = {center.x, center.y, center.z};
    half_sizes[object] = {half.x, half.y, half.z};
    if (box.valid()) all.extend(box);
  }
};

FilamentBoxes::FilamentBoxes() : state_(std::make_unique<State>()) {}
FilamentBoxes::~FilamentBoxes() = default;

void FilamentBoxes::build(std::span<const Aabb> boxes) {
  state_->count = boxes.size();
  state_->centers.assign(padded(boxes.size()), {});
  state_->half_sizes.assign(padded(boxes.size()), {});
  state_->results.assign(padded(boxes.size()), 0);
  state_->all = {};
  for (ObjectId object = 0; object < boxes.size(); ++object) state_->set(object, boxes[object]);
}

void FilamentBoxes::move(ObjectId object, const Aabb& box) { state_->set(object, box); }

std::span<const std::uint8_t> FilamentBoxes::cull(const Camera& camera) {
  Camera bounded = camera;
  if (std::isinf(camera.lens.far_m)) {
    const glm::dvec3 reach = glm::max(glm::abs(glm::dvec3(state_->all.min) - camera.pose.eye),
                                      glm::abs(glm::dvec3(state_->all.max) - camera.pose.eye));
    const double far = state_->all.empty() ? 0.0 : 2.0 * glm::length(reach);
    bounded.lens.far_m = std::max(far, 2.0 * camera.lens.near_m);
  }
  const glm::mat4 clip(bounded.view_projection());
  filament::math::mat4f matrix;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      matrix[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)] = clip[column][row];
    }
  }
  const filament::Frustum frustum(matrix);
  // It only ever sets bits.
  std::memset(state_->results.data(), 0, state_->results.size());
  filament::Culler::intersects(state_->results.data(), frustum, state_->centers.data(),
                               state_->half_sizes.data(), state_->results.size(), 0);
  return std::span<const std::uint8_t>(state_->results).first(state_->count);
}

std::size_t FilamentBoxes::bytes() const {
  return (state_->centers.capacity() + state_->half_sizes.capacity()) *
             sizeof(filament::math::float3) +
         state_->results.capacity();
}

}  // namespace vislab::peers
