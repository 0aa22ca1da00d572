#include "algorithms/occlusion/tight_bounds.h"

#include <algorithm>
#include <array>

namespace vislab::occlusion_culling {
namespace {

constexpr std::uint32_t most_boxes = TightBounds::most_boxes;
/// A mesh has so many times more parts than boxes may be given out, so that parts on one side of it
/// can be small.
constexpr std::uint32_t parts_per_box = 2;
constexpr double price_of_box = 0.02;  // of the room
/// Boxes are made larger by this share of the whole's longest side before their room is compared,
/// so that flat ones have some.
constexpr double thickness = 0.01;

struct Piece {
  enum class Kind : std::uint8_t { node, object, part };
  Aabb box;
  double surface = 0.0;
  double room = 0.0;
  Kind kind = Kind::part;
  bool whole = false;  // cannot be divided, or not without breaking the rule
  std::uint32_t index = 0;
  ObjectId object = 0;  // of a part
};

/// A part's box is cut to its object's, which holds the part's triangles too.
Aabb overlap_of(const Aabb& a, const Aabb& b) {
  return {glm::max(a.min, b.min), glm::min(a.max, b.max)};
}

/// One division into pieces, and the best one so far.
class Division {
 public:
  Division(const TightBounds::Limits& limits, const Aabb& box)
      : max_pieces_(limits.max_boxes),
        surface_limit_(limits.sigma * half_area(box)),
        finest_(limits.finest) {
    const glm::dvec3 size = box.half_size() * 2.0;
    pad_ = thickness * std::max({size.x, size.y, size.z});
  }

  void start(Piece piece) {
    measure(piece);
    pieces_[0] = piece;
    count_ = 1;
    keep_if_best();
  }

  /// The piece to be divided next; null if there is none.
  Piece* largest() {
    Piece* found = nullptr;
    for (Piece& piece : std::span(pieces_).first(count_)) {
      if (!piece.whole && (found == nullptr || piece.surface > found->surface)) found = &piece;
    }
    return found;
  }

  std::uint32_t pieces_for_one() const { return max_pieces_ - count_ + 1; }

  /// Puts `parts` in place of `piece` if the rule still holds; else marks the piece.
  void replace(Piece& piece, std::span<Piece> parts) {
    double surface = -piece.surface;
    for (const Piece& other : std::span(pieces_).first(count_)) surface += other.surface;
    for (Piece& part : parts) {
      measure(part);
      surface += part.surface;
    }
    if (surface > surface_limit_) {
      piece.whole = true;
      return;
    }
    piece = parts.front();
    for (const Piece& part : parts.subspan(1)) pieces_[count_++] = part;
    keep_if_best();
  }

  std::span<const Aabb> best() const { return std::span(best_).first(best_count_); }

 private:
  void measure(Piece& piece) const {
    piece.surface = half_area(piece.box);
    const glm::dvec3 size = piece.box.half_size() * 2.0 + pad_;
    piece.room = size.x * size.y * size.z;
  }

  void keep_if_best() {
    double room = 0.0;
    for (const Piece& piece : std::span(pieces_).first(count_)) room += piece.room;
    const double price = room * (1.0 + price_of_box * count_);
    if (best_count_ > 0 && price >= best_price_ && !finest_) return;
    best_price_ = price;
    best_count_ = count_;
    for (std::uint32_t i = 0; i < count_; ++i) best_[i] = pieces_[i].box;
  }

  std::uint32_t max_pieces_;
  double surface_limit_;
  bool finest_;
  double pad_ = 0.0;
  std::uint32_t count_ = 0;
  std::uint32_t best_count_ = 0;
  double best_price_ = 0.0;
  std::array<Piece, most_boxes> pieces_;
  std::array<Aabb, most_boxes> best_;
};

}  // namespace

/// Divides pieces until no piece can be, and appends the best division's boxes.
class TightBounds::Divider {
 public:
  Divider(const TightBounds& bounds, const ObjectsView& objects, const SpatialStructure* tree,
          std::uint32_t max_boxes)
      : bounds_(&bounds), objects_(&objects), tree_(tree), limits_(bounds.limits_) {
    limits_.max_boxes = std::min(limits_.max_boxes, max_boxes);
  }

