// The tests of single triangles: the forms of backface.polygon, the projected plane, and the kernel
// under them.
#include <array>
#include <cmath>

#include "algorithms/backface/plane_kernel.h"
#include "experiments/bench/backface/cases.h"
#include "experiments/bench/backface/facing_world.h"
#include "experiments/bench/backface/streaming_read.h"
#include "experiments/bench/backface/triangle_side.h"

namespace vislab {
namespace {

constexpr std::array<std::size_t, 4> eyes{0, 21, 42, 63};

/// Whole cullers, from the frame to the ranges that are kept.
class CullerContest : public Contest {
 public:
  CullerContest(const std::string& ours, const std::string& theirs)
      : world_(FacingWorld::of("high")),
        ours_(ours, world_->scene()),
        theirs_(theirs, world_->scene()) {}

  void ours() override { run(ours_); }
  void theirs() override { run(theirs_); }
  double work() const override {
    return 1e-6 * static_cast<double>(eyes.size() * world_->mesh().triangles.size());
  }

  /// Both leave out the same triangles but for a few of those that are nearly edge-on, and no front
  /// faces; an approximate one also some of those.
  bool equal() override {
    const double allowed = approximate() ? 0.1 : 0.0;
    for (const std::size_t eye : eyes) {
      LeftOut of_ours;
      LeftOut of_theirs;
      const Frame frame = world_->frame(eye);
      ours_.cull(frame);
      of_ours.count(*world_, eye, ours_.left_out());
      theirs_.cull(frame);
      of_theirs.count(*world_, eye, theirs_.left_out());
      const auto back = static_cast<double>(of_ours.back);
      if (of_ours.not_back > 0 || static_cast<double>(of_theirs.not_back) > allowed * back ||
          std::abs(back - static_cast<double>(of_theirs.back)) > (1e-4 + allowed) * back) {
        return false;
      }
    }
    return true;
  }

 private:
  void run(TriangleSide& side) {
    for (const std::size_t eye : eyes) side.cull(world_->frame(eye));
  }
  bool approximate() const { return theirs_.culler().info().guarantee == Guarantee::approximate; }

  std::shared_ptr<const FacingWorld> world_;
  TriangleSide ours_;
  TriangleSide theirs_;
};

/// The kernel alone, from an eye in the mesh's frame to bits.
class KernelContest : public Contest {
 public:
  enum class Against { scalar, runs, reading };

  explicit KernelContest(Against against)
      : against_(against),
        world_(FacingWorld::of("high")),
        frame_(world_->mesh()),
        planes_(world_->mesh(), frame_),
        our_bits_(backface_culling::words_of(planes_.count())),
        their_bits_(our_bits_.size()) {
    backface_culling::MeshEye eye;
    eye.position = glm::dvec4(world_->camera(0).pose.eye - frame_.middle, 1.0);
    test_ = backface_culling::plane_test(eye, frame_);
  }

  void ours() override {
    backface_culling::mark_behind(planes_, test_, 0, planes_.count(), our_bits_.data());
  }

  void theirs() override {
    switch (against_) {
      case Against::scalar:
        backface_culling::mark_behind_scalar(planes_, test_, 0, planes_.count(),
                                             their_bits_.data());
        break;
      case Against::runs:
        for (std::uint32_t first = 0; first < planes_.count(); first += run_) {
          const std::uint32_t count = std::min(run_, planes_.count() - first);
          std::uint64_t bits = 0;
          backface_culling::mark_behind(planes_, test_, first, count, &bits);
          put(first, count, bits);
        }
        break;
      case Against::reading:
        // Two halves of all planes; the last few stay unread.
        read_sum_ = streaming_read(reinterpret_cast<const std::uint8_t*>(planes_.row(0)),
                                   reinterpret_cast<const std::uint8_t*>(planes_.row(2)),
                                   std::size_t{8} * planes_.count() / 128 * 128);
    }
  }

  bool equal() override { return against_ == Against::reading || our_bits_ == their_bits_; }
  double work() const override { return 1e-6 * planes_.count(); }

 private:
  static constexpr std::uint32_t run_ = 20;

  void put(std::uint32_t first, std::uint32_t count, std::uint64_t bits) {
    const std::uint32_t shift = first % 64;
    if (shift == 0) their_bits_[first / 64] = 0;
    their_bits_[first / 64] |= bits << shift;
    if (shift + count > 64) their_bits_[first / 64 + 1] = bits >> (64 - shift);
  }

  Against against_;
  std::shared_ptr<const FacingWorld> world_;
  backface_culling::MeshFrame frame_;
  backface_culling::PlaneArrays planes_;
  backface_culling::PlaneTest test_;
  std::vector<std::uint64_t> our_bits_, their_bits_;
  volatile std::uint64_t read_sum_ = 0;
};

}  // namespace

void add_polygon_cases(std::vector<BenchCase>& cases) {
  const auto add_culler = [&](const std::string& name, const std::string& against) {
    cases.push_back({"backface.polygon", name, "Mtri/s", against, [against] {
                       return std::make_unique<CullerContest>("backface.polygon", against);
                     }});
  };
  add_culler("computed", "backface.polygon[form=computed]");
  add_culler("stored_normal", "backface.polygon[form=stored_normal]");
  add_culler("vertex_normals", "backface.polygon[form=vertex_normals]");
  add_culler("projected", "backface.projected_plane");
  const auto add_kernel = [&](const std::string& name, const std::string& against,
                              KernelContest::Against way) {
    cases.push_back({"backface.polygon", name, "Mtri/s", against,
                     [way] { return std::make_unique<KernelContest>(way); }});
  };
  add_kernel("kernel", "its scalar twin", KernelContest::Against::scalar);
  add_kernel("kernel, runs", "the kernel in runs of 20", KernelContest::Against::runs);
  add_kernel("kernel, reading", "reading 16 bytes a triangle", KernelContest::Against::reading);
}

}  // namespace vislab
