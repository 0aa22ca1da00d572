#include "experiments/calibration/cluster_test_cost.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "algorithms/backface/cluster_kernel.h"
#include "algorithms/backface/triangle_clusters.h"
#include "common/scene/generators/generators.h"
#include "experiments/calibration/calibration.h"

namespace vislab {
namespace {

using namespace backface_culling;

constexpr std::uint32_t subdivisions = 32;
constexpr std::uint32_t cluster_triangles = 16;
constexpr std::size_t eyes = 64;

ClusterBound bound_of_run(const Mesh& mesh, const MeshFrame& frame, std::uint32_t first) {
  std::array<std::uint32_t, cluster_triangles> triangles{};
  std::iota(triangles.begin(), triangles.end(), first);
  std::vector<glm::dvec4> planes;
  for (const std::uint32_t triangle : triangles) {
    planes.push_back(unit_plane(mesh, frame, triangle));
  }
  return bound_of(planes, box_of(mesh, frame, triangles), frame, Origin::centre);
}

/// Every `cluster_triangles` triangles that follow each other, as the kernel takes them.
std::vector<ClusterBlock> blocks_of(const Mesh& mesh, const MeshFrame& frame) {
  const auto clusters = static_cast<std::uint32_t>(mesh.triangles.size()) / cluster_triangles;
  std::vector<ClusterBlock> blocks(clusters / ClusterBlock::width);
  for (std::uint32_t i = 0; i < blocks.size() * ClusterBlock::width; ++i) {
    blocks[i / ClusterBlock::width].set(i % ClusterBlock::width,
                                        bound_of_run(mesh, frame, i * cluster_triangles));
  }
  return blocks;
}

/// One behind the other around the sphere, three radii from its middle.
std::vector<ClusterEye> eyes_around(const MeshFrame& frame) {
  std::vector<ClusterEye> all;
  for (std::size_t i = 0; i < eyes; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / eyes;
    const Camera camera{look_at({3.0 * std::cos(angle), 0.7, 3.0 * std::sin(angle)}, {0, 0, 0}),
                        perspective_lens(1.0, 1.0, 0.1, 10.0)};
    const auto eye = eye_in_mesh(camera, glm::dmat4x3(1.0), frame);
    if (!eye) throw std::logic_error("cluster_test_cost: no eye");
    all.push_back(cluster_eye(*eye, frame, 1.0));
  }
  return all;
}

}  // namespace

Cost cluster_test_cost(int repeats) {
  BumpySphereParameters sphere;
  sphere.subdivisions = subdivisions;
  sphere.bumps = Bumps::low;
  sphere.hole = 0.001;  // an open mesh is not tested for being solid
  Scene scene = make_bumpy_sphere(sphere);
  scene.finish();
  const Mesh& mesh = scene.meshes.front();
  const MeshFrame frame(mesh);
  const std::vector<ClusterBlock> blocks = blocks_of(mesh, frame);
  const std::vector<ClusterEye> places = eyes_around(frame);
  std::vector<std::uint64_t> back((blocks.size() + 3) / 4);  // four blocks of 16 to a word
  std::uint64_t found = 0;
  const auto test = [&](std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      find_back(blocks, places[i], back);
      for (const std::uint64_t word : back) found |= word;
    }
  };
  const auto clusters = static_cast<double>(blocks.size() * ClusterBlock::width);
  const Cost cost = cost_of_more([&] { test(eyes); }, [&] { test(eyes / 4); },
                                 clusters * (eyes - eyes / 4), repeats);
  // What was found is used, so that nothing of the work can be left out.
  if (found == 0) throw std::logic_error("cluster_test_cost: a sphere without a back");
  return cost;
}

}  // namespace vislab
