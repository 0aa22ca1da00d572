#include "algorithms/depth/wrong_buffers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "algorithms/depth/test_then_draw.h"
#include "common/geometry/rounding.h"
#include "common/raster/tile_store.h"

namespace vislab::depth_culling {
namespace {

constexpr SetupOptions right_setup{Coverage::centres, DepthRounding::lowered};

class FullSize : public TestThenDraw {
 public:
  FullSize(CullerInfo info, const WrongSettings& settings)
      : TestThenDraw(std::move(info), 1, right_setup), settings_(settings) {}

 protected:
  const WrongSettings& settings() const { return settings_; }

 private:
  WrongSettings settings_;
};

/// Draws everything shown before anything is asked, as engines do that ask about depths of a
/// frame that is finished.
class AllDrawnFirst : public FullSize {
 public:
  using FullSize::FullSize;

 protected:
  void begin(const Frame& frame) override {
    for (const ObjectId object : frame.objects.shown) {
      raster().draw(std::array{meshes().of(object, frame)});
    }
  }
  void draw(ObjectId, const BoxWindow*, const Frame&) override {}
};

/// Corners behind the eye are divided by |w|, as if they were before it.
class NearPlaneProjected : public AllDrawnFirst {
 public:
  using AllDrawnFirst::AllDrawnFirst;

 protected:
  BoxPlace place(const Aabb& box, BoxWindow& out) override {
    const WindowTransform& window = raster().window();
    const BoxPlace right = project_box(window, box, Coverage::centres, out);
    if (right != BoxPlace::undecided || !box.valid() || !window.perspective()) return right;
    const Viewport& size = window.viewport();
    const glm::dvec2 middle(0.5 * size.width, 0.5 * size.height);
    glm::dvec2 low(INFINITY), high(-INFINITY);
    double nearest = INFINITY;
    for (int i = 0; i < 8; ++i) {
      const WindowPoint corner = window.world()({(i & 1) != 0 ? box.max.x : box.min.x,
                                                 (i & 2) != 0 ? box.max.y : box.min.y,
                                                 (i & 4) != 0 ? box.max.z : box.min.z});
      const double w = std::max(std::abs(corner.depth), 1e-6);
      const glm::dvec2 at = (glm::dvec2(corner.x, corner.y) - corner.depth * middle) / w + middle;
      low = glm::min(low, at);
      high = glm::max(high, at);
      nearest = std::min(nearest, w);
    }
    const auto pixel = [](double at, int end) {
      return static_cast<int>(std::clamp(std::floor(at), 0.0, static_cast<double>(end)));
    };
    out = {pixel(low.x, size.width), pixel(low.y, size.height), pixel(high.x + 1.0, size.width),
           pixel(high.y + 1.0, size.height), round_up(1.0 / nearest)};
    return out.x0 < out.x1 && out.y0 < out.y1 ? BoxPlace::inside : BoxPlace::outside;
  }
};

/// Asks about a larger box around the same middle.
class LooseBounds : public FullSize {
 public:
  using FullSize::FullSize;

 protected:
  BoxPlace place(const Aabb& box, BoxWindow& out) override {
    const glm::dvec3 half = box.half_size() * settings().growth;
    const glm::dvec3 middle = box.center();
    Aabb larger = box;
    for (int axis = 0; axis < 3; ++axis) {
      larger.min[axis] = std::min(box.min[axis], round_down(middle[axis] - half[axis]));
      larger.max[axis] = std::max(box.max[axis], round_up(middle[axis] + half[axis]));
    }
    return project_box(raster().window(), larger, Coverage::centres, out);
  }
};

/// Asks about the depth of the point that is nearest to the eye, which others may lie before.
class EuclideanNearest : public AllDrawnFirst {
 public:
  using AllDrawnFirst::AllDrawnFirst;

 protected:
  BoxPlace place(const Aabb& box, BoxWindow& out) override {
    const BoxPlace place = AllDrawnFirst::place(box, out);
    const WindowTransform& window = raster().window();
    if (place != BoxPlace::inside || !window.perspective()) return place;
    const Pose& pose = window.camera().pose;
    const glm::dvec3 nearest =
        glm::clamp(pose.eye, glm::dvec3(box.min), glm::dvec3(box.max)) - pose.eye;
    const double depth = -glm::dot(nearest, pose.back);
    if (depth > 0.0) out.nearness = std::min(out.nearness, round_up(window.nearness(depth)));
    return place;
  }
};

/// Compares window depths in whole numbers, and takes equal ones for hidden.
class Quantised : public AllDrawnFirst {
 public:
  using AllDrawnFirst::AllDrawnFirst;

