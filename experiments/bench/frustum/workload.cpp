#include "experiments/bench/frustum/workload.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "common/geometry/frustum.h"
#include "common/geometry/random.h"

namespace vislab {
namespace {

constexpr double reach_m = 500.0;
constexpr double near_m = 0.3;
constexpr double visible_share = 0.112;
constexpr std::size_t view_count = 16;

/// The cube from -1 to 1.
Mesh cube() {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back((corner & 1) != 0 ? 1.0F : -1.0F, (corner & 2) != 0 ? 1.0F : -1.0F,
                                (corner & 4) != 0 ? 1.0F : -1.0F);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

Scene random_boxes(std::size_t count) {
  Random random(1);
  const auto vector = [&](double low, double high) {
    const double x = random.uniform(low, high);
    const double y = random.uniform(low, high);
    return glm::dvec3(x, y, random.uniform(low, high));
  };
  Scene scene;
  scene.meshes = {cube()};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 center = vector(-reach_m, reach_m);
    const glm::dvec3 half = vector(0.2, 2.0);
    const glm::dmat4x3 transform({half.x, 0.0, 0.0}, {0.0, half.y, 0.0}, {0.0, 0.0, half.z},
                                 center);
    scene.objects.push_back({0, transform, none_id});
  }
  scene.finish();
  return scene;
}

/// All around, and up and down.
std::vector<Camera> views_to(double far_m) {
  std::vector<Camera> views;
  for (std::size_t i = 0; i < view_count; ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / view_count;
    const glm::dvec3 target(std::cos(turn), 0.5 * std::sin(3.0 * turn), std::sin(turn));
    views.push_back({look_at({0.0, 0.0, 0.0}, target),
                     perspective_lens(std::numbers::pi / 3.0, 16.0 / 9.0, near_m, far_m)});
  }
  return views;
}

bool is_outside(const Frustum& frustum, const Aabb& box) {
  return std::ranges::any_of(frustum.span(),
                             [&](const Plane& plane) { return surely_outside(plane, box); });
}

/// The share of a sample of the boxes that all views together see.
double share_of(std::span<const Aabb> boxes, double far_m) {
  std::size_t seen = 0;
  const std::size_t sample = std::min<std::size_t>(boxes.size(), 10000);
  for (const Camera& view : views_to(far_m)) {
    const Frustum frustum = frustum_of(view);
    for (const Aabb& box : boxes.first(sample)) seen += is_outside(frustum, box) ? 0 : 1;
  }
  return static_cast<double>(seen) / static_cast<double>(view_count * sample);
}

}  // namespace

FrustumWorkload::FrustumWorkload(std::size_t count) : scene_(random_boxes(count)), state_(scene_) {
  double low = near_m * 2.0;
  double high = 4.0 * reach_m;
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (low + high);
    (share_of(boxes(), middle) < visible_share ? low : high) = middle;
  }
  views_ = views_to(high);
  for (const Camera& view : views_) {
    const Frustum frustum = frustum_of(view);
    std::vector<std::uint64_t>& words = kept_.emplace_back((count + 63) / 64, 0);
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_outside(frustum, boxes()[i])) words[i / 64] |= std::uint64_t{1} << (i % 64);
    }
  }
}

Frame FrustumWorkload::frame(std::size_t view) const {
  return {view, views_[view], {1280, 720}, state_.view(), 0.0};
}

bool FrustumWorkload::is_right(std::size_t view, const std::vector<std::uint64_t>& answer,
                               double error_m) const {
  const Frustum frustum = frustum_of(views_[view]);
  if (answer.size() != kept_[view].size()) return false;
  for (std::size_t w = 0; w < answer.size(); ++w) {
    for (std::uint64_t left = answer[w] ^ kept_[view][w]; left != 0; left &= left - 1) {
      const std::size_t object = w * 64 + static_cast<std::size_t>(std::countr_zero(left));
      if (object >= boxes().size()) return false;
      const bool near = std::ranges::any_of(frustum.span(), [&](const Plane& plane) {
        return std::abs(plane.signed_distance(p_vertex(plane, boxes()[object]))) < error_m;
      });
      if (!near) return false;
    }
  }
  return true;
}

}  // namespace vislab
