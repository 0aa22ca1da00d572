// frustum.polygon: leaves out triangles that lie outside of one plane of the view frustum.
//
// Idea: no bounding volumes: each triangle is compared with the planes itself. The planes are taken
//   into the mesh's frame once an object.
// Guarantee: conservative; a triangle goes only if its three vertices are behind one plane by more
//   than the error of their distances.
// Cost: O(candidate triangles): at most 18 distances each. No memory.
// Limits: the source says that this is slower than no culling at all, because the graphics hardware
//   does the same test; it is here to be measured. Short runs of kept triangles make long lists of
//   ranges. Triangles off a corner of the frustum are kept.
// Source: Zachmann slides 30-31; Kowalka 2016, 2.2.1.

#include "algorithms/frustum/mesh_planes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using frustum_culling::MeshPlane;
using frustum_culling::MeshPlanes;

CullerInfo describe() {
  CullerInfo info;
  info.name = "frustum.polygon";
  info.family = "frustum";
  info.summary =
      "Compares every single triangle with the planes of the view frustum and leaves out what lies "
      "outside of one of them.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.cost = "O(candidate triangles): at most 6 planes with 3 distances each";
  info.limits =
      "Costs more than it saves where the hardware clips anyway; keeps triangles off the corners "
      "of "
      "the frustum; short runs make long lists of ranges.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 30-31",
                  "Kowalka 2016 (thesis, HAW Hamburg), 2.2.1"};
  return info;
}

class Polygon : public ICuller {
 public:
  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext&) override { scene_ = &scene; }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const Frustum frustum = frustum_of(frame.camera);
    constexpr unsigned all_planes = 0x3F;
    kept_.clear();
    ObjectId object = none_id;
    for_each_range(candidates, frame, *scene_, [&](const TriangleRange& offered) {
      const Mesh& mesh = scene_->mesh_of(offered.object);
      if (offered.object != object) {
        object = offered.object;
        planes_.set(frustum, all_planes, frame.objects.transforms[object], mesh.bounds);
      }
      keep_inside(mesh, offered);
    });
    out.ranges(kept_);
  }

  Counters counters() const override {
    return {{"plane_tests", plane_tests_}, {"triangles_tested", triangles_tested_}};
  }

 private:
  bool outside(const Mesh& mesh, const glm::uvec3& triangle) {
    const glm::dvec3 a(mesh.positions[triangle.x]);
    const glm::dvec3 b(mesh.positions[triangle.y]);
    const glm::dvec3 c(mesh.positions[triangle.z]);
    for (const MeshPlane& plane : planes_.span()) {
      ++plane_tests_;
      const double limit = -plane.d - plane.error;
      if (glm::dot(plane.normal, a) < limit && glm::dot(plane.normal, b) < limit &&
          glm::dot(plane.normal, c) < limit) {
        return true;
      }
    }
    return false;
  }

  void keep_inside(const Mesh& mesh, const TriangleRange& offered) {
    triangles_tested_ += offered.count;
    const std::uint32_t end = offered.first + offered.count;
    std::uint32_t run = offered.first;  // start of the kept triangles not yet written
    for (std::uint32_t triangle = offered.first; triangle < end; ++triangle) {
      if (outside(mesh, mesh.triangles[triangle])) {
        if (run < triangle) kept_.push_back({offered.object, run, triangle - run});
        run = triangle + 1;
      }
    }
    if (run < end) kept_.push_back({offered.object, run, end - run});
  }

  CullerInfo info_ = describe();
  const Scene* scene_ = nullptr;
  MeshPlanes planes_;
  std::vector<TriangleRange> kept_;
  std::uint64_t plane_tests_ = 0;
  std::uint64_t triangles_tested_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry frustum_polygon() {
  return {describe(), [](const ParameterValues&) { return std::make_unique<Polygon>(); }};
}

}  // namespace cullers
}  // namespace vislab
