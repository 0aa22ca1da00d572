// frustum.two_step: first the leaves of an octree that touch the frustum, then only their objects.
//
// Idea: step 1 extracts the leaf cubes of an octree over the scene that the frustum touches: all
//   leaves are tested (nodes=leaves, which the thesis found to be faster), or found through the
//   inner nodes above them (nodes=inner). Step 2 tests the objects in these leaves, each once,
//   whether its leaf is inside or cut.
// Guarantee: conservative. What is kept is a subset of what frustum.flat with the same test keeps:
// an
//   object all of whose leaves are outside is left out, even if it is outside of no single plane
//   (the special case of the same-plane test, of which the thesis says that this reduces it).
// Cost: O(leaves), or O(nodes that the frustum touches), + O(entries in touched leaves). A change
// of
//   the scene costs O(nodes), to list the leaves again.
// Limits: as frustum.octree; objects in leaves inside of the frustum are tested as well, and with
//   nodes=leaves the first step grows with the scene.
// Sources: Kowalka 2016 (thesis, HAW Hamburg), 3.3.1, 4.1-4.3.

#include "algorithms/frustum/structure_culler.h"
#include "common/culler/registry.h"
#include "common/spatial/leaf_octree.h"

namespace vislab {
namespace {

using frustum_culling::FrustumTester;
using frustum_culling::ObjectTester;
using frustum_culling::PlaneMask;

CullerInfo describe() {
  constexpr auto build = ParameterSpec::Stage::build;
  CullerInfo info = frustum_culling::structure_culler_info(
      "frustum.two_step", Repeatability::path,
      {ParameterSpec::choice("nodes", "leaves", {"leaves", "inner"}, ParameterSpec::Stage::query,
                             "step 1 tests all leaves, or descends through the inner nodes"),
       ParameterSpec::integer(
           "depth", 3, 0, 16, "levels", build,
           "how often cells are halved at most; too small leaves many objects to "
           "test, too great makes many leaves and entries"),
       ParameterSpec::integer("leaf_size", 64, 1, 1'000'000, "objects", build,
                              "a leaf with so many objects is not halved")},
      frustum_culling::object_intersecting_parameter());
  info.summary =
      "Finds the leaves of an octree that touch the frustum, then tests only the objects in them.";
  info.cost = "O(leaves), or O(nodes that the frustum touches); and O(entries in touched leaves)";
  info.limits =
      "Tests objects even where their leaf is inside; with nodes=leaves step 1 grows with the "
      "scene. "
      "Large objects are in many leaves; moving objects are costly.";
  info.sources = {"Kowalka 2016 (thesis, HAW Hamburg), 3.3.1 and 4.1-4.3"};
  return info;
}

class TwoStep : public ICuller {
 public:
  TwoStep(const LeafOctree::Limits& limits, const ParameterValues& values)
      : info_(describe()),
        all_leaves_(values.choice("nodes") == "leaves"),
        followed_(limits),
        tester_(frustum_culling::read_switches(values)),
        objects_(frustum_culling::read_object_test(values, true)) {}

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    object_count_ = scene.object_count();
    followed_.build(scene);
    objects_.build(scene);
    stamps_.resize(object_count_);
    kept_.reserve(object_count_);
    tester_.resize(object_count_ + followed_.structure().nodes().size());
    list_leaves();
  }

  void reset(std::uint64_t) override {
    if (followed_.reset()) list_leaves();
    objects_.reset();
    tester_.forget();
  }

