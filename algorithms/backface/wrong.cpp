// backface.wrong: the mistakes that sources and engines made with back faces, as negative controls.
//
// Idea: each variant makes one documented mistake and does everything else right, so that its
//   damage can be measured, and so that the judge is seen to find it.
// Guarantee: none (erroneous). The table below says of each what its source says or does, what is
//   wrong with it, and what comes of it.
// Cost: O(candidate triangles), as the method that is got wrong.
// Limits: that is what they are for.
// Sources: in the table.

#include <algorithm>
#include <array>
#include <optional>

#include "algorithms/backface/cluster_culler.h"
#include "algorithms/backface/facing_culler.h"
#include "algorithms/backface/normal_mask.h"
#include "algorithms/backface/plane_culler.h"
#include "common/culler/mistakes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

using Make = std::unique_ptr<ICuller> (*)(CullerInfo info, const ParameterValues& values);

struct FacingMistake : Mistake {
  Make make;
};

/// Planes as backface.polygon has them, with another idea of where the eye is.
class WrongEye : public PlaneCuller {
 public:
  using FindEye = std::optional<PlaneTest> (*)(const ObjectView& view, const MeshFrame& frame);

  WrongEye(CullerInfo info, bool cull_open, FindEye find)
      : PlaneCuller(std::move(info), cull_open), find_(find) {}

 protected:
  std::optional<PlaneTest> find_eye(const ObjectView& view, const MeshFrame& frame) override {
    return find_(view, frame);
  }

 private:
  FindEye find_;
};

std::unique_ptr<ICuller> view_direction(CullerInfo info, const ParameterValues& values) {
  return std::make_unique<WrongEye>(
      std::move(info), culls_open(values),
      [](const ObjectView& view, const MeshFrame& frame) -> std::optional<PlaneTest> {
        Camera camera = view.frame.camera;
        camera.lens.projection = Projection::orthographic;
        const auto eye = eye_in_mesh(camera, view.frame.objects.transforms[view.object], frame);
        if (!eye) return std::nullopt;
        return plane_test(*eye, frame);
      });
}

std::unique_ptr<ICuller> winding_ignored(CullerInfo info, const ParameterValues& values) {
  return std::make_unique<WrongEye>(
      std::move(info), culls_open(values),
      [](const ObjectView& view, const MeshFrame& frame) -> std::optional<PlaneTest> {
        PlaneTest test = plane_test(view.eye, frame);
        const glm::dmat4x3& transform = view.frame.objects.transforms[view.object];
        // The normal of the transformed vertices is the right one
        // times the determinant.
        if (glm::determinant(glm::dmat3(transform)) < 0.0) {
          test = {-test.x, -test.y, -test.z, -test.w, test.limit};
        }
        return test;
      });
}

/// Works from the mesh as it is: keeps nothing of it.
class WithoutMemory : public FacingCuller {
 public:
  WithoutMemory(CullerInfo info, const ParameterValues& values)
      : FacingCuller(std::move(info), culls_open(values)) {}

 protected:
  void clear() override {}
  void add_mesh(MeshId, const Mesh&, const MeshFrame&, const BuildContext&) override {}
  std::size_t mesh_bytes() const override { return 0; }
};

/// Normals taken to the world by the object's matrix itself.
class NormalsAsVectors : public WithoutMemory {
 public:
  using WithoutMemory::WithoutMemory;

 protected:
  void mark_range(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                  std::uint64_t* back) override {
    const Mesh& mesh = scene().meshes[view.mesh];
    const MeshFrame& frame = frame_of(view.mesh);
    const glm::dmat3 linear(view.frame.objects.transforms[view.object]);
    std::fill_n(back, words_of(count), 0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const glm::dvec3 normal(scaled_plane(mesh, frame, first + i));
      const glm::dvec3 vertex =
          glm::dvec3(mesh.positions[mesh.triangles[first + i].x]) - frame.middle;
      const glm::dvec3 to_eye = glm::dvec3(view.eye.position) - view.eye.position.w * vertex;
      const bool behind = glm::dot(linear * normal, linear * to_eye) < 0.0;
      back[i / 64] |= std::uint64_t{behind} << (i % 64);
    }
  }
};

/// The plane's equation in the world, summed up in float; what comes out below 0 is culled.
class FloatSign : public WithoutMemory {
 public:
  using WithoutMemory::WithoutMemory;

 protected:
  void mark_range(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                  std::uint64_t* back) override {
    const Mesh& mesh = scene().meshes[view.mesh];
    const glm::dmat4x3& transform = view.frame.objects.transforms[view.object];
    const float outward = glm::determinant(glm::dmat3(transform)) < 0.0 ? -1.0F : 1.0F;
    const Camera& camera = view.frame.camera;
    const bool parallel = camera.lens.projection == Projection::orthographic;
    const glm::vec3 eye(parallel ? camera.pose.back : camera.pose.eye);
    const auto corner = [&](std::uint32_t vertex) {
      return glm::vec3(transform * glm::dvec4(glm::dvec3(mesh.positions[vertex]), 1.0));
    };
    std::fill_n(back, words_of(count), 0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const glm::uvec3& triangle = mesh.triangles[first + i];
      const glm::vec3 a = corner(triangle.x);
      const glm::vec3 normal = outward * glm::cross(corner(triangle.y) - a, corner(triangle.z) - a);
      const float e = glm::dot(eye, normal) - (parallel ? 0.0F : glm::dot(a, normal));
      back[i / 64] |= std::uint64_t{e < 0.0F} << (i % 64);
    }
  }
};

