#include "algorithms/depth/occluders.h"

namespace vislab::depth_culling {

void OccluderMeshes::build(const Scene& scene) {
  scene_ = &scene;
  meshes_.clear();
  meshes_.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) meshes_.emplace_back(mesh);
}

std::size_t OccluderMeshes::bytes() const {
  std::size_t bytes = meshes_.capacity() * sizeof(RasterMesh);
  for (const RasterMesh& mesh : meshes_) bytes += mesh.bytes();
  return bytes;
}

std::vector<ParameterSpec> OccluderBudget::parameters() {
  constexpr auto stage = ParameterSpec::Stage::query;
  return {
      ParameterSpec::real("occluder_px", 4.0, 0.0, 1e9, "pixels", stage,
                          "visible objects whose box covers fewer pixels of the image are not "
                          "drawn into the buffer; greater is cheaper and hides less"),
      ParameterSpec::integer("occluder_triangles", 100'000, 0, 1'000'000'000, "triangles", stage,
                             "so many triangles at most are drawn into the buffer in a frame; "
                             "fewer hide less")};
}

OccluderBudget::OccluderBudget(const ParameterValues& values)
    : least_px_(values.real("occluder_px")),
      triangles_(static_cast<std::uint64_t>(values.integer("occluder_triangles"))) {}

}  // namespace vislab::depth_culling
