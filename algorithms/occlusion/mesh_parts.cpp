#include "algorithms/occlusion/mesh_parts.h"

#include <algorithm>
#include <array>

#include "common/geometry/rounding.h"

namespace vislab::occlusion_culling {
namespace {

constexpr int places = 15;               // tried along an axis
constexpr double overlap = 1e-6;         // of cuts, by the mesh's greatest coordinate
constexpr double unevenness = 0.1;       // how much a difference in surface counts
constexpr std::size_t most_corners = 9;  // a triangle cut by six planes

/// What of a triangle lies in a part.
struct Piece {
  std::uint32_t triangle = 0;
  Aabb box;
};

struct Leaf {
  std::uint32_t part = 0;
  double surface = 0.0;
  std::vector<Piece> pieces;
};

Aabb overlap_of(const Aabb& a, const Aabb& b) {
  return {glm::max(a.min, b.min), glm::min(a.max, b.max)};
}

class MeshCutter {
 public:
  MeshCutter(const Mesh& mesh, std::vector<MeshPart>& parts) : mesh_(&mesh), parts_(&parts) {
    const glm::vec3 reach = glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max));
    margin_ = overlap * std::max({reach.x, reach.y, reach.z});
  }

  std::uint32_t cut(std::uint32_t max_leaves) {
    const auto whole = static_cast<std::uint32_t>(parts_->size());
    parts_->push_back({mesh_->bounds, 0});
    std::vector<Leaf> leaves;
    leaves.push_back(whole_leaf(whole));
    std::uint32_t count = 1;
    while (count < max_leaves) {
      const auto largest = std::ranges::max_element(leaves, {}, &Leaf::surface);
      if (largest == leaves.end() || largest->surface <= 0.0) break;
      Leaf leaf = std::move(*largest);
      leaves.erase(largest);
      if (cut_in_two(leaf, leaves)) ++count;
    }
    return whole;
  }

 private:
  Leaf whole_leaf(std::uint32_t part) const {
    Leaf leaf{part, half_area(mesh_->bounds), {}};
    leaf.pieces.reserve(mesh_->triangles.size());
    for (std::uint32_t triangle = 0; triangle < mesh_->triangles.size(); ++triangle) {
      Aabb box;
      for (int corner = 0; corner < 3; ++corner) {
        box.extend(mesh_->positions[mesh_->triangles[triangle][corner]]);
      }
      leaf.pieces.push_back({triangle, box});
    }
    return leaf;
  }

  struct Cut {
    double cost = 0.0;
    int axis = -1;
    float at = 0.0F;
  };

  /// False if no place of a cut leaves something on both sides.
  bool cut_in_two(const Leaf& leaf, std::vector<Leaf>& leaves) const {
    const Cut cut = best_cut(leaf);
    if (cut.axis < 0) return false;
    Leaf low = side_of(leaf, cut, false);
    Leaf high = side_of(leaf, cut, true);
    if (low.pieces.empty() || high.pieces.empty()) return false;
    low.part = static_cast<std::uint32_t>(parts_->size());
    high.part = low.part + 1;
    (*parts_)[leaf.part].first_half = low.part;
    for (Leaf* half : {&low, &high}) {
      Aabb box;
      for (const Piece& piece : half->pieces) box.extend(piece.box);
      parts_->push_back({box, 0});
      half->surface = half_area(box);
      leaves.push_back(std::move(*half));
    }
    return true;
  }