/// backface.cluster, with the rule for joining clusters as it is printed.
std::unique_ptr<ICuller> printed_cost_sign(CullerInfo info, const ParameterValues& values) {
  ClusterSettings settings;
  settings.test_cost = values.real("test_cost");
  settings.join = JoinRule::printed;
  return make_cluster_culler(std::move(info), culls_open(values),
                             [settings](const BuildContext&) { return settings; });
}

std::unique_ptr<ICuller> class_centre(CullerInfo info, const ParameterValues& values) {
  NormalMaskOptions options;
  options.open = culls_open(values);
  options.n = static_cast<int>(values.integer("n"));
  options.class_test = ClassTest::centre;
  return make_normal_mask(std::move(info), options);
}

template <typename Culler>
std::unique_ptr<ICuller> make(CullerInfo info, const ParameterValues& values) {
  return std::make_unique<Culler>(std::move(info), values);
}

constexpr std::array mistakes{
    FacingMistake{
        "view_direction",
        "The sign of the normal times the view direction tells whether a polygon faces the "
        "camera",
        "in perspective the direction to a polygon differs from the view's by up to half the "
        "field of view and more",
        "leaves out front faces at the sides of the image, and keeps as many back faces",
        "Kowalka 2016, 2.2.2, against Zachmann slide 8", view_direction},
    FacingMistake{"winding_ignored",
                  "The normal is the cross product of the transformed vertices' edges",
                  "a transform that mirrors turns the order of the vertices round",
                  "leaves out the front of every mirrored object and keeps its back",
                  "filament issue 1520; bevy pull request 8859; flutter_scene pull request 137",
                  winding_ignored},
    FacingMistake{
        "normals_as_vectors", "Normals are taken to the world by the object's matrix",
        "normals go by the inverse transpose, which is another matrix where the object is "
        "sheared or scaled by different amounts",
        "leaves out front faces of sheared and flattened objects",
        "failures of engines with sheared transforms: filament issue 1520", make<NormalsAsVectors>},
    FacingMistake{
        "float_sign",
        "Put into the plane's equation, p.n - a.n = e, the eye is in front of a face if e >= 0, "
        "else the face is a back face",
        "in float e is off by some 1e-7 of the coordinates: next to a plane, and everywhere far "
        "from the origin, its sign is noise unless a margin is kept",
        "leaves out front faces that are nearly edge-on, more of them the farther the scene is "
        "from the world's origin",
        "textbook 17.1, computed in float without a bound on its error", make<FloatSign>},
    FacingMistake{
        "class_centre", "A class of normals faces away if the normal in its middle does",
        "the class holds other normals, which may still face the eye",
        "leaves out front faces that are nearly edge-on, more of them the coarser the classes",
        "against Zachmann slides 15-16, which test all four corners of a class", class_centre},
    FacingMistake{
        "printed_cost_sign",
        "Two clusters are joined if P(C) > (P(A) n_A + P(B) n_B + t_C / r) / (n_A + n_B)",
        "T(C) < T(A) + T(B) gives - t_C / r: the dearer a test, the sooner clusters should be "
        "joined, not the later",
        "leaves out nothing that is seen, but the dearer tests are the more of them it makes",
        "Zachmann slide 29", printed_cost_sign},
};

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.wrong";
  info.family = "backface";
  info.summary =
      "A negative control: a test for back faces that makes one of the mistakes found in the "
      "sources and in engines.";
  info.guarantee = Guarantee::erroneous;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.parameters = {
      error_parameter(mistakes),
      ParameterSpec::real("test_cost", 1.0, 0.0, 1000.0, "triangles", ParameterSpec::Stage::build,
                          "printed_cost_sign: t_C / r, the time to test a cluster in that of "
                          "drawing a triangle; the others do without"),
      ParameterSpec::integer("n", NormalMaskOptions().n, 1, DirectionCube::max_n, "",
                             ParameterSpec::Stage::build,
                             "class_centre: squares along an edge of the direction cube; the "
                             "others do without"),
      open_parameter()};
  info.cost = "O(candidate triangles)";
  info.limits =
      "Wrong on purpose: leaves out triangles that are seen from the front, or costs more than it "
      "should.";
  info.sources = {"Kowalka 2016 (thesis, HAW Hamburg)", "Zachmann, Computer-Graphik 2, SS 2012",
                  "issues of engines, named with each mistake"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry backface_wrong() {
  return {describe(), [](const ParameterValues& values) {
            const FacingMistake& mistake = chosen_mistake(mistakes, values);
            return mistake.make(info_of(describe(), mistake), values);
          }};
}

}  // namespace cullers
}  // namespace vislab
