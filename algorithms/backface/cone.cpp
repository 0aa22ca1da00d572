// backface.cone: leaves out clusters of triangles that surely face away, by a cone of normals each.
//
// Idea: triangles whose planes lie near each other are made a cluster. If all normals of a cluster
//   lie in a cone around an axis, and an apex lies behind all its planes, every eye in the opposite
//   cone from the apex sees all of the cluster from behind: one dot product and one comparison tell
//   it for the whole cluster, without a root.
// Guarantee: conservative, as FacingCuller says: only what surely faces away goes. Triangles that
//   have no area, or nearly, are never left out.
// Cost: O(clusters of the objects offered) for the test; runs of triangles for the answer. 32 bytes
//   a cluster (form=sphere: 36), and 4 a run of consecutive triangles.
// Limits: keeps clusters whose normals spread, those near the silhouette, and those that the eye is
//   near to; with a sphere also those whose triangles lie far apart. On rough surfaces the
//   triangles of a cluster are scattered over the mesh: writing their bits then takes far longer
//   than the tests, and longer than testing every triangle in order. A triangle here and there of
//   kept clusters still faces away: backface.polygon after it finds those.
// Sources: Shirman and Abi-Ezzi 1993; Kowalka 2016, 2.2.2; with a sphere as meshoptimizer 0.18
//   documents beside meshopt_computeClusterBounds.

#include "algorithms/backface/cluster_cones.h"
#include "algorithms/backface/cluster_runs.h"
#include "algorithms/backface/facing_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.cone";
  info.family = "backface";
  info.summary =
      "Leaves out clusters of triangles that face away from the eye as a whole, by a cone around "
      "the normals of each.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = {
      ParameterSpec::choice(
          "form", "apex", {"apex", "sphere"}, ParameterSpec::Stage::build,
          "what the cone starts from: apex, a point behind all planes of the cluster; sphere, its "
          "bounding sphere, which finds less the farther the cluster's triangles lie apart"),
      ParameterSpec::integer(
          "size", 8, 1, 4096, "triangles", ParameterSpec::Stage::build,
          "triangles in a cluster; smaller ones find more back faces and take more tests. Small "
          "meshes get smaller ones, so that there are at least 256 while that is possible"),
      open_parameter()};
  info.cost =
      "O(clusters of the offered objects): nine multiplications each; and the runs of triangles "
      "that are left out";
  info.limits =
      "Keeps clusters whose normals spread or that lie near the silhouette, meshes that are open "
      "or "
      "cross themselves, and objects around the eye. With open=cull the backs that such meshes "
      "show "
      "disappear.";
  info.sources = {
      "Shirman and Abi-Ezzi 1993, The Cone of Normals Technique for Fast Processing of Curved "
      "Patches",
      "Kowalka 2016 (thesis, HAW Hamburg), 2.2.2",
      "meshoptimizer 0.18, meshopt_computeClusterBounds (the test with a bounding sphere)"};
  return info;
}

class Cone : public FacingCuller {
 public:
  Cone(ConeForm form, std::uint32_t size, bool cull_open)
      : FacingCuller(describe(), cull_open), form_(form), size_(size) {}

  Counters counters() const override { return {{"clusters_tested", clusters_tested_}}; }

 protected:
  void clear() override { meshes_.clear(); }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame, const BuildContext&) override {
    meshes_.resize(id + 1);
    const TriangleClusters clusters = make_clusters(mesh, frame, cone_clusters(size_));
    ClusterCones cones = cones_of(mesh, frame, clusters, form_);
    meshes_[id].emplace(std::move(cones), ClusterRuns(clusters), mesh.triangles.size());
  }

  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) override {
    const TestedMesh& mesh = *meshes_[view.mesh];
    clusters_tested_ += mesh.cones.count();
    words_.resize(std::max(words_.size(), words_of(mesh.cones.count())));
    mark_cones(mesh.cones, ConeEye(view.eye, mesh.cones.unit()), words_.data());
    back_.assign(words_of(mesh.triangle_count), 0);
    mesh.runs.set(std::span(words_).first(words_of(mesh.cones.count())), back_);
    return back_;
  }

  std::size_t mesh_bytes() const override {
    std::size_t sum = meshes_.capacity() * sizeof(meshes_[0]);
    for (const auto& mesh : meshes_) {
      if (mesh) sum += mesh->cones.bytes() + mesh->runs.bytes();
    }
    return sum;
  }

 private:
  struct TestedMesh {
    TestedMesh(ClusterCones made, ClusterRuns made_runs, std::size_t count)
        : cones(std::move(made)), runs(std::move(made_runs)), triangle_count(count) {}
    ClusterCones cones;
    ClusterRuns runs;
    std::size_t triangle_count;
  };

  ConeForm form_;
  std::uint32_t size_;
  std::vector<std::optional<TestedMesh>> meshes_;
  std::vector<std::uint64_t> words_;  // one bit a cluster
  std::vector<std::uint64_t> back_;   // one bit a triangle
  std::uint64_t clusters_tested_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry backface_cone() {
  return {describe(), [](const ParameterValues& values) {
            const bool apex = values.choice("form") == "apex";
            return std::make_unique<Cone>(apex ? ConeForm::apex : ConeForm::sphere,
                                          static_cast<std::uint32_t>(values.integer("size")),
                                          culls_open(values));
          }};
}

}  // namespace cullers
}  // namespace vislab
