#include "algorithms/depth/draw_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "common/geometry/random.h"

namespace vislab::depth_culling {
namespace {

/// Shorter lists are sorted by insertion.
constexpr std::size_t short_list = 48;

/// Ascends as the float does.
std::uint32_t sortable(float key) {
  const auto bits = std::bit_cast<std::uint32_t>(key);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

}  // namespace

ParameterSpec draw_order_parameter() {
  return ParameterSpec::choice(
      "order", "near_first", {"near_first", "random", "far_first"}, ParameterSpec::Stage::query,
      "in which order candidates are looked at and drawn; what is not near first hides less");
}

DrawOrder read_draw_order(const ParameterValues& values) {
  const std::string& order = values.choice("order");
  return order == "random"      ? DrawOrder::random
         : order == "far_first" ? DrawOrder::far_first
                                : DrawOrder::near_first;
}

float DrawKeys::of(const Aabb& box, std::uint32_t salt) const {
  if (!box.valid()) return -std::numeric_limits<float>::infinity();
  if (order_ == DrawOrder::random) {
    return static_cast<float>(Random(seed_ + salt * Random::increment).bits() >> 40U);
  }
  if (camera_.lens.projection == Projection::orthographic) {
    const glm::dvec3 reach = glm::abs(camera_.pose.back) * box.half_size();
    const double depth = camera_.planar_depth(box.center());
    const double extent = reach.x + reach.y + reach.z;
    return static_cast<float>(order_ == DrawOrder::near_first ? depth - extent : -(depth + extent));
  }
  if (order_ == DrawOrder::near_first) {
    return static_cast<float>(distance_squared(box, camera_.pose.eye));
  }
  const glm::dvec3 farthest = glm::abs(camera_.pose.eye - box.center()) + box.half_size();
  return static_cast<float>(-glm::dot(farthest, farthest));
}

void ObjectOrder::sort() {
  if (places_.size() <= short_list) {
    for (std::size_t i = 1; i < places_.size(); ++i) {
      const Place place = places_[i];
      std::size_t at = i;
      for (; at > 0 && place.key < places_[at - 1].key; --at) places_[at] = places_[at - 1];
      places_[at] = place;
    }
    return;
  }
  constexpr int digit_bits = 11;
  constexpr std::uint32_t digits = 1U << digit_bits;
  scratch_.resize(places_.size());
  for (int shift = 0; shift < 32; shift += digit_bits) {
    std::array<std::uint32_t, digits> starts{};
    const auto digit = [&](const Place& place) {
      return (sortable(place.key) >> static_cast<unsigned>(shift)) & (digits - 1);
    };
    for (const Place& place : places_) ++starts[digit(place)];
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts) {
      const std::uint32_t count = start;
      start = sum;
      sum += count;
    }
    for (const Place& place : places_) scratch_[starts[digit(place)]++] = place;
    std::swap(places_, scratch_);
  }
}

}  // namespace vislab::depth_culling