 protected:
  bool hides(const BoxWindow& box) override {
    const std::int64_t asked = steps(box.nearness);
    for (int y = box.y0; y < box.y1; ++y) {
      for (int x = box.x0; x < box.x1; ++x) {
        if (asked < steps(raster().nearness(x, y))) return false;
      }
    }
    return true;
  }

 private:
  /// Of the way from the near to the far plane in the device's depth, which is linear in nearness.
  std::int64_t steps(float nearness) {
    const WindowTransform& window = raster().window();
    const Lens& lens = window.camera().lens;
    const double near = window.nearness(lens.near_m);
    const double far = std::isinf(lens.far_m) ? 0.0 : window.nearness(lens.far_m);
    const double share = std::clamp((near - nearness) / (near - far), 0.0, 1.0);
    return std::llround(share * (std::exp2(settings().bits) - 1.0));
  }
};

/// Takes the inverse of w for nearness. In a parallel view w is 1 for all: what was drawn earlier
/// counts as no farther than anything.
class DepthByW : public FullSize {
 public:
  using FullSize::FullSize;

 protected:
  bool hides(const BoxWindow& box) override {
    const WindowTransform& window = raster().window();
    if (window.perspective()) return FullSize::hides(box);
    const auto clear = static_cast<float>(window.nearness(window.camera().lens.far_m));
    for (int y = box.y0; y < box.y1; ++y) {
      for (int x = box.x0; x < box.x1; ++x) {
        if (raster().nearness(x, y) <= clear) return false;
      }
    }
    return true;
  }
};

/// A quarter of the size along each side; a pixel of the buffer counts as covered if its centre is.
class CentresAtReducedSize : public TestThenDraw {
 public:
  CentresAtReducedSize(CullerInfo info, const WrongSettings&)
      : TestThenDraw(std::move(info), 4, right_setup) {}

 protected:
  BoxPlace place(const Aabb& box, BoxWindow& out) override {
    return project_box(raster().window(), box, Coverage::whole_pixels, out);
  }
};

/// Pixels count as covered where anything touches them: four by four samples a pixel, of which one
/// is enough; fewer where so fine a buffer would be larger than buffers may be.
class RoundedOutward : public FullSize {
 public:
  using FullSize::FullSize;

  std::size_t bytes() const override { return FullSize::bytes() + (fine_ ? fine_->bytes() : 0); }

 protected:
  void begin(const Frame& frame) override {
    samples_ = std::clamp(
        greatest_buffer_px / std::max(frame.viewport.width, frame.viewport.height), 1, 4);
    const Viewport finer{frame.viewport.width * samples_, frame.viewport.height * samples_};
    if (!fine_ || fine_->viewport() != finer) fine_.emplace(finer, RasterOptions{right_setup});
    fine_->begin(frame.camera);
  }
  bool hides(const BoxWindow& box) override {
    for (int y = box.y0; y < box.y1; ++y) {
      for (int x = box.x0; x < box.x1; ++x) {
        if (!touched(x, y, box.nearness)) return false;
      }
    }
    return true;
  }
  void draw(ObjectId object, const BoxWindow*, const Frame& frame) override {
    fine_->draw(std::array{meshes().of(object, frame)});
  }

 private:
  bool touched(int x, int y, float nearness) const {
    for (int i = 0; i < samples_ * samples_; ++i) {
      if (fine_->nearness(x * samples_ + i % samples_, y * samples_ + i / samples_) > nearness) {
        return true;
      }
    }
    return false;
  }

  int samples_ = 4;  // along a pixel's side
  std::optional<DepthRaster> fine_;
};

/// Scales about a point.
glm::dmat4x3 scaled_about(const glm::dvec3& middle, const glm::dvec3& scale) {
  return {{scale.x, 0.0, 0.0}, {0.0, scale.y, 0.0}, {0.0, 0.0, scale.z}, middle - scale * middle};
}

glm::dmat4x3 product(const glm::dmat4x3& outer, const glm::dmat4x3& inner) {
  const glm::dmat3 linear(outer);
  return {linear * inner[0], linear * inner[1], linear * inner[2], linear * inner[3] + outer[3]};
}

/// Occluders are drawn `growth` metres larger to all sides, as a simplified mesh may be.
class GrownOccluders : public FullSize {
 public:
  using FullSize::FullSize;

