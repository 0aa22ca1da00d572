// Region truth: what can be seen from anywhere in a cell, by rays from sampled viewpoints, and what
// a potentially visible set is worth against it.
//
// Idea: viewpoints spread evenly over the cell's regions, rays from each in all directions; what
//   any of them hits first is seen from the cell. Rays that leave the cells on their way, into a
//   wall that is not drawn or out of a world that leaks, tell nothing of portals: where they are
//   what a set is said to miss, they are counted apart.
// Guarantee: everything found is visible; what is seen through small gaps only may not be found. So
//   a miss is a fault of the set, and over-inclusion is an upper bound.
// Cost: one ray each, some 0.5 us, and O(regions) for each ray that is missed.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/culler/culler.h"
#include "common/scene/scene.h"

namespace vislab {

struct RegionSettings {
  std::uint32_t viewpoints = 16;  // in each cell
  std::uint32_t rays = 256;       // from each viewpoint
  std::uint64_t seed = 1;
  int threads = 2;  // at least 1; does not change the answer
};

/// Objects that rays from a cell hit first.
struct ObjectRays {
  ObjectId object = 0;
  std::uint32_t rays = 0;
};

struct CellTruth {
  CellId cell = none_id;
  std::uint32_t viewpoints = 0;      // 0: the cell is too thin to stand in
  std::vector<ObjectRays> seen;      // by ascending object
  std::uint64_t seen_by_points = 0;  // objects seen from each viewpoint, summed over these
};

/// Verdict on the sets of some cells.
struct RegionVerdict {
  std::uint64_t cells = 0, viewpoints = 0;
  std::uint64_t rays = 0;    // traced
  std::uint64_t hits = 0;    // that hit an object
  std::uint64_t misses = 0;  // whose object is not in the set of the cell where they begin
  std::uint64_t strays = 0;  // the same, but they left the cells on their way: no fault of the set
  std::uint64_t kept = 0;    // objects in the sets, summed over cells
  std::uint64_t unseen = 0;  // of these, objects that no ray from the cell hits
  std::uint64_t seen = 0;    // objects hit from a cell, summed over cells
  std::uint64_t kept_by_points = 0, seen_by_points = 0;  // the same summed over viewpoints

  /// region_over: unseen / seen.
  double over() const;
  /// region_over_points: the same against what is seen from a single viewpoint, which is what a set
  /// for a whole cell costs.
  double over_points() const;
  /// At most 16 rays that are missed: where they begin and what they hit.
  struct Witness {
    CellId cell = none_id;
    ObjectId object = none_id;
    glm::dvec3 from{0.0}, to{0.0};
  };
  std::vector<Witness> witnesses;
};

/// Traces and judges the cells of one scene as it is built.
class RegionJudge {
 public:
  /// The scene outlives the judge. Throws InputError for settings out of range or a processor
  /// without AVX.
  RegionJudge(const Scene& scene, const RegionSettings& settings);
  ~RegionJudge();
  RegionJudge(const RegionJudge&) = delete;
  RegionJudge& operator=(const RegionJudge&) = delete;

  /// The rays of a cell depend on the seed and the cell only.
  std::vector<CellTruth> trace(std::span<const CellId> cells);

  /// `set_of` gives the set of a cell, ascending. Rays of cells whose set misses an object are
  /// traced once more.
  RegionVerdict judge(std::span<const CellTruth> truth,
                      const std::function<std::vector<ObjectId>(CellId)>& set_of);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The cells that a viewer may be in: in a Quake III world those that portals join with a place
/// where players stand; all cells of other scenes. Ascending. More than a player's eye gets to:
/// what is high above floors is open as well. From there one may see through solid leaves that are
/// not drawn, which neither portals nor a map's own sets allow for; the judge leaves rays that do
/// so out, as strays, images do not.
std::vector<CellId> reachable_cells(const Scene& scene);

/// The set of a cell, ascending; none if the culler knows of no sets.
std::optional<std::vector<ObjectId>> region_set(ICuller& culler, CellId cell, const Scene& scene);

}  // namespace vislab
