// frustum.bvh: walks a bounding-volume hierarchy with the frustum.
//
// Idea: a subtree outside of one plane is skipped, one inside of all is emitted as one span, and
//   only what the frustum's surface cuts is looked into. Two layouts: eight children a node with
//   float SIMD kernels (wide_bvh.h), or a binary tree in double with the accelerations of the
//   literature (traversal.h, frustum_tester.h).
// Guarantee: conservative. With intersecting=refine and test=vertex exactly what frustum.flat
//   keeps, in both layouts, however the tree was built and wherever objects went.
// Cost: O(nodes that the frustum's surface cuts + spans), about n^(2/3) for objects in space;
// update
//   O(movers and their ancestors). Build O(n log n), packed rebuild O(n).
// Limits: refitted nodes overlap more as objects mix. The wide layout adds up what queries lose by
//   that, and rebuilds along the Z curve when a rebuild would have been cheaper. Candidates that
//   are a list are tested one by one.
// Sources: Clark 1976; Assarsson and Moeller 2000; Kowalka 2016, 2.5.1-2.5.2; further ones in bvh.h
//   and wide_bvh.h.

#include "common/spatial/bvh.h"

#include <algorithm>
#include <optional>

#include "algorithms/frustum/structure_culler.h"
#include "common/culler/registry.h"
#include "common/spatial/wide_bvh.h"

namespace vislab {
namespace {

using frustum_culling::FrustumTester;
using frustum_culling::NodePolicy;
using frustum_culling::ObjectTestOptions;
using frustum_culling::StructureCuller;
using frustum_culling::Switches;

CullerInfo describe() {
  constexpr auto build = ParameterSpec::Stage::build;
  CullerInfo info = frustum_culling::structure_culler_info(
      "frustum.bvh", Repeatability::stateless,
      {ParameterSpec::choice(
           "build", "packed", {"packed", "top_down", "bottom_up", "incremental"}, build,
           "halves at medians (binary: of the Z curve), or the surface-area heuristic from the "
           "root down, by merging neighbours, or by inserting one after another (slow for many)"),
       ParameterSpec::choice(
           "layout", "wide", {"wide", "binary"}, build,
           "eight children a node tested at once, or two tested in double; tests other than "
           "vertex, accelerations other than masking and motion=enlarge or reinsert take binary in "
           "any case"),
       ParameterSpec::choice(
           "motion", "refit", {"refit", "enlarge", "reinsert", "rebuild"}, build,
           "when objects move, nodes are fitted to them, or only enlarged, or the objects are "
           "removed and inserted, or all is built anew; refitted wide trees are rebuilt when they "
           "have become too loose"),
       ParameterSpec::integer("leaf_size", 8, 1, 64, "objects", build,
                              "leaves have at most so many objects; wide ones never more than 8, "
                              "and packed wide ones always 8")},
      frustum_culling::node_policy_parameter());
  info.summary =
      "Walks a bounding-volume hierarchy: skips subtrees outside of a plane, emits subtrees inside "
      "as spans, and tests only what the frustum's surface cuts.";
  info.cost =
      "O(nodes that the frustum's surface cuts + spans); update O(movers and their ancestors)";
  info.limits =
      "Keeps volumes that are outside the frustum but not outside any single plane. Nodes get "
      "looser as objects mix. A list of candidates is tested one by one.";
  info.sources = {"Clark 1976, Hierarchical Geometric Models for Visible Surface Algorithms",
                  "Assarsson and Moeller 2000, Optimized View Frustum Culling Algorithms for "
                  "Bounding Boxes",
                  "Kowalka 2016 (thesis, HAW Hamburg), 2.5.1-2.5.2",
                  "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies",
                  "Wald, Benthin and Boulos 2008, Getting Rid of Packets",
                  "Lauterbach et al. 2009, Fast BVH Construction on GPUs",
                  "Bittner, Hapala and Havran 2013, Fast Insertion-Based Optimization of Bounding "
                  "Volume Hierarchies",
                  "Meister and Bittner 2018, Parallel Locally-Ordered Clustering for Bounding "
                  "Volume Hierarchy Construction"};
  return info;
}

Bvh::Limits read_limits(const ParameterValues& values) {
  Bvh::Limits limits;
  const std::string& build = values.choice("build");
  limits.build = build == "top_down"      ? Bvh::Build::top_down
                 : build == "bottom_up"   ? Bvh::Build::bottom_up
                 : build == "incremental" ? Bvh::Build::incremental
                                          : Bvh::Build::packed;
  const std::string& motion = values.choice("motion");
  limits.motion = motion == "enlarge"    ? Bvh::Motion::enlarge
                  : motion == "reinsert" ? Bvh::Motion::reinsert
                  : motion == "rebuild"  ? Bvh::Motion::rebuild
                                         : Bvh::Motion::refit;
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return limits;
}

/// When a hierarchy has become so loose that a rebuild pays: when queries have lost about as much
/// as it costs.
class Looseness {
 public:
  void forget() { lost_ = 0.0; }
  /// `blocks`: what a query has tested.
  void add_query(const WideBvh& bvh, std::uint64_t blocks) {
    const double decay = bvh.decay();
    const double surplus = decay > 1.0 ? 1.0 - 1.0 / decay : 0.0;
    lost_ += surplus * static_cast<double>(blocks) +
             static_cast<double>(bvh.apart_count()) * blocks_per_apart;
  }
  bool rebuild_pays(const WideBvh& bvh) const {
    return lost_ > static_cast<double>(bvh.object_count()) * blocks_per_rebuilt;
  }

