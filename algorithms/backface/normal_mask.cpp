// backface.normal_mask: two bytes a triangle say which class its normal belongs to; a table says
// which classes face away.
//
// Idea: all normals are classed once, by a cube around the sphere of directions whose sides are cut
//   into n x n squares. Each frame, the classes are found whose normals all face away wherever in
//   the view their triangle is: those that do so along all four corners of the view. What is left
//   of the test of a triangle is one look-up. The wider the view, the fewer classes are certain;
//   so the view is cut into sectors with masks of their own. Every block of 128 consecutive
//   triangles is tested with the mask of the sectors that it is seen in: what the four corners of
//   its rectangle have in common, which for a block in one sector is that sector's mask.
// Guarantee: conservative. A class counts only if all four corners of its square face away along
//   all four corners of the sectors, with a margin for rounding (direction_cube.h), so that edge-on
//   triangles stay; meshes that are not solid, and objects around the eye, are kept whole as by
//   backface.polygon. Blocks outside of the view are tested by corners that enclose them; those
//   that reach beside or behind the eye are kept.
// Cost: O(candidate triangles) look-ups, 16 to 64 at a time; one placing a block; and for each
//   linear part of transforms up to (sectors + 1)^2 tests of all 6 (n + 1)^2 corners of classes.
//   Memory: 2 bytes a triangle of a mesh and 24 a block.
// Limits: n is 18 at most, because two bytes tell no more classes apart. The wider the
//   view, the fewer back faces are found; with one sector, as published, few in wide views. Where
//   corners of the view fall exactly on corners of classes, as in a view of 90 degrees along an
//   axis of the mesh, these are edge-on and decide nothing. Small objects that are turned each in
//   its own way pay for masks of their own. Triangles that are stored far from their neighbours
//   make blocks that straddle sectors.
// Source: Zhang and Hoff 1997, "Fast backface culling using normal masks"; Zachmann,
//   Computer-Graphik 2, SS 2012, slides 13-18.

#include "algorithms/backface/normal_mask.h"

#include "algorithms/backface/facing_culler.h"
#include "algorithms/backface/masked_mesh.h"
#include "common/culler/registry.h"

namespace vislab::backface_culling {
namespace {

class NormalMask : public FacingCuller {
 public:
  NormalMask(CullerInfo info, const NormalMaskOptions& options)
      : FacingCuller(std::move(info), options.open),
        masks_(DirectionCube(options.n, options.class_test), options.sectors) {}

  void reset(std::uint64_t) override { masks_.reset(); }
  Counters counters() const override {
    return {{"triangles_tested", triangles_tested_},
            {"directions_tested", masks_.directions_tested()}};
  }

 protected:
  void clear() override {
    meshes_.clear();
    masks_.reset();
  }

  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame, const BuildContext&) override {
    meshes_.resize(id + 1);
    meshes_[id] = MaskedMesh(mesh, frame, masks_.cube());
  }

  void begin(const Frame& frame) override { masks_.start(frame.camera, frame.index); }

  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) override {
    marker_.start(meshes_[view.mesh], frame_of(view.mesh), view.frame.camera,
                  view.frame.objects.transforms[view.object]);
    return {};
  }

  void mark_range(const ObjectView&, std::uint32_t first, std::uint32_t count,
                  std::uint64_t* back) override {
    triangles_tested_ += count;
    marker_.mark(first, count, back);
  }

  std::size_t mesh_bytes() const override {
    std::size_t sum = meshes_.capacity() * sizeof(MaskedMesh);
    for (const MaskedMesh& mesh : meshes_) sum += mesh.bytes();
    return sum;
  }

 private:
  ViewMasks masks_;
  MaskMarker marker_{masks_};
  std::vector<MaskedMesh> meshes_;  // by mesh
  std::uint64_t triangles_tested_ = 0;
};

}  // namespace

std::unique_ptr<ICuller> make_normal_mask(CullerInfo info, const NormalMaskOptions& options) {
  return std::make_unique<NormalMask>(std::move(info), options);
}

}  // namespace vislab::backface_culling

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.normal_mask";
  info.family = "backface";
  info.summary =
      "Leaves out the triangles of solid meshes whose class of normals faces away in the whole "
      "sector of the view that they are in: one look-up of two bytes a triangle.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  const NormalMaskOptions defaults;
  using Spec = ParameterSpec;
  info.parameters = {
      Spec::integer("n", defaults.n, 1, DirectionCube::max_n, "", Spec::Stage::build,
                    "squares along an edge of the direction cube, 6 n^2 classes of normals; not "
                    "more than 18, because a triangle's two bytes (one of 256 bytes, one of its 8 "
                    "bits) tell 2,048 classes apart; coarse classes are seldom behind as a whole"),
      Spec::integer("sectors", defaults.sectors, 1, SectorLines::most_sectors, "",
                    Spec::Stage::build,
                    "parts of the view a side, each with its own mask: 1 is the method as "
                    "published, which finds little in wide views; more find more, and cost a test "
                    "of all classes for each corner"),
      open_parameter()};
  info.cost =
      "O(candidate triangles) look-ups of two bytes, and (sectors + 1)^2 tests of all classes for "
      "each linear part of the objects' transforms";
  info.limits =
      "The wider the view, the fewer back faces are found, with one sector few; fewer, too, of "
      "triangles whose neighbours in the mesh's order lie far away. Small objects that are turned "
      "each in its own way pay for masks of their own. Keeps meshes that are open or cross "
      "themselves, and objects around the eye, whole.";
  info.sources = {"Zhang and Hoff 1997, Fast backface culling using normal masks",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 13-18"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry backface_normal_mask() {
  return {describe(), [](const ParameterValues& values) {
            return make_normal_mask(describe(), {static_cast<int>(values.integer("n")),
                                                 static_cast<int>(values.integer("sectors")),
                                                 culls_open(values), ClassTest::corners});
          }};
}

}  // namespace cullers
}  // namespace vislab
