// Clusters on the bumpy spheres: what their tests find and take, whole cullers and chains, and what
// building costs.
#include <algorithm>
#include <chrono>

#include "algorithms/backface/cluster_parameters.h"
#include "algorithms/backface/cluster_tree_data.h"
#include "algorithms/backface/flat_clusters.h"
#include "experiments/bench/backface/bumpy_world.h"
#include "experiments/bench/backface/cases.h"
#include "experiments/bench/backface/meshlets.h"
#include "experiments/bench/backface/triangle_side.h"

namespace vislab {
namespace {

using namespace backface_culling;

/// What backface.cluster and backface.cluster_tree have without parameters.
ClusterSettings default_settings() {
  return cluster_settings(ParameterValues("bench", cluster_parameters(), {}), {});
}

/// The tests of all clusters of a mesh from all eyes of a world: ours gives a bit for each cluster,
/// theirs a list of those kept.
class TestsContest : public Contest {
 public:
  TestsContest(const std::string& world, bool show_share)
      : world_(BumpyWorld::of(world)),
        frame_(world_->mesh()),
        meshlets_(world_->mesh()),
        show_share_(show_share) {
    for (std::size_t eye = 0; eye < world_->eye_count(); ++eye) {
      eyes_.push_back(
          *eye_in_mesh(world_->camera(eye), world_->scene().objects[0].transform, frame_));
    }
  }

  void ours() override {
    for (const MeshEye& eye : eyes_) find(eye);
  }
  void theirs() override {
    for (std::size_t eye = 0; eye < eyes_.size(); ++eye) {
      meshlets_.test(world_->camera(eye).pose.eye);
    }
  }
  bool equal() override {
    LeftOut ours;
    LeftOut theirs;
    for (std::size_t eye = 0; eye < eyes_.size(); ++eye) {
      find(eyes_[eye]);
      std::vector<std::uint64_t> bits(words_of(world_->mesh().triangles.size()), 0);
      mark(bits);
      ours.count(*world_, eye, bits);
      std::ranges::fill(bits, 0);
      meshlets_.mark_left_out(meshlets_.test(world_->camera(eye).pose.eye), bits);
      theirs.count(*world_, eye, bits);
    }
    share_ = ours.share(*world_);
    return ours.not_back == 0 && theirs.not_back == 0;
  }
  double figure() const override { return show_share_ ? share_ : Contest::figure(); }

 protected:
  /// Bits of the clusters that are seen from behind.
  virtual void find(const MeshEye& eye) = 0;
  /// The same as bits of triangles.
  virtual void mark(std::vector<std::uint64_t>& bits) = 0;

  std::shared_ptr<const BumpyWorld> world_;
  MeshFrame frame_;
  std::vector<std::uint64_t> clusters_;

