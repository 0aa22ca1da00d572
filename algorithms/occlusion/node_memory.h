// What methods remember of the nodes of a hierarchy from frame to frame. All of it is a guess: what
// is hidden is asked about in every frame.
#pragma once

#include <cstdint>
#include <vector>

#include "common/spatial/query_hierarchy.h"

namespace vislab::occlusion_culling {

class NodeMemory {
 public:
  using NodeIndex = QueryHierarchy::NodeIndex;

  /// Of one node. Frames are counted from 2, so that 0 is never the last one.
  struct Node {
    std::uint32_t shown = 0;         // last frame in which it, or a unit below it, was visible
    std::uint32_t visited = 0;       // last frame in which it was decided about
    std::uint32_t hidden_since = 0;  // frame in which it was first found hidden; 0: it was not
    std::uint32_t test_at = 0;       // frame from which what was visible is asked about again
  };

  /// Forgets everything.
  void reset(std::size_t node_count) {
    nodes_.assign(node_count, {});
    now_ = first_frame;
    frame_ = no_frame;
  }

  /// At the start of every call of cull(). The tree may have grown since. Is it the frame's first?
  bool start(const Frame& frame, const QueryHierarchy& hierarchy) {
    if (hierarchy.node_count() > nodes_.size()) nodes_.resize(hierarchy.node_count());
    if (frame.index == frame_) return false;
    frame_ = frame.index;
    ++now_;
    return true;
  }

  /// Nodes that hold other things now.
  void forget(std::span<const NodeIndex> changed) {
    for (const NodeIndex node : changed) {
      if (node < nodes_.size()) nodes_[node] = {};
    }
  }

  /// The number of this frame.
  std::uint32_t now() const { return now_; }
  Node& operator[](NodeIndex node) { return nodes_[node]; }

  /// In the last frame, or already in this one.
  bool was_visible(NodeIndex node) const { return nodes_[node].shown + 1 >= now_; }
  bool was_visited(NodeIndex node) const { return nodes_[node].visited + 1 >= now_; }
  /// For how many frames in a row it has been found hidden, this one not counted.
  std::uint32_t hidden_frames(NodeIndex node) const {
    const Node& known = nodes_[node];
    return known.hidden_since != 0 && was_visited(node) ? now_ - known.hidden_since : 0;
  }

  /// The node and all above it are visible in this frame.
  void note_visible(const QueryHierarchy& hierarchy, NodeIndex node) {
    nodes_[node].hidden_since = 0;
    while (node != QueryHierarchy::nowhere && nodes_[node].shown != now_) {
      nodes_[node].shown = now_;
      node = hierarchy.parent(node);
    }
  }
  void note_hidden(NodeIndex node) {
    Node& known = nodes_[node];
    if (hidden_frames(node) == 0) known.hidden_since = now_;
    known.shown = 0;
  }

  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node); }

 private:
  static constexpr std::uint32_t first_frame = 1;
  static constexpr std::uint64_t no_frame = ~std::uint64_t{0};

  std::vector<Node> nodes_;
  std::uint32_t now_ = first_frame;
  std::uint64_t frame_ = no_frame;
};

}  // namespace vislab::occlusion_culling
