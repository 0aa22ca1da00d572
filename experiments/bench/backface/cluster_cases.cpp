// Clusters on the bumpy spheres: what their tests find and take, whole cullers and chains, and what
// building costs.
#include <algorithm>
#include <chrono>
#include <type_traits>

#include "algorithms/backface/cluster_parameters.h"
#include "algorithms/backface/cluster_tree_data.h"
#include "algorithms/backface/flat_clusters.h"
#include "experiments/bench/backface/cases.h"
#include "experiments/bench/backface/meshlets.h"
#include "experiments/bench/backface/world_contests.h"

namespace vislab {
namespace {

using namespace backface_culling;

/// What backface.cluster and backface.cluster_tree have without parameters.
template <typename Clusters>
ClusterSettings default_settings() {
  constexpr bool is_tree = std::is_same_v<Clusters, ClusterTree>;
  const auto specs = cluster_parameters(is_tree ? tree_cluster_size : flat_cluster_size);
  return cluster_settings(ParameterValues("bench", specs, {}), {});
}

class TreeTests : public TestsContest {
 public:
  TreeTests(const std::string& world, Shown shown, Meshlets::Form form)
      : TestsContest(world, shown, form),
        tree_(world_->mesh(), frame_, default_settings<ClusterTree>()) {
    answer_.reserve(tree_.nodes().size());
    clusters_.resize(words_of(tree_.cluster_count()));
  }

 protected:
  void find(const MeshEye& eye) override {
    find_back(tree_.nodes(), cluster_eye(eye, frame_, tree_.reach()), answer_);
    std::ranges::fill(clusters_, 0);
    for (const std::uint32_t child : answer_.found()) {
      const ClusterTree::Clusters below = tree_.clusters_below(child);
      set_bits(clusters_, below.first, below.count);
    }
  }
  void mark(std::vector<std::uint64_t>& bits) override {
    for (const std::uint32_t child : answer_.found()) tree_.mark(child, bits.data());
  }

 private:
  ClusterTree tree_;
  TreeAnswer answer_;
};

class FlatTests : public TestsContest {
 public:
  FlatTests(const std::string& world, Shown shown, Meshlets::Form form)
      : TestsContest(world, shown, form),
        flat_(world_->mesh(), frame_, default_settings<FlatClusters>()) {
    clusters_.resize(words_of(flat_.cluster_count()));
  }

 protected:
  void find(const MeshEye& eye) override {
    find_back(flat_.blocks(), cluster_eye(eye, frame_, flat_.reach()), clusters_);
  }
  void mark(std::vector<std::uint64_t>& bits) override { flat_.mark(clusters_, bits.data()); }