 private:
  std::vector<MeshEye> eyes_;
  Meshlets meshlets_;
  bool show_share_;
  double share_ = 0.0;
};

class TreeTests : public TestsContest {
 public:
  TreeTests(const std::string& world, bool show_share)
      : TestsContest(world, show_share), tree_(world_->mesh(), frame_, default_settings()) {
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
  FlatTests(const std::string& world, bool show_share)
      : TestsContest(world, show_share), flat_(world_->mesh(), frame_, default_settings()) {
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

/// Two cullers or chains from all eyes, up to the ranges of triangles that they keep. The figure is
/// our share of the back faces; equal as long as neither leaves out anything else.
class CullersContest : public Contest {
 public:
  CullersContest(const std::string& world, const std::string& ours, const std::string& theirs)
      : world_(BumpyWorld::of(world)),
        ours_(ours, world_->scene()),
        theirs_(theirs, world_->scene()) {}

  void ours() override { run(ours_); }
  void theirs() override { run(theirs_); }
  bool equal() override {
    const LeftOut by_ours = left_out(ours_);
    share_ = by_ours.share(*world_);
    return by_ours.not_back == 0 && left_out(theirs_).not_back == 0;
  }
  double figure() const override { return share_; }

 private:
  void run(TriangleSide& side) {
    for (std::size_t eye = 0; eye < world_->eye_count(); ++eye) side.cull(world_->frame(eye));
  }
  LeftOut left_out(TriangleSide& side) {
    LeftOut sum;
    for (std::size_t eye = 0; eye < world_->eye_count(); ++eye) {
      side.cull(world_->frame(eye));
      sum.count(*world_, eye, side.left_out());
    }
    return sum;
  }

  std::shared_ptr<const BumpyWorld> world_;
  TriangleSide ours_, theirs_;
  double share_ = 0.0;
};

/// Millions of triangles a second, the median of a few builds.
template <typename Clusters>
Measurement build_rate(const std::string& world_name) {
  const std::shared_ptr<const BumpyWorld> world = BumpyWorld::of(world_name);
  const MeshFrame frame(world->mesh());
  std::vector<double> seconds;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const Clusters clusters(world->mesh(), frame, default_settings());
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    seconds.push_back(elapsed.count());
  }
  std::ranges::sort(seconds);
  return {1e-6 * static_cast<double>(world->mesh().triangles.size()) / seconds[2], true};
}

template <typename Clusters>
Measurement bytes_per_triangle(const std::string& world_name) {
  const std::shared_ptr<const BumpyWorld> world = BumpyWorld::of(world_name);
  const MeshFrame frame(world->mesh());
  const Clusters clusters(world->mesh(), frame, default_settings());
  return {
      static_cast<double>(clusters.bytes()) / static_cast<double>(world->mesh().triangles.size()),
      true};
}

/// What meshoptimizer's own cones find.
Measurement their_share(const std::string& world_name) {
  const std::shared_ptr<const BumpyWorld> world = BumpyWorld::of(world_name);
  Meshlets meshlets(world->mesh());
  LeftOut left_out;
  for (std::size_t eye = 0; eye < world->eye_count(); ++eye) {
    std::vector<std::uint64_t> bits(words_of(world->mesh().triangles.size()), 0);
    meshlets.mark_left_out(meshlets.test(world->camera(eye).pose.eye), bits);
    left_out.count(*world, eye, bits);
  }
  return {left_out.share(*world), left_out.not_back == 0};
}

}  // namespace

void add_cluster_cases(std::vector<BenchCase>& cases) {
  const std::string peer = "meshoptimizer's cones";
  for (const std::string world : {"sphere", "low", "high"}) {
    // The world is kept from the first case that needs it to the last.
    const auto kept = std::make_shared<std::shared_ptr<const BumpyWorld>>();
    cases.push_back({"backface.cluster_tree", world, "share", peer, [=] {
                       *kept = BumpyWorld::of(world);
                       return std::make_unique<TreeTests>(world, true);
                     }});
    cases.push_back({"backface.cluster_tree", world + ", tests of 64 views", "us", peer,
                     [=] { return std::make_unique<TreeTests>(world, false); }});
    cases.push_back({"backface.cluster", world, "share", peer,
                     [=] { return std::make_unique<FlatTests>(world, true); }});
    cases.push_back({"backface.cluster", world + ", tests of 64 views", "us", peer,
                     [=] { return std::make_unique<FlatTests>(world, false); }});
    cases.push_back({peer, world, "share", "", nullptr, [=] { return their_share(world); }});
    for (const char* ours :
         {"backface.cluster_tree", "backface.cluster", "backface.cluster_tree > backface.polygon",
          "backface.cluster_tree > backface.normal_mask"}) {
      cases.push_back({ours, world + ", to ranges", "share", "backface.polygon", [=] {
                         return std::make_unique<CullersContest>(world, ours, "backface.polygon");
                       }});
    }
    cases.push_back({"backface.cluster_tree", world + ", build", "Mtriangle/s", "", nullptr,
                     [=] { return build_rate<ClusterTree>(world); }});
    cases.push_back({"backface.cluster", world + ", build", "Mtriangle/s", "", nullptr,
                     [=] { return build_rate<FlatClusters>(world); }});
    cases.push_back({"backface.cluster_tree", world + ", memory a triangle", "bytes", "", nullptr,
                     [=] { return bytes_per_triangle<ClusterTree>(world); }});
    cases.push_back({"backface.cluster", world + ", memory a triangle", "bytes", "", nullptr, [=] {
                       const Measurement bytes = bytes_per_triangle<FlatClusters>(world);
                       kept->reset();
                       return bytes;
                     }});
  }
}

}  // namespace vislab
