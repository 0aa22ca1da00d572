#include "algorithms/surface/bsp_culler.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

#include "common/scene/error.h"

namespace vislab::surface {
namespace {

constexpr std::uint32_t no_rank = 0xFFFFFFFFU;
// A tree that needs more tests than this times its fragments is one long chain: a large solid's.
constexpr std::uint64_t tests_per_fragment = 500;

}  // namespace

Counters BspPainter::counters() const {
  return {{"fragments", fragments_},
          {"splits", splits_},
          {"fragments_drawn", drawn_fragments_},
          {"pixels_written", writes_}};
}

void BspPainter::prepare() {
  const Scene& all = scene();
  corners_.clear();
  object_of_.clear();
  double extent = 0.0;
  for (ObjectId object = 0; object < all.object_count(); ++object) {
    for (std::uint32_t i = 0; i < all.triangle_count(object); ++i) {
      auto corners = world_triangle(all.mesh_of(object), all.objects[object].transform, i);
      for (glm::dvec3& corner : corners) {
        corner -= all.origin();
        extent = std::max({extent, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
      }
      corners_.push_back(corners);
      object_of_.push_back(object);
    }
  }
  // A corner's place is rounded a few times, and the planes through corners once more.
  constexpr double roundings = 64.0;
  const double rounding_m =
      roundings * std::numeric_limits<double>::epsilon() * (extent + glm::length(all.origin()));
  const Tree::Limits limits{options_.splitter, rounding_m + options_.epsilon_m,
                            options_.max_fragments, tests_per_fragment * options_.max_fragments};
  if (!tree_.build(corners_, limits)) {
    throw InputError(
        info().name + ": the " + std::to_string(corners_.size()) + " triangles of scene '" +
        all.name + "' make a tree of more than " + std::to_string(options_.max_fragments) +
        " fragments, or too deep a one: given up after " + std::to_string(tree_.splits()) +
        " splits and " + std::to_string(tree_.tests()) +
        " tests; take a smaller scene or a greater max_fragments");
  }
  rows_.assign(all.object_count(), {});
  offered_.assign(corners_.size(), 0);
  ranks_.assign(corners_.size(), no_rank);
}

std::size_t BspPainter::own_bytes() const {
  return tree_.bytes() + corners_.capacity() * sizeof(corners_[0]) +
         object_of_.capacity() * sizeof(ObjectId) + offered_.capacity() +
         ranks_.capacity() * sizeof(std::uint32_t) + rows_.capacity() * sizeof(WindowRows) +
         nearness_.capacity() * sizeof(double) + free_.capacity() * sizeof(int) +
         sides_.capacity() * sizeof(Side) + stack_.capacity() * sizeof(stack_[0]);
}

bool BspPainter::has_moved(const Frame& frame, ObjectId object) const {
  return frame.objects.transforms[object] != scene().objects[object].transform;
}

void BspPainter::offer(const WindowTransform& window, const Frame& frame,
                       const Candidates& candidates) {
  any_moved_ = false;
  for_each_range(candidates, frame, scene(), [&](const TriangleRange& range) {
    const TriangleId first = scene().first_triangle(range.object) + range.first;
    std::fill_n(ranks_.begin() + first, range.count, no_rank);
    if (has_moved(frame, range.object)) {
      any_moved_ = true;
      return;
    }
    rows_[range.object] = window.mesh(frame.objects.transforms[range.object]);
    std::fill_n(offered_.begin() + first, range.count, std::uint8_t{1});
  });
}

void BspPainter::paint(const Frame& frame, const Candidates& candidates) {
  const WindowTransform window(frame.camera, frame.viewport);
  offer(window, frame, candidates);
  if (any_moved_) {
    nearness_.assign(image().owners().size(), -std::numeric_limits<double>::infinity());
  }
  next_rank_ = 0;
  paint_tree(window, frame);
  if (any_moved_) paint_moved(window, frame, candidates);
  for_each_range(candidates, frame, scene(), [&](const TriangleRange& range) {
    const TriangleId first = scene().first_triangle(range.object) + range.first;
    std::fill_n(offered_.begin() + first, range.count, std::uint8_t{0});
  });
  fragments_ += tree_.pieces();
  splits_ += tree_.splits();
}

void BspPainter::paint_tree(const WindowTransform& window, const Frame& frame) {
  const bool back_to_front = options_.order == Order::back_to_front;
  if (!back_to_front) {
    const Viewport& viewport = frame.viewport;
    free_pixels_ = image().owners().size();
    free_.resize(static_cast<std::size_t>(viewport.height) *
                 (static_cast<std::size_t>(viewport.width) + 1));
    for (int y = 0; y < viewport.height; ++y) {
      const auto row = free_.begin() + static_cast<std::ptrdiff_t>(free_index(0, y));
      std::iota(row, row + viewport.width + 1, 0);
    }
  }
  const Camera& camera = frame.camera;
  const glm::dvec3 eye = camera.pose.eye - scene().origin();
  const auto side = [&](const Tree::Plane& plane) {
    return camera.lens.projection == Projection::orthographic
               ? glm::dot(plane.normal, camera.pose.back)
               : plane.distance(eye);
  };
  const auto emit = [&](const Tree::Node& node) {
    const bool inner = node.front != Tree::none || node.back != Tree::none;
    if (inner && options_.forgets_inner_nodes) return true;
    // In one plane the first has the pixel, as with a z-buffer.
    const std::span<const Tree::Piece> pieces = tree_.pieces_of(node);
    if (back_to_front) {
      for (std::size_t i = pieces.size(); i-- > 0;) paint_piece(window, pieces[i]);
      return true;
    }
    for (const Tree::Piece& piece : pieces) paint_piece(window, piece);
    return free_pixels_ > 0;
  };
  tree_.visit(back_to_front, side, emit, stack_);
}

void BspPainter::paint_piece(const WindowTransform& window, const Tree::Piece& piece) {
  const TriangleId triangle = piece.face;
  if (offered_[triangle] == 0) return;
  const ObjectId object = object_of_[triangle];
  const std::uint32_t in_mesh = triangle - scene().first_triangle(object);
  if (!face_.set(window, corners_of(scene().mesh_of(object), in_mesh, rows_[object]))) return;
  // Both sides of a cut ask for the sign of one and the same line, so that they fit together.
  sides_.clear();
  const std::array<glm::dvec3, 3>& corners = corners_[triangle];
  for (std::uint32_t i = piece.cut; i != Tree::none; i = tree_.cuts()[i].above) {
    const Tree::Cut& cut = tree_.cuts()[i];
    const Tree::Plane& plane = tree_.nodes()[cut.node].plane;
    sides_.push_back({face_.line({plane.distance(corners[0]), plane.distance(corners[1]),
                                  plane.distance(corners[2])}),
                      cut.front});
  }
  ++drawn_fragments_;
  face_.for_each_row([&](int y, RowSpan row, const RowEnds&) {
    for (const Side& side : sides_) row = on_side(row, side.line, y, side.front);
    if (!row.empty()) paint_row(triangle, y, row);
  });
}

void BspPainter::put(TriangleId triangle, int x, int y) {
  image().at(x, y) = triangle;
  ++writes_;
  if (any_moved_) nearness_[image().index(x, y)] = face_.nearness().at(x, y);
}

void BspPainter::paint_row(TriangleId triangle, int y, RowSpan row) {
  if (options_.order == Order::back_to_front) {
    for (int x = row.x0; x < row.x1; ++x) put(triangle, x, y);
    if (ranks_[triangle] == no_rank) ranks_[triangle] = next_rank_++;
    return;
  }
  for (int x = next_free(row.x0, y); x < row.x1; x = next_free(x + 1, y)) {
    put(triangle, x, y);
    free_[free_index(x, y)] = x + 1;
    --free_pixels_;
    if (ranks_[triangle] == no_rank) ranks_[triangle] = next_rank_++;
  }
}

std::size_t BspPainter::free_index(int x, int y) const {
  return static_cast<std::size_t>(y) * (static_cast<std::size_t>(image().viewport().width) + 1) +
         static_cast<std::size_t>(x);
}

/// A free pixel or the row's end; paths are halved as they are walked.
int BspPainter::next_free(int x, int y) {
  int* const row = free_.data() + free_index(0, y);
  while (row[x] != x) {
    row[x] = row[row[x]];
    x = row[x];
  }
  return x;
}

/// Objects that stand elsewhere than the tree has them have no place in its order: they are drawn
/// last, with a depth test.
void BspPainter::paint_moved(const WindowTransform& window, const Frame& frame,
                             const Candidates& candidates) {
  for_each_range(candidates, frame, scene(), [&](const TriangleRange& range) {
    if (!has_moved(frame, range.object)) return;
    const WindowRows rows = window.mesh(frame.objects.transforms[range.object]);
    const Mesh& mesh = scene().mesh_of(range.object);
    const TriangleId first = scene().first_triangle(range.object);
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      if (!face_.set(window, corners_of(mesh, i, rows))) continue;
      face_.for_each_row([&](int y, RowSpan row, const RowEnds&) {
        for (int x = row.x0; x < row.x1; ++x) {
          if (face_.nearness().at(x, y) > nearness_[image().index(x, y)]) put(first + i, x, y);
        }
      });
    }
  });
}

void BspPainter::order(std::vector<TriangleRange>& kept) {
  for (std::size_t i = 0, end = kept.size(); i < end; ++i) {
    const TriangleRange range = kept[i];
    kept[i].count = 1;
    for (std::uint32_t k = 1; k < range.count; ++k) {
      kept.push_back({range.object, range.first + k, 1});
    }
  }
  const auto key = [&](const TriangleRange& range) {
    const TriangleId triangle = scene().first_triangle(range.object) + range.first;
    return std::pair(ranks_[triangle], triangle);
  };
  std::ranges::sort(kept, {}, key);
}

}  // namespace vislab::surface