 private:
  FlatClusters flat_;
};

/// Millions of triangles a second, in the build that other work on the machine disturbed least.
template <typename Clusters>
Measurement build_rate(const std::string& world_name) {
  const std::shared_ptr<const FacingWorld> world = FacingWorld::of(world_name);
  const MeshFrame frame(world->mesh());
  std::vector<double> seconds;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const Clusters clusters(world->mesh(), frame, default_settings<Clusters>());
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    seconds.push_back(elapsed.count());
  }
  return {1e-6 * static_cast<double>(world->mesh().triangles.size()) / std::ranges::min(seconds),
          true};
}

template <typename Clusters>
Measurement bytes_per_triangle(const std::string& world_name) {
  const std::shared_ptr<const FacingWorld> world = FacingWorld::of(world_name);
  const MeshFrame frame(world->mesh());
  const Clusters clusters(world->mesh(), frame, default_settings<Clusters>());
  return {
      static_cast<double>(clusters.bytes()) / static_cast<double>(world->mesh().triangles.size()),
      true};
}

/// What meshoptimizer's own cones find.
Measurement their_share(const std::string& world_name) {
  const std::shared_ptr<const FacingWorld> world = FacingWorld::of(world_name);
  Meshlets meshlets(world->mesh(), Meshlets::Form::loop);
  LeftOut left_out;
  for (std::size_t eye = 0; eye < world->eye_count(); ++eye) {
    std::vector<std::uint64_t> bits(words_of(world->mesh().triangles.size()), 0);
    meshlets.test(world->camera(eye).pose.eye);
    meshlets.mark_left_out(bits);
    left_out.count(*world, eye, bits);
  }
  return {left_out.share(*world), left_out.not_back == 0};
}

/// The soonest way to all back faces. The default size is the knee for a tree that keeps what its
/// smallest clusters do not tell; where triangles of mixed clusters are tested, all are found with
/// any size, and larger clusters take less time.
constexpr const char* best_chain = "backface.cluster_tree[mixed=test,size=32]";

/// Whole cullers and chains, up to the ranges of triangles that are kept.
void add_to_ranges(std::vector<BenchCase>& cases, const std::string& world) {
  for (const std::string ours :
       {"backface.cluster_tree", best_chain, "backface.cluster_tree[mixed=test]",
        "backface.cluster", "backface.cluster_tree > backface.polygon",
        "backface.cluster_tree > backface.normal_mask"}) {
    BenchCase whole{ours, world + ", to ranges", "share", "backface.polygon", [=] {
                      return std::make_unique<CullersContest>(world, ours, "backface.polygon");
                    }};
    if (ours == best_chain) whole.bar = Bar::at_most(1.0);
    cases.push_back(std::move(whole));
  }
  for (const char* ours : {"backface.cluster_tree", "backface.cluster"}) {
    cases.push_back({ours, world + ", to ranges", "share", "peer.meshopt_cones", [=] {
                       return std::make_unique<CullersContest>(world, ours, "peer.meshopt_cones");
                     }});
  }
}

}  // namespace

void add_cluster_cases(std::vector<BenchCase>& cases) {
  const std::string peer = "meshoptimizer's cones";
  for (const std::string world : {"sphere", "low", "high"}) {
    // The world is kept from the first case that needs it to the last.
    const auto kept = std::make_shared<std::shared_ptr<const FacingWorld>>();
    cases.push_back({"backface.cluster_tree",
                     world,
                     "share",
                     peer,
                     [=] {
                       *kept = FacingWorld::of(world);
                       return std::make_unique<TreeTests>(world, Shown::share,
                                                          Meshlets::Form::loop);
                     },
                     {},
                     Bar::at_most(1.0)});
    cases.push_back(
        {"backface.cluster", world, "share", peer,
         [=] { return std::make_unique<FlatTests>(world, Shown::share, Meshlets::Form::loop); }});
    for (const Meshlets::Form form : {Meshlets::Form::loop, Meshlets::Form::rows}) {
      const std::string against = peer + name_of(form);
      const std::string name = world + name_of_tests(form);
      cases.push_back({"backface.cluster_tree", name, "us", against,
                       [=] { return std::make_unique<TreeTests>(world, Shown::speed, form); }});
      cases.push_back({"backface.cluster", name, "us", against,
                       [=] { return std::make_unique<FlatTests>(world, Shown::speed, form); }});
    }
    cases.push_back({peer, world, "share", "", nullptr, [=] { return their_share(world); }});
    add_to_ranges(cases, world);
    cases.push_back({"backface.cluster_tree", world + ", build", "Mtriangle/s", "", nullptr,
                     [=] { return build_rate<ClusterTree>(world); }, Bar::at_least(1.0)});
    cases.push_back({"backface.cluster", world + ", build", "Mtriangle/s", "", nullptr,
                     [=] { return build_rate<FlatClusters>(world); }, Bar::at_least(1.0)});
    cases.push_back({"backface.cluster_tree", world + ", memory a triangle", "bytes", "", nullptr,
                     [=] { return bytes_per_triangle<ClusterTree>(world); }});
    cases.push_back({"backface.cluster", world + ", memory a triangle", "bytes", "", nullptr, [=] {
                       const Measurement bytes = bytes_per_triangle<FlatClusters>(world);
                       kept->reset();
                       return bytes;
                     }});
  }
  for (const std::string& world : FacingWorld::scanned()) add_to_ranges(cases, world);
}

}  // namespace vislab
