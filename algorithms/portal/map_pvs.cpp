// portal.map_pvs: leaves out what a Quake III world's own potentially visible set says is not seen
// from the viewer's cluster, and what lies outside the frustum.
//
// Idea: the compiler of the world found, for each cluster of leaves, which others can be seen from
//   anywhere in it. An object lies in all leaves that its triangles reach into, and is kept if any
//   of them is in a cluster that the viewer's sees.
// Guarantee: conservative from positions that a player can reach, as far as the map's compiler was:
//   it drops gaps narrower than its tolerance (0.1 unit, 3 mm, in the common ones). The rays of an
//   image begin in the near plane's window, so the sets of all clusters that it reaches into are
//   united. Where any of it is in no cluster, as in a wall, everything in the frustum is kept; from
//   a void outside of the world that has a cluster nothing is promised.
// Cost: O(candidates) and at most 6 plane tests for each that is in the set; the window goes down
//   the tree in each frame, and objects are marked anew when what it finds changes.
// Limits: for Quake III worlds only; other scenes are culled by the frustum alone, a world without
//   visibility data is refused. Objects that move, doors among them, are tested against the frustum
//   only. Orthographic cameras, whose rays begin far apart, keep everything in the frustum.
// Sources: id Software, Quake III Arena (the set's format and use); Teller and Sequin 1991.

#include <algorithm>
#include <string>

#include "algorithms/portal/pvs_culler.h"
#include "algorithms/portal/window_cover.h"
#include "common/culler/registry.h"
#include "common/scene/error.h"
#include "common/scene/quake_world.h"

namespace vislab {
namespace {

using portal_culling::ObjectsByPlace;
using portal_culling::PvsCuller;
using portal_culling::WindowLine;
using portal_culling::WindowPiece;

/// A ray that begins this near to a plane of the tree begins on both sides: rounding.
constexpr double window_slack_m = 1e-6;

CullerInfo describe() {
  CullerInfo info;
  info.name = "portal.map_pvs";
  info.family = "portal";
  info.summary =
      "Keeps what lies in the frustum and in a leaf that a Quake III world's own potentially "
      "visible set says can be seen from the viewer's clusters.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.cost =
      "O(candidates), at most 6 plane tests for each that is in the set; the planes of the world's "
      "tree that cut the near plane's window; objects are marked anew only when the viewer's "
      "clusters change";
  info.limits =
      "Conservative from positions that a player can reach only, and up to the tolerance of the "
      "compiler of the map (mostly 3 mm). Scenes that are no Quake III worlds are culled by the "
      "frustum alone, and so are objects that move and orthographic cameras; worlds without "
      "visibility data are refused.";
  info.sources = {"id Software, Quake III Arena: visibility data of IBSP files",
                  "Teller and Sequin 1991, Visibility Preprocessing for Interactive Walkthroughs"};
  return info;
}

/// Places are clusters.
class MapPvs : public PvsCuller {
 public:
  MapPvs() : PvsCuller(describe()) {}

 protected:
  ObjectsByPlace build_sets(const Scene& scene, const BuildContext&) override {
    world_ = scene.quake.get();
    ObjectsByPlace objects;
    clusters_of_cell_.assign(scene.cells.size(), {});
    if (world_ == nullptr) return objects;
    if (world_->visible.empty()) {
      throw InputError(scene.name +
                       " holds no visibility data, so portal.map_pvs has no set to look into; use "
                       "portal.pvs, which computes one");
    }
    if (const std::string doubt = world_->doubt_about_sets(); !doubt.empty()) {
      throw InputError(scene.name + " " + doubt +
                       ", so portal.map_pvs cannot follow them; use portal.pvs, which computes its "
                       "own");
    }
    std::vector<std::pair<std::uint32_t, ObjectId>> pairs;
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      for (const std::uint32_t leaf : world_->leaves_of_object(object)) {
        const std::int32_t cluster = world_->leaves[leaf].cluster;
        if (cluster >= 0) pairs.emplace_back(static_cast<std::uint32_t>(cluster), object);
      }
    }
    objects.assign(world_->cluster_count, std::move(pairs));
    waiting_.reserve(128);  // deeper trees than game worlds have make it grow once
    for (std::size_t leaf = 0; leaf < world_->cell_of_leaf.size(); ++leaf) {
      const CellId cell = world_->cell_of_leaf[leaf];
      if (cell != none_id) clusters_of_cell_[cell].push_back(world_->leaves[leaf].cluster);
    }
    return objects;
  }

