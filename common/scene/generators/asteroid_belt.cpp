// A belt of asteroids: spheres displaced by midpoint displacement.
//
// Idea: heights on a grid over longitude and latitude are refined by the diamond-square rule
// (Fournier, Fussell and Carpenter 1982; Martz, "Generating Random Fractal Terrain", 1996), the
// amplitude falling by half from step to step; longitudes are joined at their ends. Every vertex of
// a sphere moves along its radius. Guarantee: the surface is star-shaped about the centre, hence
// closed and free of self-intersection. Cost: O(detail^2) for each shape. Limits: triangles are
// thin at the poles, where the grid's circles shrink; heights fade to the mean there, lest the
// poles become pits or spikes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/scene/orientation.h"

namespace vislab {
namespace {

/// Heights in about -1 to 1 on `detail` longitudes by `detail` + 1 latitudes.
class HeightField {
 public:
  HeightField(std::uint32_t detail, std::uint64_t seed)
      : detail_(detail), heights_(static_cast<std::size_t>(detail) * (detail + 1)) {
    Random random(seed);
    // The first step is a quarter of the way round: coarser ones would be one lump.
    const std::uint32_t first = detail / 4;
    for (std::uint32_t j = 0; j <= detail; j += first) {
      for (std::uint32_t i = 0; i < detail; i += first) at(i, j) = random.uniform(-0.5, 0.5);
    }
    double amplitude = 0.25;
    for (std::uint32_t step = first; step > 1; step /= 2) {
      refine(step, amplitude, random);
      amplitude *= 0.5;
    }
  }

  double at(std::uint32_t longitude, std::uint32_t latitude) const {
    return heights_[static_cast<std::size_t>(latitude) * detail_ + longitude % detail_];
  }

 private:
  double& at(std::uint32_t longitude, std::uint32_t latitude) {
    return heights_[static_cast<std::size_t>(latitude) * detail_ + longitude % detail_];
  }

  void refine(std::uint32_t step, double amplitude, Random& random) {
    const std::uint32_t half = step / 2;
    for (std::uint32_t j = half; j < detail_; j += step) {
      for (std::uint32_t i = half; i < detail_; i += step) {
        const double mean = 0.25 * (at(i - half, j - half) + at(i + half, j - half) +
                                    at(i - half, j + half) + at(i + half, j + half));
        at(i, j) = mean + random.uniform(-amplitude, amplitude);
      }
    }
    for (std::uint32_t j = 0; j <= detail_; j += half) {
      for (std::uint32_t i = j % step == 0 ? half : 0; i < detail_; i += step) {
        double sum = at(i + half, j) + at(i + detail_ - half, j);
        double count = 2.0;
        if (j > 0) sum += at(i, j - half), count += 1.0;
        if (j < detail_) sum += at(i, j + half), count += 1.0;
        at(i, j) = sum / count + random.uniform(-amplitude, amplitude);
      }
    }
  }

  std::uint32_t detail_;
  std::vector<double> heights_;
};

}  // namespace

Mesh asteroid_mesh(std::uint32_t detail, double relief, std::uint64_t seed) {
  const HeightField heights(detail, seed);
  Mesh mesh;
  mesh.name = "asteroid";
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return j * (detail + 1) + i; };
  for (std::uint32_t j = 0; j <= detail; ++j) {
    const bool pole = j == 0 || j == detail;
    const double polar = std::numbers::pi * j / detail;
    const double flat = pole ? 0.0 : std::sin(polar);
    const double up = pole ? (j == 0 ? 1.0 : -1.0) : std::cos(polar);
    double mean = 0.0;
    for (std::uint32_t i = 0; i < detail; ++i) mean += heights.at(i, j) / detail;
    const double keep = std::min(1.0, 2.0 * flat);
    for (std::uint32_t i = 0; i <= detail; ++i) {
      const double height = mean + (heights.at(i, j) - mean) * keep;
      const double radius = 1.0 + relief * std::clamp(height, -1.0, 1.0);
      if (pole) {
        mesh.positions.emplace_back(0.0, radius * up, 0.0);
        continue;
      }
      const double longitude = 2.0 * std::numbers::pi * (i % detail) / detail;
      mesh.positions.emplace_back(radius * flat * std::cos(longitude), radius * up,
                                  -radius * flat * std::sin(longitude));
    }
  }
  for (std::uint32_t j = 0; j < detail; ++j) {
    for (std::uint32_t i = 0; i < detail; ++i) {
      const std::uint32_t north = vertex(i, j);
      const std::uint32_t south = vertex(i, j + 1);
      if (j + 1 < detail) mesh.triangles.emplace_back(north, south, south + 1);
      if (j > 0) mesh.triangles.emplace_back(north, south + 1, north + 1);
    }
  }
  return mesh;
}

Scene make_asteroid_belt(const AsteroidBeltParameters& parameters) {
  Scene scene;
  Random random(parameters.seed);
  for (std::uint32_t i = 0; i < parameters.shapes; ++i) {
    scene.meshes.push_back(asteroid_mesh(parameters.detail, parameters.relief, random.bits()));
  }
  for (std::uint32_t i = 0; i < parameters.count; ++i) {
    const auto mesh = static_cast<MeshId>(random.below(parameters.shapes));
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double distance = parameters.radius_m + random.uniform(-0.5, 0.5) * parameters.width_m;
    const double height = parameters.height_m + random.uniform(-0.5, 0.5) * parameters.thickness_m;
    const double size = random.uniform(parameters.min_size_m, parameters.max_size_m);
    const glm::dmat3 turn = random_rotation(random) * size;
    const glm::dvec3 center(distance * std::cos(angle), height, -distance * std::sin(angle));
    scene.objects.push_back({mesh, glm::dmat4x3(turn[0], turn[1], turn[2], center), none_id});
  }
  if (parameters.beacon_height_m > 0.0) {
    for (const double height : {parameters.beacon_height_m, -parameters.beacon_height_m}) {
      const auto mesh = static_cast<MeshId>(scene.meshes.size());
      scene.objects.push_back({mesh, box_transform({0.0, height, 0.0}, glm::dvec3(1.0)), none_id});
    }
    scene.meshes.push_back(cube_mesh());
  }
  return scene;
}

}  // namespace vislab
