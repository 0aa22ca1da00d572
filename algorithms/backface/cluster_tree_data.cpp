#include "algorithms/backface/cluster_tree_data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "algorithms/backface/back_bits.h"

namespace vislab::backface_culling {
namespace {

// What it takes, in nanoseconds, as measured on one processor of 2023 with AVX-512; what counts is
// how they compare, and that answers do not depend on the machine.
constexpr double mark_ns = 1.3;            // a run or a word marked
constexpr double mixed_triangle_ns = 1.9;  // a plane tested out of order, and its answer placed
constexpr double cached_plane_ns = 0.2;    // a plane tested in order
constexpr double streamed_plane_ns = 0.6;  // the same where they come from memory
constexpr double plane_bytes = 16.0;
constexpr double second_cache_bytes = 2097152.0;

}  // namespace

class ClusterTree::Builder {
 public:
  Builder(ClusterTree& tree, const Mesh& mesh, const MeshFrame& frame,
          const TriangleClusters& clusters, Origin origin)
      : tree_(tree),
        mesh_(mesh),
        frame_(frame),
        clusters_(clusters),
        origin_(origin),
        planes_(planes_in_order(mesh, frame, clusters)),
        bits_(words_of(mesh.triangles.size()), 0) {}

  void build() {
    for (std::uint32_t cluster = 0; cluster < clusters_.tested; ++cluster) {
      first_run_.push_back(tree_.runs_.size());
      tree_.runs_.append(clusters_.of(cluster));
    }
    first_run_.push_back(tree_.runs_.size());
    if (clusters_.nodes.empty()) return;
    find_levels();
    tree_.nodes_.emplace_back();
    fill(0, children_of(0));
    tree_.nodes_.shrink_to_fit();
    tree_.clusters_.shrink_to_fit();
    tree_.marks_.shrink_to_fit();
    tree_.runs_.shrink();
    tree_.words_.shrink();
  }

 private:
  using Part = TriangleClusters::Node;
  static constexpr std::uint32_t width = ClusterBlock::width;

  /// How high each part of the binary tree stands in a tree of full nodes: from the clusters up,
  /// parts are taken into one node as long as they have at most 16 children together.
  void find_levels() {
    levels_.assign(clusters_.nodes.size(), 0);
    std::vector<std::uint32_t> children(clusters_.nodes.size(), 1);
    for (std::size_t part = clusters_.nodes.size(); part-- > 0;) {
      const auto [first, end, left, right] = clusters_.nodes[part];
      if (left == 0) continue;
      const std::uint32_t level = std::max(levels_[left], levels_[right]);
      const std::uint32_t together = (levels_[left] == level ? children[left] : 1) +
                                     (levels_[right] == level ? children[right] : 1);
      levels_[part] = together <= width ? level : level + 1;
      children[part] = together <= width ? together : 2;
    }
  }

  /// The parts that are the children of the node at the top of `part`, in their order. A part that
  /// is a cluster is its own only child.
  std::vector<std::uint32_t> children_of(std::uint32_t part) const {
    std::vector<std::uint32_t> children;
    add_children(part, levels_[part], children);
    return children;
  }
  void add_children(std::uint32_t part, std::uint32_t level,
                    std::vector<std::uint32_t>& children) const {
    const Part& divided = clusters_.nodes[part];
    if (divided.is_cluster() || levels_[part] != level) {
      children.push_back(part);
    } else {
      add_children(divided.left, level, children);
      add_children(divided.right, level, children);
    }
  }

  /// Fills the node and makes those below it. Returns the box around it all.
  Aabb fill(std::uint32_t node, const std::vector<std::uint32_t>& parts) {
    tree_.clusters_.resize(tree_.nodes_.size() * width);
    tree_.marks_.resize(tree_.nodes_.size() * width);
    tree_.nodes_[node].count = static_cast<std::uint32_t>(parts.size());
    tree_.nodes_[node].only_clusters = std::ranges::all_of(
        parts, [&](std::uint32_t part) { return clusters_.nodes[part].is_cluster(); });
    Aabb around;
    for (std::uint32_t lane = 0; lane < parts.size(); ++lane) {
      const Part& part = clusters_.nodes[parts[lane]];
      const std::uint32_t child = node * width + lane;
      const Clusters below = clusters_in(part);
      tree_.clusters_[child] = below;
      tree_.marks_[child] = {first_run_[below.first], first_run_[below.first + below.count], false};
      Aabb box;
      if (part.is_cluster()) {
        box = box_of(mesh_, frame_, clusters_.of(below.first));
      } else {
        const auto deeper = static_cast<std::uint32_t>(tree_.nodes_.size());
        tree_.nodes_[node].node[lane] = deeper;
        tree_.nodes_.emplace_back();
        box = fill(deeper, children_of(parts[lane]));
        shorten(child, part);
      }
      const ClusterBound bound = bound_of(
          std::span(planes_).subspan(part.first, part.end - part.first), box, frame_, origin_);
      tree_.nodes_[node].children.set(lane, bound);
      tree_.nodes_[node].front[lane] = bound.front;
      for (int axis = 0; axis < 3; ++axis) {
        tree_.reach_ = std::max(tree_.reach_, double(std::abs(bound.origin[axis])));
      }
      around.extend(box);
    }
    return around;
  }

