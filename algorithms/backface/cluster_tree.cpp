// backface.cluster_tree: leaves out clusters of triangles that all face away, from a hierarchy.
//
// Idea: the test of backface.cluster, and its mirror image that tells when all triangles of a
//   cluster are seen from the front, on a tree with 16 children a node: a node that faces one way
//   as a whole is not looked into. n is the least of the children's, m the greatest; d is made anew
//   from the planes, since the children's are about other origins (the rule d = min(d1, d2) of the
//   slides holds for a common origin only).
//   Clusters that are seen from both sides are kept, or with mixed=test the planes of their
//   triangles are tested, in the clusters' order; what no cluster takes, for want of area, too.
// Guarantee: conservative, as backface.cluster; the answers are never fewer than those of its
//   clusters, and with mixed=test never fewer than those of backface.polygon.
// Cost: O(nodes that are seen from both sides), 16 children at a time, and O(marks of culled
//   triangles): runs of consecutive triangles for clusters, words of 64 where nodes hold several
//   triangles of each. Memory: about 64 bytes a cluster, 4 a run and 12 a word; mixed=test 20 bytes
//   a triangle more. Build: O(n log n).
// Limits: as backface.cluster. On rough surfaces clusters are scattered over the mesh, and marking
//   their triangles takes longer than testing them. A mesh whose triangles come in no order, as
//   those of scanned figures do, has clusters whose triangles are marked one by one, while sixteen
//   planes are tested in the time of two marks: there backface.polygon is faster than any clusters,
//   and mixed=test, which weighs the two for each mesh when it is built, tests all planes as it
//   does.
// Sources: Zachmann slide 26 (hierarchy, front-face test), 27-29 (cost model: how far down clusters
//   are divided); Johannsen and Carter 1998.

#include <algorithm>
#include <optional>

#include "algorithms/backface/cluster_parameters.h"
#include "algorithms/backface/cluster_tree_data.h"
#include "algorithms/backface/facing_culler.h"
#include "algorithms/backface/plane_kernel.h"
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
  info.parameters.push_back(ParameterSpec::choice(
      "mixed", "keep", {"keep", "test"}, ParameterSpec::Stage::build,
      "what to do with clusters of which some triangles are seen from behind: keep them whole, or "
      "test the plane of each triangle, which finds all that backface.polygon finds and takes 20 "
      "bytes a triangle. Meshes with triangles in so mixed an order that clusters save no time get "
      "planes only"));
  info.cost =
      "O(nodes seen from both sides), 16 children at a time, and O(runs of culled triangles); with "
      "mixed=test a plane test a triangle of clusters seen from both sides";
  info.limits =
      "Keeps clusters that are partly seen from behind, unless mixed=test: on coarse meshes, with "
      "large clusters and next to the mesh that is much. Where triangles come in no order, marking "
      "them takes longer than testing every plane. Keeps meshes that are open or cross themselves, "
      "and objects around the eye, whole. With costs=measured answers depend on the machine.";
  info.sources = {"Johannsen and Carter 1998, Clustered Backface Culling",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 20-29"};
  return info;
}

class ClusterTreeCuller : public FacingCuller {
 public:
  explicit ClusterTreeCuller(const ParameterValues& values)
      : FacingCuller(describe(), culls_open(values)),
        values_(values),
        mixed_(values.choice("mixed") == "test" ? MixedClusters::test : MixedClusters::keep) {}

  Counters counters() const override {
    return {{"node_tests", node_tests_}, {"triangles_tested", triangles_tested_}};
  }

 protected:
  void clear() override { meshes_.clear(); }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame,
                const BuildContext& context) override {
    meshes_.resize(id + 1);
    TestedMesh& tested = meshes_[id];
    const ClusterSettings settings = cluster_settings(values_, context);
    tested.tree.emplace(mesh, frame, settings, mixed_);
    if (mixed_ == MixedClusters::test &&
        tested.tree->is_slower_than_planes(frame, settings.eye_distance)) {
      tested.tree.reset();
      tested.planes.emplace(mesh, frame);
      return;
    }
    answer_.reserve(tested.tree->nodes().size());
    bits_.resize(std::max(bits_.size(), words_of(mesh.triangles.size())));
  }

  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) override {
    const TestedMesh& mesh = meshes_[view.mesh];
    const MeshFrame& frame = frame_of(view.mesh);
    if (mixed_ == MixedClusters::test) plane_test_ = plane_test(view.eye, frame);
    if (mesh.planes) return {};
    const ClusterTree& tree = *mesh.tree;
    const ClusterEye eye = cluster_eye(view.eye, frame, tree.reach());
    const auto bits = std::span(bits_).first(words_of(scene().meshes[view.mesh].triangles.size()));
    std::ranges::fill(bits, 0);
    if (mixed_ == MixedClusters::test) {
      find_back_and_mixed(tree.nodes(), eye, answer_);
      mixed_clusters_.clear();
      for (const std::uint32_t child : answer_.found_mixed()) {
        mixed_clusters_.push_back(tree.clusters_below(child).first);
      }
      triangles_tested_ += tree.mark_mixed(mixed_clusters_, plane_test_, bits.data());
    } else {
      find_back(tree.nodes(), eye, answer_);
    }
    for (const std::uint32_t child : answer_.found()) tree.mark(child, bits.data());
    node_tests_ += answer_.nodes_tested;
    return bits;
  }

  /// Asked of meshes that have planes and no tree.
  void mark_range(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                  std::uint64_t* back) override {
    triangles_tested_ += count;
    mark_behind(*meshes_[view.mesh].planes, plane_test_, first, count, back);
  }

  std::size_t mesh_bytes() const override {
    std::size_t bytes = meshes_.capacity() * sizeof(TestedMesh) + answer_.bytes() +
                        mixed_clusters_.capacity() * sizeof(std::uint32_t) +
                        bits_.capacity() * sizeof(std::uint64_t);
    for (const TestedMesh& mesh : meshes_) {
      bytes += mesh.tree ? mesh.tree->bytes() : 0;
      bytes += mesh.planes ? mesh.planes->bytes() : 0;
    }
    return bytes;
  }

 private:
  /// A tree, or planes only; neither where nothing is tested.
  struct TestedMesh {
    std::optional<ClusterTree> tree;
    std::optional<PlaneArrays> planes;
  };

  ParameterValues values_;
  MixedClusters mixed_;
  std::vector<TestedMesh> meshes_;  // by id
  PlaneTest plane_test_;            // of the object under test
  TreeAnswer answer_;
  std::vector<std::uint32_t> mixed_clusters_;
  std::vector<std::uint64_t> bits_;  // by triangle of one mesh
  std::uint64_t node_tests_ = 0;
  std::uint64_t triangles_tested_ = 0;
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
