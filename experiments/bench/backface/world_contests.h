// The contests on bumpy spheres and scanned figures that several files of cases share.
#pragma once

#include <algorithm>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/mesh_eye.h"
#include "experiments/bench/backface/facing_world.h"
#include "experiments/bench/backface/meshlets.h"
#include "experiments/bench/backface/triangle_side.h"
#include "experiments/bench/bench.h"

namespace vislab {

/// What a contest reports beside the ratio of the times.
enum class Shown {
  share,  // of the back faces that ours leaves out
  speed   // the time or the rate of ours
};

/// For the names of cases of TestsContest, by what they are timed against.
inline std::string name_of_tests(Meshlets::Form form) {
  return std::string(", tests of 64 views") + (form == Meshlets::Form::rows ? ", rows" : "");
}
inline std::string name_of(Meshlets::Form form) {
  return form == Meshlets::Form::rows ? ", in rows with the same SIMD" : "";
}

/// The tests of all clusters of a mesh from all eyes of a world: ours gives a bit for each cluster,
/// theirs what Meshlets::test makes in its form. Equal as long as no other triangles go.
class TestsContest : public Contest {
 public:
  TestsContest(const std::string& world, Shown shown, Meshlets::Form form)
      : world_(FacingWorld::of(world)),
        frame_(world_->mesh()),
        meshlets_(world_->mesh(), form),
        shown_(shown) {
    for (std::size_t eye = 0; eye < world_->eye_count(); ++eye) {
      eyes_.push_back(*backface_culling::eye_in_mesh(world_->camera(eye),
                                                     world_->scene().objects[0].transform, frame_));
    }
  }

  void ours() override {
    for (const backface_culling::MeshEye& eye : eyes_) find(eye);
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
      std::vector<std::uint64_t> bits(backface_culling::words_of(world_->mesh().triangles.size()),
                                      0);
      mark(bits);
      ours.count(*world_, eye, bits);
      std::ranges::fill(bits, 0);
      meshlets_.test(world_->camera(eye).pose.eye);
      meshlets_.mark_left_out(bits);
      theirs.count(*world_, eye, bits);
    }
    share_ = ours.share(*world_);
    return ours.not_back == 0 && theirs.not_back == 0;
  }
  double figure() const override { return shown_ == Shown::share ? share_ : Contest::figure(); }

 protected:
  /// Bits of the clusters that are seen from behind.
  virtual void find(const backface_culling::MeshEye& eye) = 0;
  /// The same as bits of triangles.
  virtual void mark(std::vector<std::uint64_t>& bits) = 0;

  std::shared_ptr<const FacingWorld> world_;
  backface_culling::MeshFrame frame_;
  std::vector<std::uint64_t> clusters_;

 private:
  std::vector<backface_culling::MeshEye> eyes_;
  Meshlets meshlets_;
  Shown shown_;
  double share_ = 0.0;
};

/// Two cullers or chains, up to the ranges of triangles that they keep: from all eyes of a world,
/// or from every `step`-th. Equal as long as neither leaves out anything but back faces.
class CullersContest : public Contest {
 public:
  CullersContest(const std::string& world, const std::string& ours, const std::string& theirs,
                 Shown shown = Shown::share, std::size_t step = 1)
      : world_(FacingWorld::of(world)),
        ours_(ours, world_->scene()),
        theirs_(theirs, world_->scene()),
        shown_(shown),
        step_(step) {}

  void ours() override { run(ours_); }
  void theirs() override { run(theirs_); }
  bool equal() override {
    count();
    return by_ours_.not_back == 0 && by_theirs_.not_back == 0;
  }
  double figure() const override {
    return shown_ == Shown::share ? by_ours_.share(*world_) : Contest::figure();
  }
  /// Of a speed: millions of triangles, for all eyes together.
  double work() const override {
    const std::size_t calls = (world_->eye_count() + step_ - 1) / step_;
    return shown_ == Shown::speed
               ? 1e-6 * static_cast<double>(calls * world_->mesh().triangles.size())
               : Contest::work();
  }

 protected:
  void count() {
    by_ours_ = left_out(ours_);
    by_theirs_ = left_out(theirs_);
  }
  /// By the last count().
  const LeftOut& by_ours() const { return by_ours_; }
  const LeftOut& by_theirs() const { return by_theirs_; }
  const CullerInfo& their_info() const { return theirs_.culler().info(); }

 private:
  void run(TriangleSide& side) {
    for (std::size_t eye = 0; eye < world_->eye_count(); eye += step_) {
      side.cull(world_->frame(eye));
    }
  }
  LeftOut left_out(TriangleSide& side) {
    LeftOut sum;
    for (std::size_t eye = 0; eye < world_->eye_count(); eye += step_) {
      side.cull(world_->frame(eye));
      sum.count(*world_, eye, side.left_out());
    }
    return sum;
  }
  std::shared_ptr<const FacingWorld> world_;
  TriangleSide ours_, theirs_;
  Shown shown_;
  std::size_t step_;
  LeftOut by_ours_, by_theirs_;
};

}  // namespace vislab
