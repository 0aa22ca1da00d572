// PolygonBsp: a binary space partition by the planes of the polygons themselves.
//
// Idea: one face gives the plane of the root; what lies in front of it goes into one subtree, what
//   lies behind into the other, and what the plane cuts is cut there into two pieces. The node
//   keeps its own face and every piece that lies in its plane. Seen from anywhere, what is on the
//   far side of a node's plane cannot hide what is in it, and that cannot hide what is on the near
//   side: so the far subtree, the node's own pieces and the near subtree, one after another, are
//   all pieces from back to front.
// Guarantee: the order is right for every viewer up to the tolerance: a corner nearer to a plane
//   than that counts as lying in it. Interpenetrating and cyclically overlapping faces are cut
//   apart.
// Cost: building O(pieces × depth); a textbook gives O(n log n) pieces on average and O(n²) at
// worst.
//   A solid's faces all lie behind each other's planes, so its tree is as deep as it has faces and
//   takes O(n²) to build. A traversal is O(pieces).
// Limits: for what does not move. The tree's text in the textbook says that leaves are faces, and
//   its traversal never names the node's own face; with faces at the nodes both are mended.
// Sources: textbook chapter 17, Culling (in German), 17.2.3; Fuchs, Kedem and Naylor, "On visible
//   surface generation by a priori tree structures", 1980.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/geometry/random.h"

namespace vislab::surface {

/// In the plane (2: faces are edges) or in space (3: faces are triangles). Not for use by several
/// threads while it is built.
template <int dimensions>
class PolygonBsp {
 public:
  using Point = glm::vec<dimensions, double>;
  /// Counter-clockwise seen from its front: an edge has its front on its right-hand side.
  using Face = std::array<Point, dimensions>;
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

  struct Plane {
    Point normal;  // of length 1, towards the front
    Point point;   // in the plane
    double distance(const Point& p) const { return glm::dot(normal, p - point); }
  };
  /// A face or a part of it: what is left of face `face` on one side of each plane of its cuts.
  struct Piece {
    std::uint32_t face;
    std::uint32_t cut;  // the last of its cuts; none: it is whole
  };
  struct Cut {
    std::uint32_t node;   // whose plane cuts
    bool front;           // which side is kept
    std::uint32_t above;  // the cut before; none: there is none
  };
  struct Node {
    Plane plane;
    std::uint32_t front = none, back = none;
    std::uint32_t first_piece = 0, piece_count = 0;
  };

  /// Whose plane divides next. `first`: that of the first of the faces, as if they were inserted in
  /// this order. `sampled`: among eight drawn at random, the one that cuts least and halves best,
  /// by a sample of the others.
  enum class Splitter { first, sampled };
  struct Limits {
    Splitter splitter = Splitter::sampled;
    double tolerance = 0.0;  // metres; must cover the rounding of coordinates
    std::uint64_t max_pieces = 0;
    std::uint64_t max_tests = 0;  // pieces tested against planes
  };

  /// Faces without area have no plane and are left out. Returns false, and has no nodes, if a limit
  /// is exceeded.
  bool build(std::span<const Face> faces, const Limits& limits);

  /// The root is the first; empty if no face has a plane.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// What lies in the node's plane, its own face first.
  std::span<const Piece> pieces_of(const Node& node) const {
    return {pieces_.data() + node.first_piece, node.piece_count};
  }
  const std::vector<Cut>& cuts() const { return cuts_; }
  std::uint64_t pieces() const { return pieces_.size(); }
  /// How often a piece was cut in two.
  std::uint64_t splits() const { return splits_; }
  std::uint64_t tests() const { return tests_; }
  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + pieces_.capacity() * sizeof(Piece) +
           cuts_.capacity() * sizeof(Cut);
  }

  /// Memory of a traversal: at most one entry a level and two at the last.
  using Stack = std::vector<std::uint32_t>;

  /// Calls emit(node) for every node, from back to front or from front to back. side(plane) is
  /// positive if the viewer is in front of the plane, or looks at its front from infinity. `stack`
  /// is only memory. emit returns false to end the traversal.
  template <typename Side, typename Emit>
  void visit(bool back_to_front, Side&& side, Emit&& emit, Stack& stack) const;

 private:
  /// A piece while the tree is built.
  struct Part {
    std::uint32_t face;
    std::uint32_t cut;
    std::uint32_t first_corner, corner_count;
  };
  enum class Where { in, front, back, both };
  struct Task {
    std::uint32_t parent;
    bool front;
    std::vector<Part> parts;
  };

  static bool plane_of(const Face& face, Plane& plane);
  Where classify(const Part& part, const Plane& plane);
  std::array<Part, 2> divide(const Part& part, std::uint32_t node);
  std::size_t choose(const std::vector<Part>& parts, Random& random);
  void clear();

  Limits limits_;
  std::vector<Node> nodes_;
  std::vector<Piece> pieces_;
  std::vector<Cut> cuts_;
  std::uint64_t splits_ = 0;
  std::uint64_t tests_ = 0;
  // Only while it is built:
  std::vector<Point> corners_;
  std::vector<double> distances_;  // of the corners classified last
  std::vector<Plane> planes_;      // by face
  std::uint64_t part_count_ = 0;
};

template <int dimensions>
template <typename Side, typename Emit>
void PolygonBsp<dimensions>::visit(bool back_to_front, Side&& side, Emit&& emit,
                                   Stack& stack) const {
  // A node is on the stack until the subtree before it is done.
  stack.clear();
  const auto before_and_after = [&](const Node& node) {
    const bool front_is_near = side(node.plane) > 0.0;
    return front_is_near == back_to_front ? std::array{node.back, node.front}
                                          : std::array{node.front, node.back};
  };
  std::uint32_t at = nodes_.empty() ? none : 0U;
  while (at != none || !stack.empty()) {
    if (at != none) {
      stack.push_back(at);
      at = before_and_after(nodes_[at])[0];
      continue;
    }
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    if (!emit(node)) return;
    at = before_and_after(node)[1];
  }
}

extern template class PolygonBsp<2>;
extern template class PolygonBsp<3>;

}  // namespace vislab::surface
