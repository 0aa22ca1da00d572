// backface.cluster_tree: leaves out clusters of triangles that all face away, from a hierarchy.
//
// Idea: the test of backface.cluster, and its mirror image that tells when all triangles of a
//   cluster are seen from the front, on a tree with 16 children a node: a node that faces one way
//   as a whole is not looked into. n is the least of the children's, m the greatest; d is made anew
//   from the planes, since the children's are about other origins (the rule d = min(d1, d2) of the
//   slides holds for a common origin only).
// Guarantee: conservative, as backface.cluster; the answers are never fewer than those of its
//   clusters.
// Cost: O(nodes that are seen from both sides), 16 children at a time, and O(marks of culled
//   triangles): runs of consecutive triangles for clusters, words of 64 where nodes hold several
//   triangles of each. Memory: about 64 bytes a cluster, 4 a run and 12 a word. Build: O(n log n).
// Limits: as backface.cluster. On rough surfaces clusters are scattered over the mesh, and marking
//   their triangles takes longer than testing them.
// Sources: Zachmann slide 26 (hierarchy, front-face test), 27-29 (cost model: how far down clusters
//   are divided); Johannsen and Carter 1998.

#include <algorithm>
#include <optional>

#include "algorithms/backface/cluster_parameters.h"
#include "algorithms/backface/cluster_tree_data.h"
#include "algorithms/backface/facing_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.cluster_tree";
  info.family = "backface";
  info.summary =
      "Leaves out clusters of triangles that all face away from the eye, found in a hierarchy of "
      "clusters that is entered only where both sides are seen.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.parameters = cluster_parameters(tree_cluster_size);
  info.cost =
      "O(nodes seen from both sides), 16 children at a time, and O(runs of culled triangles)";
  info.limits =
      "Keeps clusters that are partly seen from behind: on coarse meshes, with large clusters and "
      "next to the mesh that is much. Keeps meshes that are open or cross themselves, and objects "
      "around the eye, whole.";
  info.sources = {"Johannsen and Carter 1998, Clustered Backface Culling",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 20-29"};
  return info;
}

class ClusterTreeCuller : public FacingCuller {
 public:
  explicit ClusterTreeCuller(const ParameterValues& values)
      : FacingCuller(describe(), culls_open(values)), values_(values) {}

  Counters counters() const override { return {{"node_tests", node_tests_}}; }

 protected:
  void clear() override { meshes_.clear(); }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame,
                const BuildContext& context) override {
    meshes_.resize(id + 1);
    meshes_[id].emplace(mesh, frame, cluster_settings(values_, context));
    answer_.reserve(meshes_[id]->nodes().size());
    bits_.resize(std::max(bits_.size(), words_of(mesh.triangles.size())));
  }

  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) override {
    const ClusterTree& tree = *meshes_[view.mesh];
    find_back(tree.nodes(), cluster_eye(view.eye, frame_of(view.mesh), tree.reach()), answer_);
    node_tests_ += answer_.nodes_tested;
    const auto bits = std::span(bits_).first(words_of(scene().meshes[view.mesh].triangles.size()));
    std::ranges::fill(bits, 0);
    for (const std::uint32_t child : answer_.found()) tree.mark(child, bits.data());
    return bits;
  }

  std::size_t mesh_bytes() const override {
    std::size_t bytes = meshes_.capacity() * sizeof(meshes_[0]);
    for (const std::optional<ClusterTree>& tree : meshes_) bytes += tree ? tree->bytes() : 0;
    return bytes;
  }

 private:
  ParameterValues values_;
  std::vector<std::optional<ClusterTree>> meshes_;  // by id; none where nothing is tested
  TreeAnswer answer_;
  std::vector<std::uint64_t> bits_;  // by triangle of one mesh
  std::uint64_t node_tests_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry backface_cluster_tree() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<ClusterTreeCuller>(values);
          }};
}

}  // namespace cullers
}  // namespace vislab
