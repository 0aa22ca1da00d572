// backface.polygon: leaves out triangles that face away from the eye, one plane test a triangle.
//
// Idea: a triangle of a closed solid that is seen from behind is hidden by the solid itself. The
//   eye (orthographic: the direction to the viewer) is taken into the mesh's frame once per object,
//   where the planes of the triangles are known: behind the plane means seen from behind. An affine
//   map takes the inside of a solid to the inside of its image, so turned, sheared and scaled
//   objects need nothing else.
// Guarantee: conservative. Only solid meshes are tested: closed, outward and free of
//   self-intersection (other meshes are kept whole, unless open=cull; a surface that crosses itself
//   can show its back to the outside, as those of the scenes cow and man do). A triangle goes only
//   if the eye is behind its plane by more than the error of the test, and an object that may hold
//   the eye or be cut by the near plane is kept whole. A triangle seen exactly edge-on is kept.
// Cost: O(candidate triangles): three multiplications and additions each; one 3 x 3 inverse an
//   object. Memory: 32 bytes a triangle of a mesh; instances share it.
// Limits: about half of a solid's faces at best; nothing for meshes that are open or cross or touch
//   themselves anywhere; does not see that objects hide each other. Short runs of kept triangles
//   make long lists of ranges.
// Sources: textbook chapter 17, Culling (in German), 17.1 (Hesse form; e = 0 is front); Zachmann
//   slides 7-10; Kowalka 2016, 2.2.2, eq. 2.1 (normal of a polygon).

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/culler/registry.h"
#include "common/geometry/frustum.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.polygon";
  info.family = "backface";
  info.summary =
      "Leaves out the triangles of solid meshes that face away from the eye, by one plane test a "
      "triangle in the mesh's own frame.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.parameters = {ParameterSpec::choice(
      "open", "two_sided", {"two_sided", "cull"}, ParameterSpec::Stage::build,
      "what to do with meshes that are not solid (open, or crossing themselves): two_sided keeps "
      "them whole; cull tests them too and loses what is seen from behind")};
  info.cost = "O(candidate triangles): one plane test each, and a 3 x 3 inverse an object";
  info.limits =
      "About half of a solid's faces at best; keeps meshes that are open or cross themselves, and "
      "objects around the eye, whole. With open=cull the backs that such meshes show disappear.";
  info.sources = {
      "Textbook chapter 17, Culling (in German), 17.1: back faces from the Hesse form of their "
      "planes",
      "Zachmann, Computer-Graphik 2, SS 2012, slides 7-10",
      "Kowalka 2016 (thesis, HAW Hamburg), 2.2.2, eq. 2.1"};
  return info;
}

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Plane of a triangle in the mesh's frame, n.p + d >= 0 in front, scaled so that the error of n.p
/// + d does not depend on the triangle: divided by the sum of the absolute products that make up
/// the normal (eq. 2.1). A normal that is mostly cancellation is then short, and decides nothing.
glm::dvec4 scaled_plane(const Mesh& mesh, const glm::uvec3& triangle) {
  const glm::dvec3 a(mesh.positions[triangle.x]);
  const glm::dvec3 u = glm::dvec3(mesh.positions[triangle.y]) - a;
  const glm::dvec3 v = glm::dvec3(mesh.positions[triangle.z]) - a;
  const glm::dvec3 forward(u.y * v.z, u.z * v.x, u.x * v.y);
  const glm::dvec3 backward(u.z * v.y, u.x * v.z, u.y * v.x);
  const glm::dvec3 sizes = glm::abs(forward) + glm::abs(backward);
  const double size = sizes.x + sizes.y + sizes.z;
  if (!(size > 0.0)) return glm::dvec4(0.0);  // no area: never behind anything
  const glm::dvec3 normal = forward - backward;
  return {normal / size, -glm::dot(normal, a) / size};
}

/// The eye in the frame of an object's mesh: a point (w = 1), or the direction to the viewer (w =
/// 0).
struct MeshEye {
  glm::dvec4 position{0.0};
  double error = 0.0;  // bound on the error of each coordinate

  /// A triangle is surely seen from behind if its scaled plane's value is below -limit.
  double limit(double mesh_size) const {
    // With scaled planes each of the normal's parts carries at most 4 roundings, d at most 8, and
    // the value 6 more, each of half an epsilon times |eye| + |mesh|; twice that is taken.
    const double magnitude =
        std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
    return 16.0 * epsilon * (magnitude + position.w * mesh_size) + error;
  }
};

double row_sum(const glm::dmat3& m) {
  const glm::dvec3 sums = glm::abs(m[0]) + glm::abs(m[1]) + glm::abs(m[2]);
  return std::max({sums.x, sums.y, sums.z});
}

