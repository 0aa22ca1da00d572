// peer.meshopt_cones: back faces by the cones of meshoptimizer's meshlets.
//
// Idea: the mesh is divided into connected meshlets, of at most so many vertices and triangles,
// that
//   are compact and, by the cone weight, face alike. Each gets a cone of normals with an apex
//   behind its triangles, and goes if dot(normalize(apex - eye), axis) >= cutoff (orthographic: the
//   view direction instead of the way to the apex), as the library's header documents.
// Guarantee: approximate. The library works in float in the mesh's own frame and gives no error
//   bound: meshlets may go of which a triangle is seen edge-on, or from the front within rounding,
//   the more so the farther the mesh is from its frame's origin; so may triangles without area.
//   What is tested and what is kept whole is the same as for the lab's own methods (FacingCuller).
// Cost: one square root, one division and a few products a meshlet; runs of triangles for the
//   answer. 28 bytes a meshlet, and 4 a run.
// Limits: keeps meshlets on strongly curved or coarse surfaces and at the silhouette.
// Source: github.com/zeux/meshoptimizer 0.18, meshopt_buildMeshlets, meshopt_computeMeshletBounds
//   (called, not copied).

#include <cmath>
#include <optional>

#include "algorithms/backface/cluster_runs.h"
#include "algorithms/backface/facing_culler.h"
#include "algorithms/peers/meshopt_meshlets.h"
#include "common/culler/registry.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

using namespace backface_culling;
using peers::MeshoptMeshlets;

CullerInfo describe() {
  CullerInfo info;
  info.name = "peer.meshopt_cones";
  info.family = "peer";
  info.summary =
      "The meshlets of meshoptimizer (Debian's libmeshoptimizer-dev) with their cones of normals, "
      "tested as its header documents.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = {
      ParameterSpec::integer(
          "vertices", 64, 3, 255, "vertices", ParameterSpec::Stage::build,
          "most vertices in a meshlet; smaller meshlets find more back faces and "
          "take more tests"),
      ParameterSpec::integer("triangles", 64, 4, 512, "triangles", ParameterSpec::Stage::build,
                             "most triangles in a meshlet, a multiple of 4; smaller meshlets find "
                             "more back faces and take more tests"),
      ParameterSpec::real("weight", 1.0, 0.0, 1.0, "", ParameterSpec::Stage::build,
                          "how much meshlets are made to face alike rather than to be compact"),
      open_parameter()};
  info.cost =
      "O(meshlets of the offered objects): a square root and a division each; and the runs "
      "of triangles that are left out";
  info.limits =
      "Float without an error bound: triangles seen edge-on, without area, or from the front "
      "within "
      "rounding may be left out. Keeps meshlets on strongly curved or coarse surfaces, meshes that "
      "are open or cross themselves, and objects around the eye.";
  info.sources = {
      "meshoptimizer 0.18, meshopt_buildMeshlets and meshopt_computeMeshletBounds, "
      "https://github.com/zeux/meshoptimizer"};
  return info;
}

class MeshoptCones : public FacingCuller {
 public:
  explicit MeshoptCones(const ParameterValues& values)
      : FacingCuller(describe(), culls_open(values)),
        max_vertices_(static_cast<std::size_t>(values.integer("vertices"))),
        max_triangles_(static_cast<std::size_t>(values.integer("triangles"))),
        cone_weight_(static_cast<float>(values.real("weight"))) {
    if (max_triangles_ % 4 != 0) {
      throw InputError("peer.meshopt_cones: triangles = " + std::to_string(max_triangles_) +
                       " is not a multiple of 4, which meshoptimizer needs; " +
                       std::to_string(max_triangles_ / 4 * 4) + " would do");
    }
  }

  Counters counters() const override { return {{"clusters_tested", meshlets_tested_}}; }

 protected:
  void clear() override { meshes_.clear(); }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame&, const BuildContext&) override {
    meshes_.resize(id + 1);
    MeshoptMeshlets made =
        peers::meshopt_meshlets(mesh, max_vertices_, max_triangles_, cone_weight_);
    TriangleClusters clusters;
    clusters.order = std::move(made.triangles);
    clusters.first = std::move(made.first);
    meshes_[id].emplace(std::move(made.cones), ClusterRuns(clusters), mesh.triangles.size());
  }

  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) override {
    const TestedMesh& mesh = *meshes_[view.mesh];
    meshlets_tested_ += mesh.cones.size();
    back_.assign(words_of(mesh.triangle_count), 0);
    const glm::dvec4& place = view.eye.position;
    const bool perspective = place.w != 0.0;
    const glm::vec3 eye(perspective ? glm::dvec3(place) + frame_of(view.mesh).middle
                                    : glm::dvec3(place) / -glm::length(glm::dvec3(place)));
    for (std::uint32_t m = 0; m < mesh.cones.size(); ++m) {
      const MeshoptMeshlets::Cone& cone = mesh.cones[m];
      glm::vec3 way = eye;
      if (perspective) {
        way = glm::vec3(cone.apex[0], cone.apex[1], cone.apex[2]) - eye;
        way /= std::sqrt(glm::dot(way, way));
      }
      if (glm::dot(way, glm::vec3(cone.axis[0], cone.axis[1], cone.axis[2])) >= cone.cutoff) {
        mesh.runs.set(m, m + 1, back_);
      }
    }
    return back_;
  }

  std::size_t mesh_bytes() const override {
    std::size_t sum = meshes_.capacity() * sizeof(meshes_[0]);
    for (const std::optional<TestedMesh>& mesh : meshes_) {
      if (mesh) {
        sum += mesh->cones.capacity() * sizeof(MeshoptMeshlets::Cone) + mesh->runs.bytes();
      }
    }
    return sum;
  }

 private:
  struct TestedMesh {
    TestedMesh(std::vector<MeshoptMeshlets::Cone> made, ClusterRuns made_runs, std::size_t count)
        : cones(std::move(made)), runs(std::move(made_runs)), triangle_count(count) {}
    std::vector<MeshoptMeshlets::Cone> cones;
    ClusterRuns runs;
    std::size_t triangle_count;
  };

  std::size_t max_vertices_;
  std::size_t max_triangles_;
  float cone_weight_;
  std::vector<std::optional<TestedMesh>> meshes_;
  std::vector<std::uint64_t> back_;  // one bit a triangle
  std::uint64_t meshlets_tested_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry peer_meshopt_cones() {
  return {describe(),
          [](const ParameterValues& values) { return std::make_unique<MeshoptCones>(values); }};
}

}  // namespace cullers
}  // namespace vislab
