// The painter's algorithm by a tree of the polygons' own planes, for the culler surface.bsp and the
// wrong variants of it.
#pragma once

#include "algorithms/surface/polygon_bsp.h"
#include "algorithms/surface/surface_culler.h"

namespace vislab::surface {

class BspPainter final : public SurfaceCuller {
 public:
  enum class Order { back_to_front, front_to_back };
  struct Options {
    Order order = Order::back_to_front;
    PolygonBsp<3>::Splitter splitter = PolygonBsp<3>::Splitter::sampled;
    double epsilon_m = 0.0;  // on top of what rounding needs
    std::uint64_t max_fragments = 0;
    /// Only leaves are drawn, as the textbook's text has it: for negative controls.
    bool forgets_inner_nodes = false;
  };
  BspPainter(CullerInfo info, const Options& options)
      : SurfaceCuller(std::move(info)), options_(options) {}

  /// fragments, splits: of the whole tree, each time that cull() is called.
  Counters counters() const override;

 protected:
  void prepare() override;
  void paint(const Frame& frame, const Candidates& candidates) override;
  std::size_t own_bytes() const override;
  void order(std::vector<TriangleRange>& kept) override;

 private:
  using Tree = PolygonBsp<3>;

  void offer(const WindowTransform& window, const Frame& frame, const Candidates& candidates);
  void paint_tree(const WindowTransform& window, const Frame& frame);
  void paint_piece(const WindowTransform& window, const Tree::Piece& piece);
  void paint_moved(const WindowTransform& window, const Frame& frame, const Candidates& candidates);
  void paint_row(TriangleId triangle, int y, RowSpan row);
  void put(TriangleId triangle, int x, int y);
  int next_free(int x, int y);
  std::size_t free_index(int x, int y) const;
  bool has_moved(const Frame& frame, ObjectId object) const;

  Options options_;
  Tree tree_;
  std::vector<std::array<glm::dvec3, 3>> corners_;  // by triangle, from the scene's origin
  std::vector<ObjectId> object_of_;                 // by triangle
  // Of the frame that is painted:
  std::vector<WindowRows> rows_;  // by object
  std::vector<std::uint8_t>
      offered_;                       // by triangle: is it, and does it stand where the tree has it
  std::vector<std::uint32_t> ranks_;  // by triangle: in the order of their first fragments
  std::uint32_t next_rank_ = 0;
  bool any_moved_ = false;
  std::vector<double> nearness_;  // by pixel; only if something has moved
  std::vector<int> free_;         // front to back: a free pixel at or after this one of its row
  std::uint64_t free_pixels_ = 0;
  WindowFace face_;
  struct Side {
    WindowLine line;
    bool front;
  };
  std::vector<Side> sides_;  // of the cuts of a piece
  Tree::Stack stack_;
  std::uint64_t fragments_ = 0, splits_ = 0, drawn_fragments_ = 0, writes_ = 0;
};

}  // namespace vislab::surface