 private:
  // In times of a test of one block, as measured: a test in double, and an object's share of a
  // rebuild along the Z curve.
  static constexpr double blocks_per_apart = 1.0;
  static constexpr double blocks_per_rebuilt = 3.0;
  double lost_ = 0.0;
};

class WideCuller : public ICuller {
 public:
  explicit WideCuller(const ParameterValues& values)
      : info_(describe()), limits_(read_limits(values)), tester_(Switches{}) {
    limits_.leaf_objects =
        std::min(limits_.leaf_objects, static_cast<std::uint32_t>(BoxBlock::width));
    query_.masking = values.boolean("masking");
    query_.keep_intersecting = frustum_culling::read_node_policy(values) == NodePolicy::keep;
    // Which objects share a leaf depends on where they were before.
    if (query_.keep_intersecting) info_.repeatability = Repeatability::path;
  }

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    build_as_loaded();
    listed_.reserve(scene.object_count());
    bvh_.reserve(selection_);
  }

  void reset(std::uint64_t) override {
    looseness_.forget();
    if (changed_) build_as_loaded();
  }

  void update(const Frame& frame, const Changes& changes) override {
    if (changes.empty()) return;
    changed_ = true;
    const std::span<const Aabb> boxes = frame.objects.bounds;
    for (const ObjectId object : changes.hidden) bvh_.set_present(object, boxes[object], false);
    for (const ObjectId object : changes.shown) bvh_.set_present(object, boxes[object], true);
    const bool moves = !changes.moved.empty();
    if (limits_.motion == Bvh::Motion::rebuild && moves) {
      rebuild(boxes);
    } else if (moves && looseness_.rebuild_pays(bvh_)) {
      bvh_.rebuild(boxes, WideBvh::Order::morton);
      looseness_.forget();
    } else {
      for (const ObjectId object : changes.moved) bvh_.move(object, boxes[object]);
      bvh_.refit();
    }
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    if (candidates.form() != Candidates::Form::everything) {
      cull_each(frame, candidates, out);
      return;
    }
    const std::uint64_t blocks_before = selection_.blocks_tested;
    bvh_.query(frustum_of(frame.camera), frame.objects.bounds, query_, selection_);
    looseness_.add_query(bvh_, selection_.blocks_tested - blocks_before);
    for (const std::span<const ObjectId> run : selection_.runs) out.objects(run);
  }

  std::size_t bytes() const override {
    return bvh_.bytes() + selection_.bytes() + listed_.capacity() * sizeof(ObjectId) +
           (tree_ ? tree_->bytes() : 0);
  }

  Counters counters() const override {
    return {{"blocks_tested", selection_.blocks_tested},
            {"plane_tests", 8 * selection_.plane_tests + tester_.plane_tests()},
            {"objects_in_double", selection_.undecided_tests + objects_listed_}};
  }

 private:
  void cull_each(const Frame& frame, const Candidates& candidates, DrawSink& out) {
    tester_.start(frame);
    listed_.clear();
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      objects_listed_ += run.size();
      for (const ObjectId object : run) {
        const Aabb& box = frame.objects.bounds[object];
        if (!tester_.outside(box, object, tester_.all_planes())) listed_.push_back(object);
      }
    });
    out.objects(listed_);
  }

  void build_as_loaded() {
    std::vector<Aabb> boxes(scene_->object_count());
    for (ObjectId object = 0; object < boxes.size(); ++object) {
      boxes[object] =
          transformed(scene_->mesh_of(object).bounds, scene_->objects[object].transform);
    }
    if (limits_.build == Bvh::Build::packed) {
      bvh_.build(boxes, WideBvh::Order::median);
    } else {
      bvh_.build(boxes, tree_over(boxes));
      // Who rebuilds finds its memory again.
      if (limits_.motion != Bvh::Motion::rebuild) tree_.reset();
    }
    looseness_.forget();
    changed_ = false;
  }

  void rebuild(std::span<const Aabb> boxes) {
    if (limits_.build == Bvh::Build::packed) {
      bvh_.rebuild(boxes, WideBvh::Order::morton);
    } else {
      bvh_.rebuild(boxes, tree_over(boxes));
    }
  }

  const Bvh& tree_over(std::span<const Aabb> boxes) {
    if (!tree_) tree_.emplace(limits_);
    tree_->build(boxes);
    return *tree_;
  }

  CullerInfo info_;
  Bvh::Limits limits_;
  WideBvh::QueryOptions query_;
  const Scene* scene_ = nullptr;
  std::optional<Bvh> tree_;  // that bvh_ is made of, unless it is packed
  WideBvh bvh_;
  WideSelection selection_;
  Looseness looseness_;
  bool changed_ = false;  // since the scene was as built
  FrustumTester tester_;  // for lists
  std::vector<ObjectId> listed_;
  std::uint64_t objects_listed_ = 0;
};

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  const Bvh::Limits limits = read_limits(values);
  const bool wide =
      values.choice("layout") == "wide" &&
      frustum_culling::read_object_test(values, false).test == ObjectTestOptions::Test::vertex &&
      frustum_culling::read_switches(values).plain() &&
      (limits.motion == Bvh::Motion::refit || limits.motion == Bvh::Motion::rebuild);
  if (wide) return std::make_unique<WideCuller>(values);
  return std::make_unique<StructureCuller<Bvh>>(describe(), limits, values);
}

}  // namespace

namespace cullers {

CullerEntry frustum_bvh() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
