#include "algorithms/backface/cluster_culler.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "algorithms/backface/facing_culler.h"
#include "algorithms/backface/flat_clusters.h"

namespace vislab::backface_culling {
namespace {

class ClusterCuller : public FacingCuller {
 public:
  ClusterCuller(CullerInfo info, bool cull_open, ClusterSettingsOf settings)
      : FacingCuller(std::move(info), cull_open), settings_(std::move(settings)) {}

  Counters counters() const override { return {{"cluster_tests", cluster_tests_}}; }

 protected:
  void clear() override { meshes_.clear(); }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame,
                const BuildContext& context) override {
    meshes_.resize(id + 1);
    meshes_[id].emplace(mesh, frame, settings_(context));
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
    std::size_t bytes = meshes_.capacity() * sizeof(meshes_[0]) +
                        (back_.capacity() + bits_.capacity()) * sizeof(std::uint64_t);
    for (const std::optional<FlatClusters>& clusters : meshes_) {
      bytes += clusters ? clusters->bytes() : 0;
    }
    return bytes;
  }

 private:
  ClusterSettingsOf settings_;
  std::vector<std::optional<FlatClusters>> meshes_;  // by id; none where nothing is tested
  std::vector<std::uint64_t> back_;                  // by cluster of one mesh
  std::vector<std::uint64_t> bits_;                  // by triangle of one mesh
  std::uint64_t cluster_tests_ = 0;
};

}  // namespace

std::unique_ptr<ICuller> make_cluster_culler(CullerInfo info, bool cull_open,
                                             ClusterSettingsOf settings) {
  return std::make_unique<ClusterCuller>(std::move(info), cull_open, std::move(settings));
}

}  // namespace vislab::backface_culling
