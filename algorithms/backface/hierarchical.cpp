// backface.hierarchical: leaves out clusters of triangles that surely face away, by a hierarchy of
// cones of normals and by what was found in the frames before.
//
// Idea: a node of a binary tree of clusters is seen from behind (all of it goes), from the front
//   (all of it stays), or neither can be said (its children are asked). From one frame to the next
//   few verdicts change. The source keeps the cut through the tree at which the last walk ended,
//   and walks up and down from there. Here every verdict carries the way that the eye may go, in
//   the mesh's frame, before it can change, and every node the shortest such way at and below it: a
//   walk enters only those subtrees in which a verdict has run out, and writes only the bits that
//   change.
// Guarantee: conservative, as FacingCuller says. The answer is the same with and without coherence,
//   whatever was seen before: a verdict is used again only while testing again would give it again.
//   Triangles that have no area, or nearly, are never left out.
// Cost: O(nodes whose verdicts run out + runs of triangles that change) for each object, at most
//   O(clusters); nothing but the answer's ranges if the eye and the object stand still. Memory:
//   some 120 bytes a node and 4 a run of triangles for a mesh; for each object 24 bytes a node and
//   one bit a triangle.
// Limits: clusters that are neither seen from behind nor from the front are kept whole: chain
//   backface.polygon after it. Fast turns about the object, and cuts, make every verdict run out.
//   Objects that move by themselves move the eye in their frame.
// Source: Kumar, Manocha, Garrett and Lin 1996, Hierarchical Back-Face Culling; Kowalka
// 2016, 2.2.2.

#include "algorithms/backface/cluster_cones.h"
#include "algorithms/backface/facing_culler.h"
#include "algorithms/backface/tree_memory.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.hierarchical";
  info.family = "backface";
  info.summary =
      "Leaves out what faces away by a hierarchy of cones of normals; a verdict about a node is "
      "kept "
      "until the eye has moved so far that it may change.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = {
      ParameterSpec::choice(
          "coherence", "on", {"on", "off"}, ParameterSpec::Stage::query,
          "on: verdicts of earlier frames are used as long as they surely hold; off: every frame "
          "walks from the root, with the same answers"),
      ParameterSpec::integer(
          "size", 32, 1, 4096, "triangles", ParameterSpec::Stage::build,
          "triangles in a cluster, a leaf of the hierarchy; smaller ones find more back faces and "
          "take more tests and memory. Small meshes get smaller ones, so that there are at "
          "least 256 while that is possible"),
      open_parameter()};
  info.cost =
      "O(nodes whose verdicts run out + runs of triangles that change) an object; without "
      "coherence "
      "O(nodes down to the verdicts)";
  info.limits =
      "Keeps clusters whose normals spread or that lie near the silhouette, meshes that are open "
      "or "
      "cross themselves, and objects around the eye. Cuts and fast turns make all verdicts run "
      "out. With open=cull the backs that open meshes show disappear.";
  info.sources = {"Kumar, Manocha, Garrett and Lin 1996, Hierarchical Back-Face Culling",
                  "Kowalka 2016 (thesis, HAW Hamburg), 2.2.2"};
  return info;
}

class Hierarchical : public FacingCuller {
 public:
  Hierarchical(bool coherent, std::uint32_t size, bool cull_open)
      : FacingCuller(describe(), cull_open), coherent_(coherent), size_(size) {}

  void reset(std::uint64_t) override {
    for (std::optional<TreeMemory>& memory : memories_) {
      if (memory) memory->forget();
    }
  }

  Counters counters() const override {
    return {{"nodes_tested", counts_.tested}, {"nodes_reused", counts_.reused}};
  }

 protected:
  void clear() override {
    trees_.clear();
    memories_.clear();
    back_.clear();
  }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame, const BuildContext&) override {
    trees_.resize(id + 1);
    trees_[id].emplace(mesh, frame, cone_clusters(size_));
    back_.resize(std::max(back_.size(), words_of(mesh.triangles.size())));
  }

  void finish() override {
    if (!coherent_) return;
    memories_.resize(scene().object_count());
    for (ObjectId object = 0; object < memories_.size(); ++object) {
      const MeshId mesh = scene().objects[object].mesh;
      if (mesh < trees_.size() && trees_[mesh]) memories_[object].emplace(*trees_[mesh]);
    }
  }

  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) override {
    const ConeTree& tree = *trees_[view.mesh];
    const TreeEye eye(view.eye);
    if (coherent_) return memories_[view.object]->mark(tree, eye, counts_);
    const std::span<std::uint64_t> back = std::span(back_).first(words_of(tree.triangle_count()));
    mark_tree(tree, eye, back, counts_);
    return back;
  }

  std::size_t mesh_bytes() const override {
    std::size_t sum = trees_.capacity() * sizeof(trees_[0]) +
                      memories_.capacity() * sizeof(memories_[0]) +
                      back_.capacity() * sizeof(std::uint64_t);
    for (const std::optional<ConeTree>& tree : trees_) sum += tree ? tree->bytes() : 0;
    for (const std::optional<TreeMemory>& memory : memories_) sum += memory ? memory->bytes() : 0;
    return sum;
  }

 private:
  bool coherent_;
  std::uint32_t size_;
  std::vector<std::optional<ConeTree>> trees_;       // by mesh
  std::vector<std::optional<TreeMemory>> memories_;  // by object
  std::vector<std::uint64_t> back_;                  // without coherence: of one object
  WalkCounts counts_;
};

}  // namespace

namespace cullers {

CullerEntry backface_hierarchical() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<Hierarchical>(
                values.choice("coherence") == "on",
                static_cast<std::uint32_t>(values.integer("size")), culls_open(values));
          }};
}

}  // namespace cullers
}  // namespace vislab
