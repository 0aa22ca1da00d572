// The tests of single triangles: the forms of backface.polygon, the projected plane, and the kernel
// under them.
#include <cmath>

#include "algorithms/backface/plane_kernel.h"
#include "experiments/bench/backface/cases.h"
#include "experiments/bench/backface/streaming_read.h"
#include "experiments/bench/backface/world_contests.h"

namespace vislab {
namespace {

/// Whole cullers that all look at every triangle. They leave out no front faces, and the same
/// triangles but for a few of those that are nearly edge-on; an approximate one may do otherwise
/// with a tenth.
class FormsContest : public CullersContest {
 public:
  explicit FormsContest(const std::string& theirs)
      : CullersContest("high", "backface.polygon", theirs, Shown::speed, 16) {}

  bool equal() override {
    count();
    const double allowed = their_info().guarantee == Guarantee::approximate ? 0.1 : 0.0;
    const auto back = static_cast<double>(by_ours().back);
    return by_ours().not_back == 0 && static_cast<double>(by_theirs().not_back) <= allowed * back &&
           std::abs(back - static_cast<double>(by_theirs().back)) <= (1e-4 + allowed) * back;
  }
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
    cases.push_back({"backface.polygon", name, "Mtriangle/s", against,
                     [against] { return std::make_unique<FormsContest>(against); }});
  };
  add_culler("computed", "backface.polygon[form=computed]");
  add_culler("stored_normal", "backface.polygon[form=stored_normal]");
  add_culler("vertex_normals", "backface.polygon[form=vertex_normals]");
  add_culler("projected", "backface.projected_plane");
  const auto add_kernel = [&](const std::string& name, const std::string& against,
                              KernelContest::Against way) {
    cases.push_back({"backface.polygon", name, "Mtriangle/s", against,
                     [way] { return std::make_unique<KernelContest>(way); }});
  };
  add_kernel("kernel", "its scalar twin", KernelContest::Against::scalar);
  add_kernel("kernel, runs", "the kernel in runs of 20", KernelContest::Against::runs);
  add_kernel("kernel, reading", "reading 16 bytes a triangle", KernelContest::Against::reading);
}

}  // namespace vislab
