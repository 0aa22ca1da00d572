// Things behind screens: how much is hidden is a dial, and so is how well boxes fit what is hidden.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"
#include "common/scene/orientation.h"

namespace vislab {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;
constexpr double screen_m = 8.0;     // of a screen that hides from the origin
constexpr double backdrop_m = 80.0;  // of one that does not
constexpr double nearest_m = 10.0, farthest_m = 60.0;

/// A screen across a direction about the vertical, as wide as its sector but for a slit.
glm::dmat4x3 screen_at(double distance, double heading, double half_angle) {
  constexpr double slope_up = 0.53;  // 28 degrees
  const glm::dvec3 half(0.005 * distance, slope_up * distance, std::tan(half_angle) * distance);
  const glm::dmat3 turn = rotation({0.0, 1.0, 0.0}, heading);
  return {turn[0] * half.x, turn[1] * half.y, turn[2] * half.z, turn[0] * distance};
}

/// A cube in a direction, so large that it fills four tenths of a cell of this width, corners and
/// all.
glm::dmat4x3 object_at(double distance, double heading, double elevation, double cell_rad) {
  const glm::dvec3 direction(std::cos(elevation) * std::cos(heading), std::sin(elevation),
                             -std::cos(elevation) * std::sin(heading));
  return box_transform(direction * distance,
                       glm::dvec3(0.4 * cell_rad * distance / (2.0 * std::numbers::sqrt3)));
}

}  // namespace

Scene make_screened_ring(const ScreenedRingParameters& parameters) {
  constexpr double highest_rad = 20.0 / 360.0 * tau;
  Scene scene;
  const std::uint32_t share = parameters.all_triangles / (parameters.sectors * parameters.objects);
  scene.meshes = {cube_mesh(), dense_cube_mesh(std::max(parameters.min_triangles, share))};
  const double sector = tau / parameters.sectors;
  const double width = 0.6 * sector;  // of what is behind, seen from the origin
  const auto rows = static_cast<std::uint32_t>(
      std::max(1.0, std::round(std::sqrt(parameters.objects * 2.0 * highest_rad / width))));
  const std::uint32_t columns = (parameters.objects + rows - 1) / rows;
  const double cell = std::min(width / columns, 2.0 * highest_rad / rows);
  for (std::uint32_t k = 0; k < parameters.sectors; ++k) {
    constexpr double rounding = 1e-9;
    const bool hides = std::floor((k + 1) * parameters.hidden + rounding) >
                       std::floor(k * parameters.hidden + rounding);
    scene.objects.push_back(
        {0, screen_at(hides ? screen_m : backdrop_m, k * sector, 0.49 * sector), none_id});
  }
  Random random(parameters.seed);
  for (std::uint32_t k = 0; k < parameters.sectors; ++k) {
    for (std::uint32_t i = 0; i < parameters.objects; ++i) {
      const double aside = ((i % columns + 0.5) / columns - 0.5) * width;
      const double up = ((i / columns + 0.5) / rows - 0.5) * 2.0 * highest_rad;
      const double distance = random.uniform(nearest_m, farthest_m);
      scene.objects.push_back({1, object_at(distance, k * sector + aside, up, cell), none_id});
    }
  }
  return scene;
}

Scene make_covered_bars(const CoveredBarsParameters& parameters) {
  constexpr double pitch_m = 9.0;
  constexpr double cover_z_m = 1.0;  // before the bars, which lie in the plane z = 0
  constexpr double margin_m = 0.15;  // of a cover about its bar
  constexpr glm::dvec3 half_bar(4.0, 0.2, 0.2);
  constexpr glm::dvec3 half_cover(half_bar.x + margin_m, half_bar.y + margin_m, 0.05);
  Scene scene;
  // The bar's mesh has its true proportions, for those who cut meshes into parts.
  Mesh bar = dense_cube_mesh(parameters.min_triangles);
  for (glm::vec3& p : bar.positions) p *= glm::vec3(half_bar);
  scene.meshes = {cube_mesh(), std::move(bar)};
  const glm::dmat3 turn = rotation({0.0, 0.0, 1.0}, parameters.angle_deg / 360.0 * tau);
  const auto place = [&](const glm::dvec3& half, const glm::dvec3& at) {
    return glm::dmat4x3(turn[0] * half.x, turn[1] * half.y, turn[2] * half.z, at);
  };
  const auto center = [&](std::uint32_t i) {
    return glm::dvec3((i % parameters.columns + 0.5 - 0.5 * parameters.columns) * pitch_m,
                      (i / parameters.columns + 0.5 - 0.5 * parameters.rows) * pitch_m, 0.0);
  };
  const std::uint32_t count = parameters.columns * parameters.rows;
  for (std::uint32_t i = 0; i < count; ++i) {
    // On the line from the eye to the bar's middle.
    const double share = cover_z_m / covered_bars_eye_m;
    const glm::dvec3 at = center(i) * (1.0 - share) + glm::dvec3(0.0, 0.0, cover_z_m);
    scene.objects.push_back({0, place(half_cover, at), none_id});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    scene.objects.push_back({1, place(glm::dvec3(1.0), center(i)), none_id});
  }
  return scene;
}

}  // namespace vislab
