// frustum.flat: leaves out objects whose bounding volume lies outside one plane of the view
// frustum.
//
// Idea: a box is outside a plane exactly if its corner farthest along the inward normal (the
//   p-vertex) is; a sphere, if its centre is farther behind the plane than its radius. Every
//   candidate is tested against at most six planes; the first plane that excludes it ends the test.
// Guarantee: conservative. A distance that is negative only by rounding excludes nothing: a fast
//   test in double asks first, and surely_outside with its error bound decides.
// Cost: O(candidates), at most 6 plane tests each; no hierarchy.
// Limits: a volume that is outside the frustum, but not outside any single plane (a big box off a
//   corner), is kept. Objects that hide each other are kept.
// Sources: Clark 1976; Assarsson and Moeller 2000 (n- and p-vertex); Zachmann slides 30-38; Kowalka
//   2016, 3.2.1-3.2.2.

#include "common/culler/registry.h"
#include "common/geometry/frustum.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "frustum.flat";
  info.family = "frustum";
  info.summary =
      "Tests each object's bounding box (p-vertex) or sphere against the planes of the view "
      "frustum "
      "and leaves out what lies outside one of them.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = {ParameterSpec::choice(
      "test", "box", {"box", "sphere"}, ParameterSpec::Stage::build,
      "bounding volume that is tested; the sphere around the box is looser and keeps more")};
  info.cost = "O(candidates): at most 6 plane tests each";
  info.limits =
      "Keeps volumes that are outside the frustum but not outside any single plane; does not see "
      "that objects hide each other.";
  info.sources = {"Clark 1976, Hierarchical Geometric Models for Visible Surface Algorithms",
                  "Assarsson and Moeller 2000, Optimized View Frustum Culling Algorithms for "
                  "Bounding Boxes",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 30-38",
                  "Kowalka 2016 (thesis, HAW Hamburg), 3.2.1-3.2.2"};
  return info;
}

/// A plane with the choice of the p-vertex made once a frame.
struct BoxPlane {
  Plane plane;
  bool x_max, y_max, z_max;  // does the p-vertex have the box's larger x, y, z?
};

/// The loop over the candidates; Test says whether an object is outside, and counts its plane
/// tests.
class FlatFrustum : public ICuller {
 public:
  FlatFrustum() : info_(describe()) {}
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    kept_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    select(frame, frustum_of(frame.camera), candidates);
    out.objects(kept_);
  }

  std::size_t bytes() const override { return kept_.capacity() * sizeof(ObjectId); }
  Counters counters() const override {
    return {{"plane_tests", plane_tests_}, {"objects_tested", objects_tested_}};
  }

 protected:
  /// Calls keep() for what is not surely outside.
  virtual void select(const Frame& frame, const Frustum& frustum, const Candidates& candidates) = 0;

  /// Keeps the candidates for which outside(id, plane_tests) is false.
  template <typename Outside>
  void filter(const Frame& frame, const Candidates& candidates, Outside&& outside) {
    std::uint64_t plane_tests = 0;
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      objects_tested_ += run.size();
      for (const ObjectId object : run) {
        if (!outside(object, plane_tests)) kept_.push_back(object);
      }
    });
    plane_tests_ += plane_tests;
  }

 private:
  CullerInfo info_;
  std::vector<ObjectId> kept_;
  std::uint64_t plane_tests_ = 0;
  std::uint64_t objects_tested_ = 0;
};

class FlatBoxes : public FlatFrustum {
 protected:
  void select(const Frame& frame, const Frustum& frustum, const Candidates& candidates) override {
    std::array<BoxPlane, 6> planes;
    const auto count = static_cast<std::size_t>(frustum.plane_count);
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec3& n = frustum.planes[i].normal;
      planes[i] = {frustum.planes[i], n.x >= 0.0, n.y >= 0.0, n.z >= 0.0};
    }
    const std::span<const BoxPlane> tested(planes.data(), count);
    filter(frame, candidates, [&](ObjectId object, std::uint64_t& plane_tests) {
      const Aabb& box = frame.objects.bounds[object];
      for (const auto& [plane, x_max, y_max, z_max] : tested) {
        ++plane_tests;
        const glm::dvec3 p(x_max ? box.max.x : box.min.x, y_max ? box.max.y : box.min.y,
                           z_max ? box.max.z : box.min.z);
        // A broken box gives NaN here or fails surely_outside: it is kept.
        if (plane.signed_distance(p) < 0.0 && surely_outside(plane, box)) return true;
      }
      return false;
    });
  }
};

class FlatSpheres : public FlatFrustum {
 public:
  void build(const Scene& scene, const BuildContext& context) override {
    FlatFrustum::build(scene, context);
    scene_ = &scene;
    spheres_.resize(scene.object_count());
    enclose_as_built();
  }

  void reset(std::uint64_t) override { enclose_as_built(); }

  void update(const Frame& frame, const Changes& changes) override {
    for (const ObjectId object : changes.moved) {
      spheres_[object] = circumscribed(frame.objects.bounds[object]);
    }
  }

  std::size_t bytes() const override {
    return FlatFrustum::bytes() + spheres_.capacity() * sizeof(Sphere);
  }

 protected:
  void select(const Frame& frame, const Frustum& frustum, const Candidates& candidates) override {
    filter(frame, candidates, [&](ObjectId object, std::uint64_t& plane_tests) {
      const Sphere& sphere = spheres_[object];
      for (const Plane& plane : frustum.span()) {
        ++plane_tests;
        const double distance = plane.signed_distance(glm::dvec3(sphere.center));
        if (distance + sphere.radius < 0.0 && surely_outside(plane, sphere)) return true;
      }
      return false;
    });
  }

 private:
  void enclose_as_built() {
    for (ObjectId object = 0; object < spheres_.size(); ++object) {
      const Aabb& box = scene_->mesh_of(object).bounds;
      spheres_[object] = circumscribed(transformed(box, scene_->objects[object].transform));
    }
  }

  const Scene* scene_ = nullptr;
  std::vector<Sphere> spheres_;  // by object, world frame, as it lies now
};

}  // namespace

namespace cullers {

CullerEntry frustum_flat() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            if (values.choice("test") == "sphere") return std::make_unique<FlatSpheres>();
            return std::make_unique<FlatBoxes>();
          }};
}

}  // namespace cullers
}  // namespace vislab
