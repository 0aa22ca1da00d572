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

/// The tests of all clusters of a mesh from all eyes of a world: ours gives a bit for each cluster,
/// theirs a list of those kept, or with `rows` a byte for each (Meshlets::test_rows).
class TestsContest : public Contest {
 public:
  TestsContest(const std::string& world, bool show_share, bool rows = false)
      : world_(FacingWorld::of(world)),
        frame_(world_->mesh()),
        meshlets_(world_->mesh()),
        show_share_(show_share),
        rows_(rows) {
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
      if (rows_) {
        meshlets_.test_rows(world_->camera(eye).pose.eye);
      } else {
        meshlets_.test(world_->camera(eye).pose.eye);
      }
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
      meshlets_.mark_left_out(meshlets_.test(world_->camera(eye).pose.eye), bits);
      theirs.count(*world_, eye, bits);
    }
    share_ = ours.share(*world_);
    return ours.not_back == 0 && theirs.not_back == 0;
  }
  double figure() const override { return show_share_ ? share_ : Contest::figure(); }

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
  bool show_share_, rows_;
  double share_ = 0.0;
};

/// Two cullers or chains from all eyes, up to the ranges of triangles that they keep. The figure is
/// our share of the back faces; equal as long as neither leaves out anything else.
class CullersContest : public Contest {
 public:
  CullersContest(const std::string& world, const std::string& ours, const std::string& theirs)
      : world_(FacingWorld::of(world)),
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

  std::shared_ptr<const FacingWorld> world_;
  TriangleSide ours_, theirs_;
  double share_ = 0.0;
};

}  // namespace vislab
