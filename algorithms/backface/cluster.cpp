// backface.cluster: leaves out clusters of triangles that all face away, one test a cluster.
//
// Idea: a cluster keeps the least and greatest coordinates n, m of its normals and the least d of
//   n_i.(p_i - c). The eye sees all its triangles from behind if if(e - c; n, m).(e - c) <= d:
//   about the work of one plane test for all of them. Clusters are made of triangles whose planes
//   lie near each other (triangle_clusters.h); they need not be connected.
// Guarantee: conservative. Only solid meshes are tested (see backface.polygon); bounds are rounded
//   outward, and the float test has a margin above its rounding. A triangle seen exactly edge-on is
//   kept, and so are triangles without area.
// Cost: O(clusters), 16 at a time, and O(marked runs of triangles). Memory: 40 bytes a cluster and
//   4 a run of triangles. Build: O(n log n).
// Limits: keeps clusters that are partly seen from behind, so its share falls with coarse meshes
//   and large clusters; next to the mesh, where the eye sees a cluster from many sides at once.
// Sources: Johannsen and Carter, "Clustered Backface Culling", 1998 (28 bytes, 40 with c); Zachmann
//   slides 20-25. The slides take the middle and the corners of the box for c and keep what makes d
//   greatest; with clusters as they are made here all three choices of `origin` cull the same to a
//   tenth of a percent while the mesh lies about its own origin.

#include <algorithm>
#include <optional>

#include "algorithms/backface/cluster_parameters.h"
#include "algorithms/backface/facing_culler.h"
#include "algorithms/backface/flat_clusters.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.cluster";
  info.family = "backface";
  info.summary =
      "Leaves out clusters of triangles that all face away from the eye, by one test a cluster "
      "with "
      "the least and greatest coordinates of its normals.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.parameters = cluster_parameters(flat_cluster_size);
  info.cost = "O(clusters of shown objects) tests, 16 at a time, and O(runs of culled triangles)";
  info.limits =
      "Keeps clusters that are partly seen from behind: on coarse meshes, with large clusters and "
      "next to the mesh that is much. Keeps meshes that are open or cross themselves, and objects "
      "around the eye, whole.";
  info.sources = {"Johannsen and Carter 1998, Clustered Backface Culling",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 20-25, 27-29"};
  return info;
}

class Cluster : public FacingCuller {
 public:
  explicit Cluster(const ParameterValues& values)
      : FacingCuller(describe(), culls_open(values)), values_(values) {}

  Counters counters() const override { return {{"cluster_tests", cluster_tests_}}; }

 protected:
  void clear() override { meshes_.clear(); }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame,
                const BuildContext& context) override {
    meshes_.resize(id + 1);
    meshes_[id].emplace(mesh, frame, cluster_settings(values_, context));
    back_.resize(std::max(back_.size(), words_of(meshes_[id]->cluster_count())));
    bits_.resize(std::max(bits_.size(), words_of(mesh.triangles.size())));
  }

  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) override {
    const FlatClusters& clusters = *meshes_[view.mesh];
    cluster_tests_ += clusters.cluster_count();
    const auto back = std::span(back_).first(words_of(clusters.cluster_count()));
    find_back(clusters.blocks(), cluster_eye(view.eye, frame_of(view.mesh), clusters.reach()),
              back);
    const auto bits = std::span(bits_).first(words_of(clusters.triangle_count()));
    std::ranges::fill(bits, 0);
    clusters.mark(back, bits.data());
    return bits;
  }

  std::size_t mesh_bytes() const override {
    std::size_t bytes = meshes_.capacity() * sizeof(meshes_[0]);
    for (const std::optional<FlatClusters>& clusters : meshes_) {
      bytes += clusters ? clusters->bytes() : 0;
    }
    return bytes;
  }

 private:
  ParameterValues values_;
  std::vector<std::optional<FlatClusters>> meshes_;  // by id; none where nothing is tested
  std::vector<std::uint64_t> back_;                  // by cluster of one mesh
  std::vector<std::uint64_t> bits_;                  // by triangle of one mesh
  std::uint64_t cluster_tests_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry backface_cluster() {
  return {describe(),
          [](const ParameterValues& values) { return std::make_unique<Cluster>(values); }};
}

}  // namespace cullers
}  // namespace vislab
