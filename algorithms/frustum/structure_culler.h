// What the cullers over octrees and partitions share: a culler that walks a structure that follows
// the scene.
#pragma once

#include <utility>
#include <vector>

#include "algorithms/frustum/traversal.h"
#include "common/spatial/followed_structure.h"

namespace vislab::frustum_culling {

/// Whether a node is outside or inside only if each object in it has that answer by itself: then
/// answers do not show which objects share nodes. Spheres and oriented boxes may reach out of a
/// node that is outside, and corners and meta volumes have other margins than the tests they would
/// have to agree with.
inline bool nodes_answer_as_objects(const ObjectTestOptions& objects, const Switches& switches) {
  if (objects.test == ObjectTestOptions::Test::vertex) return true;
  return objects.test == ObjectTestOptions::Test::exact && switches.meta == Switches::Meta::off;
}

/// A culler that walks a structure from its root (traversal.h).
template <typename Structure>
class StructureCuller : public ICuller {
 public:
  /// `values`: those of object_test_parameters, node_policy_parameter and switch_parameters are
  /// read.
  StructureCuller(CullerInfo info, const typename Structure::Limits& limits,
                  const ParameterValues& values)
      : info_(std::move(info)),
        followed_(limits),
        tester_(read_switches(values)),
        objects_(read_object_test(values, false)),
        traversal_(read_node_policy(values)) {
    // Which objects share nodes depends on where they were before.
    const bool structure_shows =
        read_node_policy(values) == NodePolicy::keep || followed_.structure().repeats_objects() ||
        !nodes_answer_as_objects(read_object_test(values, false), tester_.switches());
    info_.repeatability =
        structure_shows ? Repeatability::path : tester_.switches().repeatability();
  }

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    followed_.build(scene);
    objects_.build(scene);
    traversal_.build(scene.object_count(), followed_.structure().repeats_objects());
    tester_.resize(scene.object_count() + followed_.structure().nodes().size());
  }

  void reset(std::uint64_t) override {
    followed_.reset();
    objects_.reset();
    tester_.forget();
  }

  void update(const Frame& frame, const Changes& changes) override {
    objects_.update(frame, changes);
    if (!followed_.update(frame, changes)) return;
    for (const ObjectId object : changes.moved) tester_.forget(object);
    tester_.forget_motion();
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    if (candidates.form() != Candidates::Form::everything) {
      traversal_.cull_each(candidates, tester_, objects_, frame, out);
      return;
    }
    const Structure& structure = followed_.structure();
    objects_in_root_ += structure.objects_at(Structure::root).size();
    objects_unplaced_ += structure.unplaced().size();
    traversal_.cull(structure, tester_, objects_, frame, out);
  }

  std::size_t bytes() const override {
    return followed_.bytes() + tester_.bytes() + objects_.bytes() + traversal_.bytes();
  }

  Counters counters() const override {
    Counters counters{{"nodes_visited", traversal_.nodes_visited()},
                      {"objects_tested", traversal_.objects_tested()},
                      {"objects_in_root", objects_in_root_},
                      {"objects_unplaced", objects_unplaced_}};
    objects_.append_counters(tester_, counters);
    return counters;
  }

 private:
  CullerInfo info_;
  FollowedStructure<Structure> followed_;
  FrustumTester tester_;
  ObjectTester objects_;
  Traversal traversal_;
  std::uint64_t objects_in_root_ = 0;
  std::uint64_t objects_unplaced_ = 0;
};

/// The parts of the declaration that all of them have in common. `own`: the structure's parameters.
/// Repeatability, by default: path if the answers show the structure (objects that are repeated),
/// which depends on where objects were before. Other tests of objects can show it too.
inline CullerInfo structure_culler_info(std::string name, Repeatability repeatability,
                                        std::vector<ParameterSpec> own,
                                        ParameterSpec intersecting) {
  CullerInfo info;
  info.name = std::move(name);
  info.family = "frustum";
  info.guarantee = Guarantee::conservative;
  info.repeatability = repeatability;
  info.granularity = Granularity::object;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = std::move(own);
  info.parameters.push_back(std::move(intersecting));
  for (ParameterSpec& spec : object_test_parameters()) info.parameters.push_back(std::move(spec));
  for (ParameterSpec& spec : switch_parameters()) info.parameters.push_back(std::move(spec));
  return info;
}

}  // namespace vislab::frustum_culling