  Cut best_cut(const Leaf& leaf) const {
    const Aabb& whole = (*parts_)[leaf.part].box;
    Cut best;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = whole.min[axis];
      const double extent = whole.max[axis] - low;
      if (extent <= 4.0 * margin_) continue;
      std::array<float, places> at;
      for (int place = 0; place < places; ++place) {
        at[place] = static_cast<float>(low + extent * (place + 1) / (places + 1));
      }
      // Boxes between the places, then of all before each of them.
      std::array<Aabb, places + 1> slabs = boxes_between(leaf, axis, at);
      std::array<Aabb, places> below;
      below[0] = slabs[0];
      for (int place = 1; place < places; ++place) {
        below[place] = below[place - 1];
        below[place].extend(slabs[place]);
      }
      Aabb above;
      for (int place = places - 1; place >= 0; --place) {
        above.extend(slabs[place + 1]);
        const double a = half_area(below[place]);
        const double b = half_area(above);
        const double cost = a + b + unevenness * std::abs(a - b);
        if (best.axis < 0 || cost < best.cost) best = {cost, axis, at[place]};
      }
    }
    return best;
  }

  static std::array<Aabb, places + 1> boxes_between(const Leaf& leaf, int axis,
                                                    const std::array<float, places>& at) {
    std::array<Aabb, places + 1> slabs;
    const float per_metre = static_cast<float>(places - 1) / (at.back() - at.front());
    for (const Piece& piece : leaf.pieces) {
      const float end = piece.box.max[axis];
      Aabb rest = piece.box;
      // The first slab whose end is not before the box: guessed, then put right.
      const float guess = (rest.min[axis] - at.front()) * per_metre;
      auto slab = static_cast<int>(std::clamp(guess, 0.0F, static_cast<float>(places)));
      while (slab > 0 && at[slab - 1] >= rest.min[axis]) --slab;
      while (slab < places && at[slab] < rest.min[axis]) ++slab;
      for (; slab < places && end > at[slab]; ++slab) {
        rest.max[axis] = at[slab];
        slabs[slab].extend(rest);
        rest.min[axis] = at[slab];
      }
      rest.max[axis] = end;
      slabs[slab].extend(rest);
    }
    return slabs;
  }

  Leaf side_of(const Leaf& leaf, const Cut& cut, bool high) const {
    Leaf side;
    for (const Piece& piece : leaf.pieces) {
      const float low_end = piece.box.min[cut.axis];
      const float high_end = piece.box.max[cut.axis];
      // A piece that only touches the cut is whole on one side of it.
      if (high ? high_end <= cut.at && low_end < cut.at : low_end >= cut.at) continue;
      if (high ? low_end >= cut.at : high_end <= cut.at) {
        side.pieces.push_back(piece);
        continue;
      }
      Aabb half = piece.box;
      if (high) {
        half.min[cut.axis] = std::max(low_end, round_down(cut.at - margin_));
      } else {
        half.max[cut.axis] = std::min(high_end, round_up(cut.at + margin_));
      }
      const Aabb box = box_within(piece.triangle, half);
      if (!box.empty()) side.pieces.push_back({piece.triangle, box});
    }
    return side;
  }

  /// Box of what of the triangle lies in `limits`, and a little more.
  Aabb box_within(std::uint32_t triangle, const Aabb& limits) const {
    std::array<glm::dvec3, most_corners> polygon;
    std::array<glm::dvec3, most_corners> rest;
    std::size_t count = 3;
    for (int corner = 0; corner < 3; ++corner) {
      polygon[corner] = mesh_->positions[mesh_->triangles[triangle][corner]];
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        // Inside is where sign * p >= end.
        const double end =
            (sign > 0.0 ? limits.min[axis] : -static_cast<double>(limits.max[axis])) - margin_;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
          const glm::dvec3& a = polygon[i];
          const glm::dvec3& b = polygon[(i + 1) % count];
          const double from = sign * a[axis] - end;
          const double to = sign * b[axis] - end;
          if (from >= 0.0) rest[kept++] = a;
          if ((from >= 0.0) != (to >= 0.0)) rest[kept++] = a + (b - a) * (from / (from - to));
        }
        count = kept;
        std::swap(polygon, rest);
      }
    }
    Aabb box;
    for (std::size_t i = 0; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::min(box.min[axis], round_down(polygon[i][axis] - margin_));
        box.max[axis] = std::max(box.max[axis], round_up(polygon[i][axis] + margin_));
      }
    }
    return overlap_of(box, limits);
  }

  const Mesh* mesh_;
  std::vector<MeshPart>* parts_;
  double margin_ = 0.0;
};

}  // namespace

std::uint32_t cut_mesh(const Mesh& mesh, std::uint32_t max_leaves, std::vector<MeshPart>& parts) {
  return MeshCutter(mesh, parts).cut(max_leaves);
}

}  // namespace vislab::occlusion_culling