 protected:
  void draw(ObjectId object, const BoxWindow*, const Frame& frame) override {
    const Aabb& box = frame.objects.bounds[object];
    const glm::dvec3 half = glm::max(box.half_size(), glm::dvec3(1e-9));
    const glm::dmat4x3 grown = product(scaled_about(box.center(), 1.0 + settings().growth / half),
                                       frame.objects.transforms[object]);
    RasterDraw call = meshes().of(object, frame);
    call.transform = &grown;
    raster().draw(std::array{call});
  }
};

/// Occluders are drawn as their bounding boxes: whatever they leave open is taken for opaque.
class BoxesAsOccluders : public FullSize {
 public:
  using FullSize::FullSize;

  void build(const Scene& scene, const BuildContext& context) override {
    FullSize::build(scene, context);
    Mesh cube;
    for (int i = 0; i < 8; ++i) {
      cube.positions.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
    }
    cube.triangles = {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 7, 3}, {2, 6, 7}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    cube_ = RasterMesh(cube);
  }
  std::size_t bytes() const override { return FullSize::bytes() + cube_.bytes(); }

 protected:
  void draw(ObjectId object, const BoxWindow*, const Frame& frame) override {
    const Aabb& box = frame.objects.bounds[object];
    if (!box.valid()) return;
    const glm::dvec3 size = 2.0 * box.half_size();
    const glm::dmat4x3 transform{
        {size.x, 0.0, 0.0}, {0.0, size.y, 0.0}, {0.0, 0.0, size.z}, glm::dvec3(box.min)};
    raster().draw(std::array{RasterDraw{&cube_, &transform, 0, 12, 0, false}});
  }

 private:
  RasterMesh cube_;
};

/// Objects are tested against the last frame's depths alone, as its camera saw them.
class OnePhase : public FullSize {
 public:
  using FullSize::FullSize;

  void reset(std::uint64_t seed) override {
    FullSize::reset(seed);
    known_ = false;
    drawn_ = false;
  }
  std::size_t bytes() const override {
    return FullSize::bytes() + (last_ ? last_->bytes() : 0) + (next_ ? next_->bytes() : 0);
  }

 protected:
  void begin(const Frame& frame) override {
    if (drawn_) {
      std::swap(last_, next_);
      known_ = last_->viewport() == frame.viewport;
    }
    if (!next_ || next_->viewport() != frame.viewport) {
      next_.emplace(frame.viewport, RasterOptions{right_setup});
    }
    next_->begin(frame.camera);
    drawn_ = true;
  }
  BoxPlace place(const Aabb& box, BoxWindow& out) override {
    if (!known_) return BoxPlace::undecided;
    // What the last frame did not see all of is kept.
    const BoxPlace now = FullSize::place(box, out);
    if (now != BoxPlace::inside) return now;
    return project_box(last_->window(), box, Coverage::centres, out) == BoxPlace::inside
               ? BoxPlace::inside
               : BoxPlace::undecided;
  }
  bool hides(const BoxWindow& box) override { return last_->hides(box); }
  void draw(ObjectId object, const BoxWindow*, const Frame& frame) override {
    next_->draw(std::array{meshes().of(object, frame)});
  }

 private:
  std::optional<DepthRaster> last_, next_;
  bool drawn_ = false;  // there is a frame before the next one
  bool known_ = false;  // last_ holds it
};

/// Occluders are drawn as they stood when the scene was built, whether they have moved or are
/// hidden now.
class StaleOccluders : public FullSize {
 public:
  using FullSize::FullSize;

 protected:
  void begin(const Frame& frame) override {
    for (ObjectId object = 0; object < scene().object_count(); ++object) {
      RasterDraw call = meshes().of(object, frame);
      call.transform = &scene().objects[object].transform;
      raster().draw(std::array{call});
    }
  }
  void draw(ObjectId, const BoxWindow*, const Frame&) override {}
};

}  // namespace

std::unique_ptr<ICuller> make_near_plane_projected(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<NearPlaneProjected>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_euclidean_nearest(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<EuclideanNearest>(std::move(info), settings);
}

std::unique_ptr<ICuller> make_loose_bounds(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<LooseBounds>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_depth_by_w(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<DepthByW>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_quantised(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<Quantised>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_centres_at_reduced_size(CullerInfo info,
                                                      const WrongSettings& settings) {
  return std::make_unique<CentresAtReducedSize>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_rounded_outward(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<RoundedOutward>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_grown_occluders(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<GrownOccluders>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_boxes_as_occluders(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<BoxesAsOccluders>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_one_phase(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<OnePhase>(std::move(info), settings);
}
std::unique_ptr<ICuller> make_stale_occluders(CullerInfo info, const WrongSettings& settings) {
  return std::make_unique<StaleOccluders>(std::move(info), settings);
}

}  // namespace vislab::depth_culling
