#include "experiments/bench/backface/meshlets.h"

#include <cmath>

namespace vislab {
namespace {

constexpr std::size_t most_vertices = 64;
constexpr std::size_t most_triangles = 64;
constexpr float cone_weight = 1.0F;

ConeRows rows_of(const std::vector<peers::MeshoptMeshlets::Cone>& cones) {
  const std::size_t length =
      (cones.size() + ConeRows::multiple - 1) / ConeRows::multiple * ConeRows::multiple;
  ConeRows rows;
  rows.cutoff.assign(length, 1.0F);  // what culls nothing fills the rows up
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rows.apex[axis].assign(length, 0.0F);
    rows.axis[axis].assign(length, 0.0F);
  }
  for (std::size_t i = 0; i < cones.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows.apex[axis][i] = cones[i].apex[axis];
      rows.axis[axis][i] = cones[i].axis[axis];
    }
    rows.cutoff[i] = cones[i].cutoff;
  }
  return rows;
}

}  // namespace

Meshlets::Meshlets(const Mesh& mesh, Form form)
    : form_(form),
      meshlets_(peers::meshopt_meshlets(mesh, most_vertices, most_triangles, cone_weight)) {
  if (form_ == Form::loop) {
    kept_.resize(meshlets_.cones.size());
  } else {
    rows_ = rows_of(meshlets_.cones);
    culled_bits_.resize(rows_.cutoff.size() / 8 + 8);
  }
}

void Meshlets::test(const glm::dvec3& eye) {
  const glm::vec3 camera(eye);
  if (form_ == Form::loop) {
    test_loop(camera);
  } else {
    find_culled(rows_, {camera.x, camera.y, camera.z}, culled_bits_.data());
  }
}

void Meshlets::test_loop(const glm::vec3& camera) {
  std::uint32_t* kept = kept_.data();
  for (std::size_t i = 0; i < meshlets_.cones.size(); ++i) {
    const peers::MeshoptMeshlets::Cone& cone = meshlets_.cones[i];
    const float x = cone.apex[0] - camera.x;
    const float y = cone.apex[1] - camera.y;
    const float z = cone.apex[2] - camera.z;
    const float along = x * cone.axis[0] + y * cone.axis[1] + z * cone.axis[2];
    const bool is_culled = along >= cone.cutoff * std::sqrt(x * x + y * y + z * z);
    *kept = static_cast<std::uint32_t>(i);
    kept += is_culled ? 0 : 1;
  }
  kept_count_ = static_cast<std::size_t>(kept - kept_.data());
}

std::vector<bool> Meshlets::culled() const {
  std::vector<bool> culled(meshlets_.cones.size(), form_ == Form::loop);
  if (form_ == Form::loop) {
    for (std::size_t i = 0; i < kept_count_; ++i) culled[kept_[i]] = false;
  } else {
    for (std::size_t i = 0; i < culled.size(); ++i) {
      culled[i] = (culled_bits_[i / 8] >> (i % 8) & 1) != 0;
    }
  }
  return culled;
}

void Meshlets::mark_left_out(std::vector<std::uint64_t>& bits) const {
  const std::vector<bool> is_culled = culled();
  for (std::size_t i = 0; i < is_culled.size(); ++i) {
    if (!is_culled[i]) continue;
    for (std::uint32_t at = meshlets_.first[i]; at < meshlets_.first[i + 1]; ++at) {
      const std::uint32_t triangle = meshlets_.triangles[at];
      bits[triangle / 64] |= std::uint64_t{1} << (triangle % 64);
    }
  }
}

}  // namespace vislab
