// Cones of normals on the bumpy spheres, and on ways around smaller ones: what a test finds and
// takes, whole cullers, building and memory, and how many nodes of a hierarchy are tested again
// from frame to frame.
#include <cmath>
#include <numbers>

#include "algorithms/backface/cluster_cones.h"
#include "algorithms/backface/cluster_runs.h"
#include "common/scene/generators/generators.h"
#include "experiments/bench/backface/cases.h"
#include "experiments/bench/backface/costs.h"
#include "experiments/bench/backface/world_contests.h"

namespace vislab {
namespace {

using namespace backface_culling;

/// What backface.cone makes of clusters of one size.
class ConeTests : public TestsContest {
 public:
  ConeTests(const std::string& world, Shown shown, Meshlets::Form form,
            const ClusterSettings& clusters)
      : TestsContest(world, shown, form),
        partition_(make_clusters(world_->mesh(), frame_, clusters)),
        runs_(partition_),
        cones_(cones_of(world_->mesh(), frame_, partition_, ConeForm::apex)) {
    clusters_.resize(words_of(cones_.count()));
  }

 protected:
  void find(const MeshEye& eye) override {
    mark_cones(cones_, ConeEye(eye, cones_.unit()), clusters_.data());
  }
  void mark(std::vector<std::uint64_t>& bits) override { runs_.set(clusters_, bits); }

 private:
  TriangleClusters partition_;
  ClusterRuns runs_;
  ClusterCones cones_;
};

/// Cones that are all read for every eye are tested soonest if a cache holds them: those of a
/// million triangles in clusters of the default size do not fit into a megabyte or two, and take
/// longer to read than to test. Tests alone favour this size; frames that are drawn the default.
constexpr std::uint32_t cache_size = 32;
constexpr const char* cache_sized = "backface.cone[size=32]";

/// A sphere with low bumps, and a camera that goes around it at distance 3 by some degrees a frame:
/// once, and in whole steps.
class Orbit {
 public:
  Orbit(std::uint32_t subdivisions, double degrees)
      : scene_(make_bumpy_sphere({subdivisions, Bumps::low, 0.0, glm::dvec3(0.0)})) {
    scene_.finish();
    state_ = std::make_unique<SceneState>(scene_);
    frames_ = degrees > 0.0 ? static_cast<std::size_t>(360.0 / degrees) : 1;
    turn_ = 2.0 * std::numbers::pi / static_cast<double>(frames_);
  }

  const Scene& scene() const { return scene_; }
  std::size_t frames() const { return frames_; }
  Frame frame(std::uint64_t index) const {
    const double angle = turn_ * static_cast<double>(index % frames_);
    const glm::dvec3 eye(3.0 * std::sin(angle), 0.5, 3.0 * std::cos(angle));
    const Camera camera{look_at(eye, glm::dvec3(0.0)),
                        perspective_lens(std::numbers::pi / 3.0, 1.0, 0.1, 10.0)};
    return {index, camera, Viewport{512, 512}, state_->view(), 0.0};
  }

 private:
  Scene scene_;
  std::unique_ptr<SceneState> state_;
  std::size_t frames_ = 1;
  double turn_ = 0.0;
};

/// Two cullers on the way, some frames a call. The figure is the share of all triangles that ours
/// leaves out. Equal as long as it leaves out nothing that the other keeps.
class OrbitContest : public Contest {
 public:
  OrbitContest(std::uint32_t subdivisions, double degrees, const std::string& ours,
               const std::string& theirs)
      : orbit_(subdivisions, degrees),
        ours_{TriangleSide(ours, orbit_.scene())},
        theirs_{TriangleSide(theirs, orbit_.scene())} {}

  void ours() override { go(ours_); }
  void theirs() override { go(theirs_); }
  bool equal() override {
    std::uint64_t left_out = 0;
    std::uint64_t wrong = 0;
    const std::size_t steps = std::min<std::size_t>(orbit_.frames(), 90);
    for (std::size_t step = 0; step < steps; ++step) {
      const Frame frame = orbit_.frame(step);
      ours_.side.cull(frame);
      theirs_.side.cull(frame);
      const std::vector<std::uint64_t> a = ours_.side.left_out();
      const std::vector<std::uint64_t> b = theirs_.side.left_out();
      for (std::size_t word = 0; word < a.size(); ++word) {
        left_out += static_cast<std::uint64_t>(std::popcount(a[word]));
        wrong += static_cast<std::uint64_t>(std::popcount(a[word] & ~b[word]));
      }
    }
    share_ = static_cast<double>(left_out) /
             static_cast<double>(steps * orbit_.scene().triangle_count());
    ours_.next = theirs_.next = steps;
    return wrong == 0;
  }
  double figure() const override { return share_; }

