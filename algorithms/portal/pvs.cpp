// portal.pvs: leaves out what cannot be seen from anywhere in the viewer's cell, by sets that are
// computed when it is built, and what lies outside the frustum.
//
// Idea: which cells are seen from anywhere in a cell is found once, by following sequences of
//   portals (pvs_flow.h); while a viewer stays in a cell, only the frustum's planes are tested.
// Guarantee: conservative but for gaps narrower than a hundredth of a millimetre. Where the near
//   plane's window reaches into several cells, their sets are united; if a part of it is in none,
//   everything in the frustum is kept.
// Cost: build: O(portals^2) and the sequences, seconds for a thousand cells, a minute for the
//   greatest Quake III worlds here. A frame: O(candidates) and at most 6 plane tests for each that
//   is in the set. Memory: the compressed sets, about a fifth of a bit for each pair of cells.
// Limits: objects hide nothing here, only walls between cells do. Objects that move are tested
//   against the frustum only. A scene without cells is culled by the frustum alone.
// Sources: Airey 1990 (potentially visible sets); Teller and Sequin 1991; Quake's vis (id Software
//   1996).

#include <algorithm>

#include "algorithms/portal/portal_graph.h"
#include "algorithms/portal/pvs_culler.h"
#include "algorithms/portal/pvs_flow.h"
#include "common/culler/registry.h"
#include "common/scene/convex_region.h"

namespace vislab {
namespace {

using namespace portal_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "portal.pvs";
  info.family = "portal";
  info.summary =
      "Keeps what lies in the frustum and in a cell that is in the viewer's cell's potentially "
      "visible set, which is computed beforehand by following lines through portals.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.cost =
      "Build: O(portals^2) and the sequences of portals that lines can cross; a frame: "
      "O(candidates), at most 6 plane tests for each that is in the set";
  info.limits =
      "Only walls between cells hide. Gaps narrower than a hundredth of a millimetre are "
      "overlooked. Objects that move and scenes without cells are culled by the frustum alone.";
  info.sources = {"Airey 1990, Increasing Update Rates in the Building Walkthrough System",
                  "Teller and Sequin 1991, Visibility Preprocessing for Interactive Walkthroughs",
                  "id Software 1996, the visibility compiler of Quake"};
  return info;
}

/// Places are cells.
class Pvs : public PvsCuller {
 public:
  Pvs() : PvsCuller(describe()) {}

 protected:
  ObjectsByPlace build_sets(const Scene& scene, const BuildContext& context) override {
    graph_.build(scene);
    table_ = {};
    ObjectsByPlace objects;
    if (scene.cells.empty()) return objects;
    table_ = find_visible_cells(graph_, {.threads = context.threads});
    std::vector<std::pair<std::uint32_t, ObjectId>> pairs;
    for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
      for (const ObjectId object : scene.cells[cell].objects) pairs.emplace_back(cell, object);
    }
    objects.assign(scene.cells.size(), std::move(pairs));
    start_.reserve(scene.cells.size());
    find_overlaps(scene);
    return objects;
  }

  bool add_seen(const Camera& camera, std::span<std::uint64_t> places) override {
    if (!graph_.start_cells(camera, start_)) return false;
    for (const CellId cell : start_) table_.cells.unite(cell, places);
    return true;
  }

  bool add_seen_from(CellId cell, std::span<std::uint64_t> places) const override {
    if (cell >= table_.cells.row_count()) return false;
    table_.cells.unite(cell, places);
    for (const auto& [one, other] : overlaps_) {
      if (one == cell) table_.cells.unite(other, places);
    }
    return true;
  }

  std::size_t bytes_of_sets() const override {
    return graph_.bytes() + table_.cells.bytes() + start_.capacity() * sizeof(CellId) +
           overlaps_.capacity() * sizeof(overlaps_[0]);
  }

  SetSizes set_sizes() const override {
    const std::size_t rows = table_.cells.row_count();
    return {rows == 0 ? 0 : table_.cells.bytes(), raw_bytes(rows)};
  }

 private:
  /// Whoever stands in two cells sees what both see. (A camera is found in both anyway.)
  void find_overlaps(const Scene& scene) {
    overlaps_.clear();
    for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
      graph_.cells_of(scene.cells[cell].bounds, start_);
      for (const CellId other : start_) {
        if (other != cell && overlap(scene.cells[cell], scene.cells[other])) {
          overlaps_.emplace_back(cell, other);
        }
      }
    }
  }

  static bool overlap(const Cell& a, const Cell& b) {
    constexpr double depth_m = 1e-4;
    return std::ranges::any_of(a.regions, [&](const ConvexRegion& one) {
      return std::ranges::any_of(b.regions, [&](const ConvexRegion& other) {
        return shared_point(one, other, depth_m).has_value();
      });
    });
  }

  PortalGraph graph_;
  PvsTable table_;
  std::vector<CellId> start_;
  std::vector<std::pair<CellId, CellId>> overlaps_;
};

}  // namespace

namespace cullers {

CullerEntry portal_pvs() {
  return {describe(), [](const ParameterValues&) { return std::make_unique<Pvs>(); }};
}

}  // namespace cullers
}  // namespace vislab