  std::uint32_t append(const Piece& whole, std::vector<Aabb>& out) const {
    Division division(limits_, whole.box);
    division.start(whole);
    std::array<Piece, most_boxes> parts;
    while (Piece* piece = division.largest()) {
      const std::uint32_t count = divide(*piece, std::span(parts).first(division.pieces_for_one()));
      if (count == 0) {
        piece->whole = true;
      } else {
        division.replace(*piece, std::span(parts).first(count));
      }
    }
    const std::span<const Aabb> best = division.best();
    out.insert(out.end(), best.begin(), best.end());
    return static_cast<std::uint32_t>(best.size());
  }

  Piece object(ObjectId id) const {
    return {.box = objects_->bounds[id], .kind = Piece::Kind::object, .index = id};
  }

 private:
  /// Writes what the piece consists of; 0 if it cannot be divided, or into too many.
  std::uint32_t divide(const Piece& piece, std::span<Piece> parts) const {
    if (piece.kind == Piece::Kind::node) return divide_node(piece.index, parts);
    if (piece.kind == Piece::Kind::object) {
      return halves_of(bounds_->whole_mesh_[bounds_->scene_->objects[piece.index].mesh],
                       piece.index, parts);
    }
    return halves_of(piece.index, piece.object, parts);
  }

  std::uint32_t divide_node(std::uint32_t index, std::span<Piece> parts) const {
    const SpatialNode& node = tree_->nodes()[index];
    const std::span<const ObjectId> here = tree_->objects_at(index);
    std::uint32_t count = 0;
    if (node.child_count + here.size() > parts.size()) return 0;
    for (std::uint32_t i = 0; i < node.child_count; ++i) {
      const Aabb& box = tree_->nodes()[node.first_child + i].box;
      if (box.empty()) continue;
      parts[count++] = {.box = box, .kind = Piece::Kind::node, .index = node.first_child + i};
    }
    for (const ObjectId id : here) parts[count++] = object(id);
    return count;
  }

  std::uint32_t halves_of(std::uint32_t index, ObjectId id, std::span<Piece> parts) const {
    const std::uint32_t first = bounds_->parts_[index].first_half;
    if (first == 0 || parts.size() < 2) return 0;
    for (std::uint32_t i = 0; i < 2; ++i) {
      const Aabb box = transformed(bounds_->parts_[first + i].box, objects_->transforms[id]);
      parts[i] = {.box = overlap_of(box, objects_->bounds[id]), .index = first + i, .object = id};
    }
    return 2;
  }

  const TightBounds* bounds_;
  const ObjectsView* objects_;
  const SpatialStructure* tree_;
  Limits limits_;
};

void TightBounds::build(const Scene& scene, const Limits& limits) {
  scene_ = &scene;
  limits_ = limits;
  limits_.max_boxes = std::min(limits.max_boxes, most_boxes);
  parts_.assign(1, {});
  whole_mesh_.clear();
  for (const Mesh& mesh : scene.meshes) {
    whole_mesh_.push_back(cut_mesh(mesh, parts_per_box * limits_.max_boxes, parts_));
  }
  parts_.shrink_to_fit();
}

std::uint32_t TightBounds::append(ObjectId object, const ObjectsView& objects,
                                  std::vector<Aabb>& out) const {
  if (!objects.bounds[object].valid()) {
    out.push_back(objects.bounds[object]);
    return 1;
  }
  const Divider divider(*this, objects, nullptr, most_boxes);
  return divider.append(divider.object(object), out);
}

std::uint32_t TightBounds::append(const SpatialStructure& tree, SpatialStructure::NodeIndex node,
                                  const ObjectsView& objects, std::uint32_t max_boxes,
                                  std::vector<Aabb>& out) const {
  const Aabb& box = tree.nodes()[node].box;
  if (box.empty()) return 0;
  return Divider(*this, objects, &tree, max_boxes)
      .append({.box = box, .kind = Piece::Kind::node, .index = node}, out);
}

std::size_t TightBounds::bytes() const {
  return parts_.capacity() * sizeof(MeshPart) + whole_mesh_.capacity() * sizeof(std::uint32_t);
}

}  // namespace vislab::occlusion_culling
