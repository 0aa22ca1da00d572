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

#include "algorithms/backface/facing_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

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
  info.parameters = {open_parameter()};
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

class Polygon : public FacingCuller {
 public:
  explicit Polygon(bool cull_open) : FacingCuller(describe(), cull_open) {}

  Counters counters() const override { return {{"triangles_tested", triangles_tested_}}; }

 protected:
  void clear() override {
    first_plane_.clear();
    planes_.clear();
  }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame, const BuildContext&) override {
    first_plane_.resize(id + 1);
    first_plane_[id] = planes_.size();
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      planes_.push_back(scaled_plane(mesh, frame, triangle));
    }
  }

  void mark_range(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                  std::uint64_t* back) override {
    triangles_tested_ += count;
    const glm::dvec4* planes = planes_.data() + first_plane_[view.mesh] + first;
    const double limit = behind_limit(view.eye, frame_of(view.mesh));
    std::fill_n(back, words_of(count), 0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool behind = glm::dot(planes[i], view.eye.position) < -limit;
      back[i / 64] |= std::uint64_t{behind} << (i % 64);
    }
  }

  std::size_t mesh_bytes() const override {
    return planes_.capacity() * sizeof(glm::dvec4) + first_plane_.capacity() * sizeof(std::size_t);
  }

 private:
  std::vector<std::size_t> first_plane_;  // by mesh, in planes_, one plane for each triangle
  std::vector<glm::dvec4> planes_;
  std::uint64_t triangles_tested_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry backface_polygon() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<Polygon>(culls_open(values));
          }};
}

}  // namespace cullers
}  // namespace vislab