  void update(const Frame& frame, const Changes& changes) override {
    objects_.update(frame, changes);
    if (!followed_.update(frame, changes)) return;
    list_leaves();
    for (const ObjectId object : changes.moved) tester_.forget(object);
    tester_.forget_motion();
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const LeafOctree& octree = followed_.structure();
    tester_.resize(object_count_ + octree.nodes().size());
    tester_.start(frame);
    objects_.start(frame);
    kept_.clear();
    if (candidates.form() != Candidates::Form::everything) {
      for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
        for (const ObjectId object : run) test(object, frame);
      });
    } else {
      stamps_.clear();
      for (const ObjectId object : octree.unplaced()) test(object, frame);
      all_leaves_ ? through_leaves(frame) : through_inner_nodes(frame);
    }
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return followed_.bytes() + tester_.bytes() + objects_.bytes() + stamps_.bytes() +
           (leaves_.capacity() + kept_.capacity()) * sizeof(std::uint32_t) +
           stack_.capacity() * sizeof(Item);
  }

  Counters counters() const override {
    Counters counters{{"nodes_visited", nodes_visited_},
                      {"leaves_touched", leaves_touched_},
                      {"objects_tested", objects_tested_}};
    objects_.append_counters(tester_, counters);
    return counters;
  }

 private:
  struct Item {
    LeafOctree::NodeIndex node;
    PlaneMask mask;  // planes that the parent is not inside of
  };

  /// The leaves that hold objects, in depth-first order.
  void list_leaves() {
    const std::span<const SpatialNode> nodes = followed_.structure().nodes();
    leaves_.clear();
    stack_.assign(1, {LeafOctree::root, 0});
    while (!stack_.empty()) {
      const LeafOctree::NodeIndex index = stack_.back().node;
      stack_.pop_back();
      if (nodes[index].box.empty()) continue;
      if (nodes[index].child_count == 0) leaves_.push_back(index);
      push_children(nodes[index], 0);
    }
  }

  void through_leaves(const Frame& frame) {
    const std::span<const SpatialNode> nodes = followed_.structure().nodes();
    for (const LeafOctree::NodeIndex leaf : leaves_) {
      PlaneMask mask = tester_.all_planes();
      if (!outside(nodes[leaf], leaf, mask)) test_leaf(leaf, frame);
    }
  }

  void through_inner_nodes(const Frame& frame) {
    const std::span<const SpatialNode> nodes = followed_.structure().nodes();
    stack_.push_back({LeafOctree::root, tester_.all_planes()});
    while (!stack_.empty()) {
      auto [index, mask] = stack_.back();
      stack_.pop_back();
      if (nodes[index].box.empty() || outside(nodes[index], index, mask)) continue;
      if (nodes[index].child_count == 0) test_leaf(index, frame);
      push_children(nodes[index], mask);
    }
  }

  void push_children(const SpatialNode& node, PlaneMask mask) {
    for (std::uint32_t child = node.child_count; child-- > 0;) {
      stack_.push_back({node.first_child + child, mask});
    }
  }

  bool outside(const SpatialNode& node, LeafOctree::NodeIndex index, PlaneMask& mask) {
    ++nodes_visited_;
    const auto slot = static_cast<std::uint32_t>(object_count_ + index);
    return tester_.side(node.box, slot, mask) == Side::outside;
  }

  void test_leaf(LeafOctree::NodeIndex leaf, const Frame& frame) {
    ++leaves_touched_;
    for (const ObjectId object : followed_.structure().objects_at(leaf)) {
      if (stamps_.insert(object)) test(object, frame);
    }
  }

  void test(ObjectId object, const Frame& frame) {
    ++objects_tested_;
    if (objects_.keeps(object, frame, tester_, object, tester_.all_planes())) {
      kept_.push_back(object);
    }
  }

  CullerInfo info_;
  bool all_leaves_;
  FollowedStructure<LeafOctree> followed_;
  FrustumTester tester_;
  ObjectTester objects_;
  std::size_t object_count_ = 0;
  std::vector<LeafOctree::NodeIndex> leaves_;
  std::vector<Item> stack_;
  ObjectStamps stamps_;  // objects that were met in this call
  std::vector<ObjectId> kept_;
  std::uint64_t nodes_visited_ = 0;
  std::uint64_t leaves_touched_ = 0;
  std::uint64_t objects_tested_ = 0;
};

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  LeafOctree::Limits limits;
  limits.depth = static_cast<int>(values.integer("depth"));
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return std::make_unique<TwoStep>(limits, values);
}

}  // namespace

namespace cullers {

CullerEntry frustum_two_step() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
