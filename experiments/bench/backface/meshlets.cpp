#include "experiments/bench/backface/meshlets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "algorithms/backface/back_bits.h"

namespace vislab {
namespace {

constexpr std::size_t most_vertices = 64;
constexpr std::size_t most_triangles = 64;
constexpr float cone_weight = 1.0F;

/// The corners of a triangle, turned so that the least comes first.
std::array<std::uint32_t, 3> key_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::array<std::uint32_t, 3> key = {a, b, c};
  std::ranges::rotate(key, std::ranges::min_element(key));
  return key;
}

}  // namespace

Meshlets::Meshlets(const Mesh& mesh) {
  std::vector<std::uint32_t> indices;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> numbers;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& triangle = mesh.triangles[t];
    indices.insert(indices.end(), {triangle.x, triangle.y, triangle.z});
    numbers[key_of(triangle.x, triangle.y, triangle.z)] = t;
  }
  const std::size_t most =
      meshopt_buildMeshletsBound(indices.size(), most_vertices, most_triangles);
  std::vector<std::uint32_t> vertices(most * most_vertices);
  std::vector<unsigned char> corners(most * most_triangles * 3);
  meshlets_.resize(most);
  meshlets_.resize(meshopt_buildMeshlets(meshlets_.data(), vertices.data(), corners.data(),
                                         indices.data(), indices.size(), &mesh.positions[0].x,
                                         mesh.positions.size(), sizeof(mesh.positions[0]),
                                         most_vertices, most_triangles, cone_weight));
  for (const meshopt_Meshlet& meshlet : meshlets_) {
    bounds_.push_back(meshopt_computeMeshletBounds(
        &vertices[meshlet.vertex_offset], &corners[meshlet.triangle_offset], meshlet.triangle_count,
        &mesh.positions[0].x, mesh.positions.size(), sizeof(mesh.positions[0])));
    first_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    for (std::size_t t = 0; t < meshlet.triangle_count; ++t) {
      const auto vertex = [&](std::size_t corner) {
        return vertices[meshlet.vertex_offset + corners[meshlet.triangle_offset + 3 * t + corner]];
      };
      triangles_.push_back(numbers.at(key_of(vertex(0), vertex(1), vertex(2))));
    }
  }
  first_.push_back(static_cast<std::uint32_t>(triangles_.size()));
  kept_.resize(meshlets_.size());
  culled_.resize(meshlets_.size());
  for (const meshopt_Bounds& bounds : bounds_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows_.apex[axis].push_back(bounds.cone_apex[axis]);
      rows_.axis[axis].push_back(bounds.cone_axis[axis]);
    }
    rows_.cutoff.push_back(bounds.cone_cutoff);
  }
}

std::size_t Meshlets::test(const glm::dvec3& eye) {
  const glm::vec3 camera(eye);
  std::uint32_t* kept = kept_.data();
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    const meshopt_Bounds& bounds = bounds_[i];
    const float x = bounds.cone_apex[0] - camera.x;
    const float y = bounds.cone_apex[1] - camera.y;
    const float z = bounds.cone_apex[2] - camera.z;
    const float along = x * bounds.cone_axis[0] + y * bounds.cone_axis[1] + z * bounds.cone_axis[2];
    const bool culled = along >= bounds.cone_cutoff * std::sqrt(x * x + y * y + z * z);
    *kept = static_cast<std::uint32_t>(i);
    kept += culled ? 0 : 1;
  }
  return static_cast<std::size_t>(kept - kept_.data());
}

void Meshlets::test_rows(const glm::dvec3& eye) {
  const glm::vec3 camera(eye);
  find_culled(rows_, {camera.x, camera.y, camera.z}, culled_.data());
}

void Meshlets::mark_left_out(std::size_t kept_count, std::vector<std::uint64_t>& bits) const {
  std::vector<bool> is_kept(meshlets_.size(), false);
  for (std::size_t i = 0; i < kept_count; ++i) is_kept[kept_[i]] = true;
  for (std::size_t i = 0; i < meshlets_.size(); ++i) {
    if (is_kept[i]) continue;
    for (std::uint32_t at = first_[i]; at < first_[i + 1]; ++at) {
      bits[triangles_[at] / 64] |= std::uint64_t{1} << (triangles_[at] % 64);
    }
  }
}

}  // namespace vislab