/// Takes the eye into the mesh's frame. False if the transform is too near to singular to tell
/// where the eye is.
bool eye_in_mesh(const Camera& camera, const glm::dmat4x3& transform, MeshEye& eye) {
  const glm::dmat3 linear(transform[0], transform[1], transform[2]);
  const glm::dmat3 inverse = glm::inverse(linear);
  // With |linear * inverse - 1| < 1/2 the true inverse is at most twice the computed one.
  if (!(row_sum(linear * inverse - glm::dmat3(1.0)) < 0.5)) return false;
  const bool perspective = camera.lens.projection == Projection::perspective;
  const glm::dvec3 world = perspective ? camera.pose.eye - transform[3] : camera.pose.back;
  const glm::dvec3 world_size =
      perspective ? glm::abs(camera.pose.eye) + glm::abs(transform[3]) : glm::abs(world);
  const glm::dvec3 local = inverse * world;
  // What is left over when the eye is taken back to the world bounds how far off it is.
  const glm::dvec3 rest = glm::abs(linear * local - world);
  const glm::dmat3 sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
  const glm::dvec3 rounding = 8.0 * epsilon * (sizes * glm::abs(local) + world_size);
  const glm::dvec3 off = rest + rounding;
  eye.position = glm::dvec4(local, perspective ? 1.0 : 0.0);
  eye.error = 2.0 * row_sum(inverse) * std::max({off.x, off.y, off.z});
  return std::isfinite(eye.error);
}

class Polygon : public ICuller {
 public:
  explicit Polygon(bool cull_open) : cull_open_(cull_open) {
    info_ = describe();
    if (cull_open_) info_.guarantee = Guarantee::approximate;
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    solids_.clear();
    planes_.clear();
    for (const Mesh& mesh : scene.meshes) {
      Solid solid;
      solid.tested = mesh.solid || cull_open_;
      if (solid.tested) {
        const glm::dvec3 low(glm::abs(mesh.bounds.min)), high(glm::abs(mesh.bounds.max));
        solid.size = std::max({low.x, low.y, low.z, high.x, high.y, high.z});
        solid.first_plane = planes_.size();
        for (const glm::uvec3& triangle : mesh.triangles) {
          planes_.push_back(scaled_plane(mesh, triangle));
        }
      }
      solids_.push_back(solid);
    }
    planes_.shrink_to_fit();
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    ObjectId object = none_id;
    View view;
    for_each_range(candidates, frame, *scene_, [&](const TriangleRange& offered) {
      if (offered.object != object) {
        object = offered.object;
        view = view_of(frame, object);
      }
      if (view.planes == nullptr) {
        kept_.push_back(offered);
      } else {
        keep_front(offered, view);
      }
    });
    out.ranges(kept_);
  }

  std::size_t bytes() const override {
    return planes_.capacity() * sizeof(glm::dvec4) + solids_.capacity() * sizeof(Solid);
  }
  Counters counters() const override { return {{"triangles_tested", triangles_tested_}}; }

 private:
  /// A mesh as this culler knows it.
  struct Solid {
    bool tested = false;          // else always kept whole
    double size = 0.0;            // largest coordinate
    std::size_t first_plane = 0;  // in planes_, one for each triangle
  };
  /// An object of this frame.
  struct View {
    const glm::dvec4* planes = nullptr;  // null: kept whole
    glm::dvec4 eye{0.0};
    double limit = 0.0;
  };

  View view_of(const Frame& frame, ObjectId object) const {
    const Solid& solid = solids_[scene_->objects[object].mesh];
    View view;
    if (!solid.tested || touches_near_region(frame.camera, frame.objects.bounds[object])) {
      return view;
    }
    MeshEye eye;
    if (!eye_in_mesh(frame.camera, frame.objects.transforms[object], eye)) return view;
    view.planes = planes_.data() + solid.first_plane;
    view.eye = eye.position;
    view.limit = eye.limit(solid.size);
    return view;
  }

  void keep_front(const TriangleRange& offered, const View& view) {
    triangles_tested_ += offered.count;
    const std::uint32_t end = offered.first + offered.count;
    std::uint32_t run = offered.first;  // start of the kept triangles not yet written
    for (std::uint32_t triangle = offered.first; triangle < end; ++triangle) {
      if (glm::dot(view.planes[triangle], view.eye) < -view.limit) {
        if (run < triangle) kept_.push_back({offered.object, run, triangle - run});
        run = triangle + 1;
      }
    }
    if (run < end) kept_.push_back({offered.object, run, end - run});
  }

  bool cull_open_;
  CullerInfo info_;
  const Scene* scene_ = nullptr;
  std::vector<Solid> solids_;  // by mesh
  std::vector<glm::dvec4> planes_;
  std::vector<TriangleRange> kept_;
  std::uint64_t triangles_tested_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry backface_polygon() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<Polygon>(values.choice("open") == "cull");
          }};
}

}  // namespace cullers
}  // namespace vislab