  Clusters clusters_in(const Part& part) const {
    const auto at = [&](std::uint32_t position) {
      const auto begin = clusters_.first.begin();
      return static_cast<std::uint32_t>(
          std::lower_bound(begin, begin + clusters_.tested, position) - begin);
    };
    const std::uint32_t first = at(part.first);
    return {first, at(part.end) - first};
  }

  /// Many triangles of a part may share words: then it is marked by those and not by the runs of
  /// its clusters.
  void shorten(std::uint32_t child, const Part& part) {
    const std::span<const std::uint32_t> triangles =
        std::span(clusters_.order).subspan(part.first, part.end - part.first);
    ascending_.assign(triangles.begin(), triangles.end());
    if (triangles.size() > bits_.size() / 16) {
      for (const std::uint32_t triangle : triangles) {
        bits_[triangle / 64] |= std::uint64_t{1} << (triangle % 64);
      }
      std::size_t count = 0;
      for (std::size_t word = 0; word < bits_.size(); ++word) {
        for (std::uint64_t rest = bits_[word]; rest != 0; rest &= rest - 1) {
          ascending_[count++] = static_cast<std::uint32_t>(word * 64) +
                                static_cast<std::uint32_t>(std::countr_zero(rest));
        }
        bits_[word] = 0;
      }
    } else {
      std::ranges::sort(ascending_);
    }
    Marks& marks = tree_.marks_[child];
    if (WordList::words_for(ascending_) > (marks.end - marks.first) / 2) return;
    marks = {tree_.words_.size(), 0, true};
    tree_.words_.append(ascending_);
    marks.end = tree_.words_.size();
  }

  ClusterTree& tree_;
  const Mesh& mesh_;
  const MeshFrame& frame_;
  const TriangleClusters& clusters_;
  Origin origin_;
  std::vector<std::uint32_t> levels_;     // by node of the binary tree
  std::vector<glm::dvec4> planes_;        // in the order of the clusters
  std::vector<std::uint32_t> first_run_;  // by cluster, and the end
  std::vector<std::uint64_t> bits_;       // by triangle
  std::vector<std::uint32_t> ascending_;
};

ClusterTree::ClusterTree(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings,
                         MixedClusters mixed) {
  RunList::check(mesh.triangles.size());
  const TriangleClusters clusters = make_clusters(mesh, frame, settings);
  cluster_count_ = clusters.tested;
  Builder(*this, mesh, frame, clusters, settings.origin).build();
  if (mixed == MixedClusters::test) planes_.emplace(mesh, frame, clusters);
}

std::size_t ClusterTree::mark_mixed(std::span<const std::uint32_t> clusters, const PlaneTest& test,
                                    std::uint64_t* bits) const {
  planes_->mark(clusters, test, bits);
  std::size_t tested = planes_->triangles_in(clusters);
  if (planes_->cluster_count() > cluster_count_) {
    const std::array<std::uint32_t, 1> apart = {cluster_count_};
    planes_->mark(apart, test, bits);
    tested += planes_->triangles_in(apart);
  }
  return tested;
}

bool ClusterTree::is_slower_than_planes(const MeshFrame& frame, double eye_distance) const {
  TreeAnswer answer;
  answer.reserve(nodes_.size());
  std::size_t marks = 0;
  std::size_t mixed_triangles = 0;
  constexpr unsigned eyes = 8;
  for (unsigned i = 0; i < eyes; ++i) {
    const glm::dvec3 way((i & 1U) != 0 ? 1.0 : -1.0, (i & 2U) != 0 ? 1.0 : -1.0,
                         (i & 4U) != 0 ? 1.0 : -1.0);
    MeshEye eye;
    eye.position = glm::dvec4(eye_distance * frame.size / std::sqrt(3.0) * way, 1.0);
    find_back_and_mixed(nodes_, cluster_eye(eye, frame, reach_), answer);
    for (const std::uint32_t child : answer.found()) {
      marks += marks_[child].end - marks_[child].first;
    }
    for (const std::uint32_t child : answer.found_mixed()) {
      mixed_triangles += planes_->triangles_in(std::span(&clusters_[child].first, 1));
    }
  }
  const auto triangles = static_cast<double>(planes_->triangle_count());
  const double plane_ns =
      triangles * plane_bytes <= second_cache_bytes ? cached_plane_ns : streamed_plane_ns;
  const double tree_ns = mark_ns * static_cast<double>(marks) +
                         mixed_triangle_ns * static_cast<double>(mixed_triangles);
  return tree_ns > plane_ns * triangles * eyes;
}

std::size_t ClusterTree::bytes() const {
  return nodes_.capacity() * sizeof(ClusterTreeNode) + clusters_.capacity() * sizeof(Clusters) +
         marks_.capacity() * sizeof(Marks) + runs_.bytes() + words_.bytes() +
         (planes_ ? planes_->bytes() : 0);
}

}  // namespace vislab::backface_culling
