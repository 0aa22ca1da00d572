// The mistakes of depth.wrong that are made with Z-pyramids.

#include <array>
#include <optional>

#include "algorithms/depth/test_then_draw.h"
#include "algorithms/depth/wrong_buffers.h"
#include "common/raster/depth_pyramid.h"

namespace vislab::depth_culling {
namespace {

/// Sizes are rounded down: the last odd row and column count for nothing.
struct NpotFloor : PyramidRules {
  static int halved(int size) { return size / 2; }
};

/// As printed: a parent changes if the new value is farther than it.
struct UpdateBackwards : PyramidRules {
  static bool concerns_parent(float, float value, float parent) { return value < parent; }
};

/// The rule for depths that run the other way.
struct WrongReduction : PyramidRules {
  static float reduced(float a, float b) { return std::max(a, b); }
  static bool concerns_parent(float, float, float) { return true; }
};

/// Keeps a pyramid over the buffer while it is drawn into, and asks the level that fits.
template <typename Rules>
class WithPyramid : public TestThenDraw {
 public:
  WithPyramid(CullerInfo info, const WrongSettings&)
      : TestThenDraw(std::move(info), 1, {Coverage::centres, DepthRounding::lowered}) {}

  std::size_t bytes() const override {
    return TestThenDraw::bytes() + (pyramid_ ? pyramid_->bytes() : 0);
  }

 protected:
  void begin(const Frame& frame) override {
    const Viewport& size = frame.viewport;
    if (!pyramid_ || pyramid_->width() != size.width || pyramid_->height() != size.height) {
      pyramid_.emplace(size.width, size.height);
    }
    pyramid_->clear(raster().nearness(0, 0));
  }
  bool hides(const BoxWindow& box) override {
    return pyramid_->not_nearer_than({box.x0, box.y0, box.x1, box.y1}) > box.nearness;
  }
  void draw(ObjectId object, const BoxWindow* box, const Frame& frame) override {
    TestThenDraw::draw(object, box, frame);
    const BoxWindow all{0, 0, frame.viewport.width, frame.viewport.height, 0.0F};
    const BoxWindow& changed = box != nullptr ? *box : all;
    for (int y = changed.y0; y < changed.y1; ++y) {
      for (int x = changed.x0; x < changed.x1; ++x) {
        pyramid_->raise(x, y, raster().nearness(x, y));
      }
    }
  }

 private:
  std::optional<BasicDepthPyramid<Rules>> pyramid_;
};

}  // namespace

std::unique_ptr<ICuller> make_npot_floor(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<WithPyramid<NpotFloor>>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_update_backwards(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<WithPyramid<UpdateBackwards>>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_wrong_reduction(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<WithPyramid<WrongReduction>>(std::move(info), settings);
}

}  // namespace vislab::depth_culling
