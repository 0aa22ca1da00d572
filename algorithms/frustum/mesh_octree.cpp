// frustum.mesh_octree: draws only the part of an object that is in the view frustum, found by an
// octree over the triangles of its mesh.
//
// Idea: objects outside of a plane are left out and objects inside of all are kept whole. Of those
//   that straddle the frustum only the leaves of the mesh's octree that are not outside are drawn.
//   The planes that cut the object are taken into the mesh's frame; planes that a node is inside of
//   are not tested again below it.
// Guarantee: conservative; boxes and nodes go only if they are behind a plane by more than the
// error
//   of the distance.
// Cost: O(candidates + nodes of straddling objects that the planes cut + ranges emitted). Memory:
// 40
//   bytes a node and 8 bytes a run of triangles, once a mesh; instances share it.
// Limits: the thesis found it slower than drawing the mesh whole and dropped it. Triangles of a
// leaf
//   are rarely consecutive in the mesh, so a straddling object becomes many short ranges.
// Source: Kowalka 2016, 3.3.2, 6.2.

#include <algorithm>

#include "algorithms/frustum/frustum_tester.h"
#include "algorithms/frustum/mesh_planes.h"
#include "algorithms/frustum/triangle_octree.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace frustum_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "frustum.mesh_octree";
  info.family = "frustum";
  info.summary =
      "Leaves out objects outside of the view frustum, and of those that straddle it the triangles "
      "in leaves of the mesh's octree that are outside.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = {
      ParameterSpec::integer("depth", 6, 0, 12, "", ParameterSpec::Stage::build,
                             "how often cells are halved at most; deeper leaves less outside but "
                             "makes more and shorter ranges"),
      ParameterSpec::integer("leaf_size", 128, 1, 1000000, "triangles", ParameterSpec::Stage::build,
                             "cells with no more triangles are not halved; smaller leaves less "
                             "outside but makes more and shorter ranges")};
  info.cost = "O(candidates + nodes of straddling objects that a plane cuts + ranges emitted)";
  info.limits =
      "Many short ranges for objects that straddle the frustum; nothing is gained for scenes of "
      "many small objects.";
  info.sources = {"Kowalka 2016 (thesis, HAW Hamburg), 3.3.2 and 6.2"};
  return info;
}