 private:
  struct Side {
    TriangleSide side;
    std::uint64_t next = 0;
  };
  void go(Side& side) {
    constexpr int frames_a_call = 60;
    for (int i = 0; i < frames_a_call; ++i) side.side.cull(orbit_.frame(side.next++));
  }

  Orbit orbit_;
  Side ours_, theirs_;
  double share_ = 0.0;
};

/// Nodes that backface.hierarchical tests in a frame of a second round.
Measurement nodes_a_frame(const std::string& spec, double degrees) {
  const Orbit orbit(64, degrees);
  TriangleSide side(spec, orbit.scene());
  const auto tested = [&] {
    for (const auto& [name, count] : side.culler().counters()) {
      if (name == "nodes_tested") return count;
    }
    throw std::logic_error(spec + " does not count its nodes");
  };
  std::uint64_t before = 0;
  for (int round = 0; round < 2; ++round) {
    before = tested();
    for (std::size_t i = 0; i < orbit.frames(); ++i) side.cull(orbit.frame(i));
  }
  return {static_cast<double>(tested() - before) / static_cast<double>(orbit.frames()), true};
}

}  // namespace

void add_cone_cases(std::vector<BenchCase>& cases) {
  const std::string peer = "meshoptimizer's cones";
  for (const std::string world : {"sphere", "low", "high"}) {
    // The world is kept from the first case that needs it to the last.
    const auto kept = std::make_shared<std::shared_ptr<const FacingWorld>>();
    const std::pair<const char*, ClusterSettings> sizes[] = {
        {"backface.cone", cone_clusters()}, {cache_sized, cone_clusters(cache_size)}};
    for (const auto& [bench, clusters] : sizes) {
      cases.push_back({bench, world, "share", peer, [=, clusters = clusters] {
                         *kept = FacingWorld::of(world);
                         return std::make_unique<ConeTests>(world, Shown::share,
                                                            Meshlets::Form::loop, clusters);
                       }});
      if (bench == cache_sized) cases.back().bar = Bar::at_most(1.0);
      for (const Meshlets::Form form : {Meshlets::Form::loop, Meshlets::Form::rows}) {
        cases.push_back({bench, world + name_of_tests(form), "us", peer + name_of(form),
                         [=, clusters = clusters] {
                           return std::make_unique<ConeTests>(world, Shown::speed, form, clusters);
                         }});
      }
    }
    const auto to_ranges = [&](const std::string& ours, const std::string& theirs, bool last) {
      cases.push_back({ours, world + ", to ranges", "share", theirs, [=] {
                         auto contest = std::make_unique<CullersContest>(world, ours, theirs);
                         if (last) kept->reset();
                         return contest;
                       }});
    };
    to_ranges("backface.cone", "peer.meshopt_cones", false);
    to_ranges("backface.cone", "backface.polygon", false);
    to_ranges("backface.cone[form=sphere]", "backface.cone", false);
    to_ranges("backface.cone > backface.polygon", "backface.polygon", false);
    to_ranges("backface.hierarchical", "backface.cone", true);
    add_costs(cases, "backface.cone", world);
    add_costs(cases, "backface.hierarchical", world);
  }
  const std::string coherent = "backface.hierarchical";
  const std::string forgetful = "backface.hierarchical[coherence=off]";
  for (const char* degrees : {"0", "0.1", "1", "10"}) {
    const double step = std::stod(degrees);
    const std::string way = std::string("49,152 triangles, ") + degrees + " degrees a frame";
    for (const std::string& spec : {coherent, forgetful}) {
      cases.push_back({spec, way + ", nodes tested", "nodes a frame", "", nullptr,
                       [=] { return nodes_a_frame(spec, step); }});
    }
    // Kumar et al. 1996: 30 to 55 % of the polygons in 5 to 10 % of the processor's time.
    for (const std::string& theirs : {forgetful, std::string("backface.polygon")}) {
      cases.push_back({coherent, way, "share of all", theirs,
                       [=] { return std::make_unique<OrbitContest>(64, step, coherent, theirs); }});
    }
  }
}

}  // namespace vislab