  bool add_seen(const Camera& camera, std::span<std::uint64_t> places) override {
    if (world_ == nullptr || camera.lens.projection == Projection::orthographic) return false;
    const Lens& lens = camera.lens;
    const glm::dvec3 middle = camera.pose.eye - camera.pose.back * lens.near_m;
    waiting_.clear();
    waiting_.push_back({0,
                        {{{{lens.left, lens.bottom},
                           {lens.right, lens.bottom},
                           {lens.right, lens.top},
                           {lens.left, lens.top}}},
                         4}});
    while (!waiting_.empty()) {
      Waiting here = waiting_.back();
      waiting_.pop_back();
      if (here.node < 0) {
        const std::int32_t cluster =
            world_->leaves[static_cast<std::size_t>(-(here.node + 1))].cluster;
        if (cluster < 0) return false;
        add_row(cluster, places);
        continue;
      }
      const QuakeNode& node = world_->nodes[static_cast<std::size_t>(here.node)];
      const Plane& plane = world_->planes[node.plane];
      const WindowLine line{glm::dot(plane.normal, camera.pose.right),
                            glm::dot(plane.normal, camera.pose.up), plane.signed_distance(middle)};
      const WindowLine behind{-line.right, -line.up, -line.offset};
      Waiting back{node.back, here.piece};
      if (back.piece.cut(behind.moved(window_slack_m))) waiting_.push_back(back);
      here.node = node.front;
      if (here.piece.cut(line.moved(window_slack_m))) waiting_.push_back(here);
    }
    return true;
  }

  bool add_seen_from(CellId cell, std::span<std::uint64_t> places) const override {
    if (cell >= clusters_of_cell_.size() || clusters_of_cell_[cell].empty()) return false;
    for (const std::int32_t cluster : clusters_of_cell_[cell]) add_row(cluster, places);
    return true;
  }

  std::size_t bytes_of_sets() const override {
    // The map's own rows lie in the scene, but are the sets, and serve no other method.
    std::size_t total = set_sizes().stored + waiting_.capacity() * sizeof(Waiting);
    for (const auto& clusters : clusters_of_cell_) {
      total += sizeof(clusters) + clusters.capacity() * sizeof(std::int32_t);
    }
    return total;
  }

  SetSizes set_sizes() const override {
    if (world_ == nullptr) return {};
    return {world_->visible.size(), raw_bytes(world_->cluster_count)};
  }

 private:
  /// What of the near plane's window comes to a node, or to leaf -(node + 1).
  struct Waiting {
    std::int32_t node;
    WindowPiece piece;
  };

  void add_row(std::int32_t cluster, std::span<std::uint64_t> places) const {
    const std::uint8_t* row =
        world_->visible.data() + static_cast<std::size_t>(cluster) * world_->bytes_per_cluster;
    const std::size_t count = world_->cluster_count;
    for (std::size_t i = 0; i < (count + 7) / 8; ++i) {
      // A row's last byte may have bits for clusters that there are not.
      const unsigned known = count - 8 * i < 8 ? (1U << (count - 8 * i)) - 1U : 0xFFU;
      places[i / 8] |= std::uint64_t{row[i] & known} << (8 * (i % 8));
    }
  }

  const QuakeWorld* world_ = nullptr;  // null: the scene is none
  std::vector<std::vector<std::int32_t>> clusters_of_cell_;
  std::vector<Waiting> waiting_;
};

}  // namespace

namespace cullers {

CullerEntry portal_map_pvs() {
  return {describe(), [](const ParameterValues&) { return std::make_unique<MapPvs>(); }};
}

}  // namespace cullers
}  // namespace vislab
