// Cells and portals as the walks need them: which portals lead out of a cell, which objects lie in
// it, and which cells a camera starts in.
//
// Portals are made a little larger in their planes (portal_slack_m), since their corners are
// rounded: what is seen past a rounded edge is seen through the portal.
//
// Guarantee of the start cells: a ray that begins anywhere in the near plane's window begins in one
//   of them. Whether cells cover the window is found by taking away from it what lies in each cell,
//   so that cells that overlap do not make up for a gap.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/convex_polygon.h"
#include "common/scene/frame.h"
#include "common/spatial/bvh.h"

namespace vislab::portal_culling {

inline constexpr double portal_slack_m = 4e-6;

struct Opening {
  CellId to = none_id;
  Plane plane;  // inside is the side of the cell that it leads out of
  std::uint32_t first_corner = 0, corner_count = 0;  // of PortalGraph::corners
};

class PortalGraph {
 public:
  /// A scene without cells gives a graph that no camera is in.
  void build(const Scene& scene);

  std::size_t cell_count() const { return objects_of_.size(); }
  std::size_t opening_count() const { return openings_.size(); }
  const Opening& opening(std::uint32_t id) const { return openings_[id]; }
  /// Ids of the openings that lead out of the cell are `first` … `end` - 1.
  std::uint32_t first_opening(CellId cell) const { return first_opening_[cell]; }
  std::uint32_t end_opening(CellId cell) const { return first_opening_[cell + 1]; }
  std::span<const glm::dvec3> corners(const Opening& opening) const {
    return {corners_.data() + opening.first_corner, opening.corner_count};
  }

  /// Where the scene puts them; ascending.
  std::span<const ObjectId> objects_of(CellId cell) const { return objects_of_[cell]; }
  /// Objects that the scene puts into no cell: no portal tells anything about them. Ascending.
  std::span<const ObjectId> free_objects() const { return free_; }

  /// The cells in which the image's rays begin: those that the near plane's window reaches into.
  /// False if a part of it lies in no cell: then portals tell nothing. Allocates nothing but room
  /// in `cells`.
  bool start_cells(const Camera& camera, std::vector<CellId>& cells) const;
  /// The cells that a box reaches into, each once.
  void cells_of(const Aabb& box, std::vector<CellId>& cells) const;

  std::size_t bytes() const;

 private:
  void add_openings(const Scene& scene);
  void add_regions(const Scene& scene);
  void add_objects(const Scene& scene);
  template <typename Visit>
  void for_each_region_near(const Aabb& box, Visit&& visit) const;

  std::vector<Opening> openings_;
  std::vector<std::uint32_t> first_opening_;
  std::vector<glm::dvec3> corners_;
  std::vector<ConvexRegion> regions_;
  std::vector<CellId> cell_of_region_;
  Bvh region_tree_{Bvh::Limits{}};
  std::vector<std::vector<ObjectId>> objects_of_;
  std::vector<ObjectId> free_;
};

}  // namespace vislab::portal_culling