class MeshOctree : public ICuller {
 public:
  MeshOctree(int depth, std::size_t leaf_size) : depth_(depth), leaf_size_(leaf_size) {}

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    trees_.clear();
    for (const Mesh& mesh : scene.meshes) trees_.emplace_back(mesh, depth_, leaf_size_);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    tester_.start(frame);
    ObjectId object = none_id;
    Side side = Side::inside;
    for_each_range(candidates, frame, *scene_, [&](const TriangleRange& offered) {
      if (offered.object != object) {
        object = offered.object;
        side = look_at(object, frame);
      }
      if (side == Side::inside) kept_.push_back(offered);
      if (side == Side::intersecting) keep_part(offered);
    });
    out.ranges(kept_);
  }

  std::size_t bytes() const override {
    std::size_t bytes = stack_.capacity() * sizeof(Item) +
                        runs_.capacity() * sizeof(TriangleOctree::Run) +
                        kept_.capacity() * sizeof(TriangleRange) + tester_.bytes();
    for (const TriangleOctree& tree : trees_) bytes += sizeof tree + tree.bytes();
    return bytes;
  }
  Counters counters() const override {
    return {{"plane_tests", tester_.plane_tests() + plane_tests_},
            {"objects_tested", objects_tested_},
            {"objects_cut", objects_cut_},
            {"nodes_visited", nodes_visited_}};
  }

 private:
  struct Item {
    std::uint32_t node;
    unsigned planes;  // bit i: plane i of planes_ still cuts it
  };

  /// Where an object lies; if it straddles the frustum, runs_ are the triangles to be drawn.
  Side look_at(ObjectId object, const Frame& frame) {
    ++objects_tested_;
    const Aabb& box = frame.objects.bounds[object];
    PlaneMask mask = tester_.all_planes();
    const Side side = tester_.side(box, 0, mask);
    if (side != Side::intersecting || !box.valid()) {
      return side == Side::outside ? side : Side::inside;
    }
    ++objects_cut_;
    const TriangleOctree& tree = trees_[scene_->objects[object].mesh];
    planes_.set(tester_.frustum(), mask, frame.objects.transforms[object],
                scene_->mesh_of(object).bounds);
    collect(tree);
    return Side::intersecting;
  }

  /// Fills runs_ with the triangles of leaves that are not outside, ascending and merged.
  void collect(const TriangleOctree& tree) {
    runs_.clear();
    stack_.push_back({0, (1U << planes_.span().size()) - 1U});
    while (!stack_.empty()) {
      auto [index, planes] = stack_.back();
      stack_.pop_back();
      ++nodes_visited_;
      const TriangleOctree::Node& node = tree.nodes()[index];
      if (outside(node.box, planes)) continue;
      if (planes == 0 || node.child_count == 0) {
        const auto runs = tree.runs_below(node);
        runs_.insert(runs_.end(), runs.begin(), runs.end());
        continue;
      }
      for (std::uint32_t child = node.child_count; child-- > 0;) {
        stack_.push_back({node.first_child + child, planes});
      }
    }
    std::ranges::sort(runs_, {}, &TriangleOctree::Run::first);
    std::size_t last = 0;
    for (std::size_t i = 1; i < runs_.size(); ++i) {
      if (runs_[last].first + runs_[last].count == runs_[i].first) {
        runs_[last].count += runs_[i].count;
      } else {
        runs_[++last] = runs_[i];
      }
    }
    if (!runs_.empty()) runs_.resize(last + 1);
  }

  /// Tests the planes whose bits are set; on return those that the box is not inside of.
  bool outside(const Aabb& box, unsigned& planes) {
    const glm::dvec3 center = box.center();
    const glm::dvec3 half = box.half_size();
    for (std::size_t i = 0; i < planes_.span().size(); ++i) {
      if ((planes >> i & 1U) == 0) continue;
      ++plane_tests_;
      const MeshPlane& plane = planes_.span()[i];
      const double distance = glm::dot(plane.normal, center) + plane.d;
      const double reach = glm::dot(glm::abs(plane.normal), half);
      if (distance + reach < -plane.error) return true;
      if (distance - reach > plane.error) planes &= ~(1U << i);
    }
    return false;
  }

  void keep_part(const TriangleRange& offered) {
    const std::uint32_t end = offered.first + offered.count;
    // The first run that ends after the offer begins.
    auto run = std::ranges::partition_point(
        runs_, [&](const TriangleOctree::Run& r) { return r.first + r.count <= offered.first; });
    for (; run != runs_.end() && run->first < end; ++run) {
      const std::uint32_t first = std::max(run->first, offered.first);
      const std::uint32_t last = std::min(run->first + run->count, end);
      kept_.push_back({offered.object, first, last - first});
    }
  }

  CullerInfo info_ = describe();
  int depth_;
  std::size_t leaf_size_;
  const Scene* scene_ = nullptr;
  std::vector<TriangleOctree> trees_;  // by mesh
  FrustumTester tester_{Switches{}};
  MeshPlanes planes_;
  std::vector<Item> stack_;
  std::vector<TriangleOctree::Run> runs_;
  std::vector<TriangleRange> kept_;
  std::uint64_t plane_tests_ = 0;
  std::uint64_t objects_tested_ = 0;
  std::uint64_t objects_cut_ = 0;
  std::uint64_t nodes_visited_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry frustum_mesh_octree() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<MeshOctree>(
                static_cast<int>(values.integer("depth")),
                static_cast<std::size_t>(values.integer("leaf_size")));
          }};
}

}  // namespace cullers
}  // namespace vislab
