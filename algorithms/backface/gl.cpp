// backface.gl: lets the device leave out back faces itself, by OpenGL's glCullFace.
//
// Idea: nothing is decided here but which objects may be drawn one-sided: solid ones that the eye
//   is surely outside of. The device transforms all their triangles and drops those that turn
//   clockwise in the window (counter-clockwise for mirrored objects) before they are filled.
// Guarantee: image_exact. A back face of a solid is hidden by a front face at every ray. The device
//   decides on vertices that are rounded to its grid in the window, so a sliver may turn over and
//   be lost although it faces the eye: pixels within the rounding of its edges, which are disputed.
//   Objects that touch the near region or may hold the eye keep both sides, and so do meshes that
//   are not solid, unless open=cull (approximate then).
// Cost: O(candidate objects), no test of triangles; one state change for each run of objects that
//   are drawn alike. The device still transforms every vertex.
// Limits: what is submitted is everything, so recall is 0 and no later stage is spared anything:
//   what it saves is part of draw_ms. About half of the filling, none of the transforming.
// Sources: Zachmann slide 10 (glCullFace, the yardstick of normal masks on slide 18); Kowalka 2016,
//   2.2.2 (culling faces before the rasteriser moves work from it to the geometry stage).

#include "algorithms/backface/facing_culler.h"
#include "common/culler/registry.h"
#include "common/geometry/frustum.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.gl";
  info.family = "backface";
  info.summary =
      "Submits everything and lets the device drop the back faces of solid objects, by OpenGL's "
      "own culling of faces.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {backface_culling::open_parameter()};
  info.cost = "O(candidate objects); the device transforms all triangles and fills half of them";
  info.limits =
      "Everything is submitted, so its recall is 0 and over is that of none, by definition: what "
      "it saves is time of drawing (draw_ms, frame_ms), and its error is that of the image. It "
      "decides on vertices rounded to the device's grid, which turns slivers over. Keeps meshes "
      "that are not solid, and objects around the eye, two-sided. With open=cull the backs that "
      "such meshes show disappear.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 10 and 18",
                  "Kowalka 2016 (thesis, HAW Hamburg), 2.2.2"};
  return info;
}

class Gl : public ICuller {
 public:
  explicit Gl(bool cull_open) : cull_open_(cull_open) {
    info_ = describe();
    if (cull_open_) info_.guarantee = Guarantee::approximate;
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    if (context.device == nullptr) {
      throw InputError(
          "backface.gl: there is no graphics device to cull; it needs a run that draws");
    }
    scene_ = &scene;
    device_ = context.device;
    one_sided_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    one_sided_.clear();
    ObjectId last = none_id;
    for_each_range(candidates, frame, *scene_, [&](const TriangleRange& offered) {
      if (offered.object != last && one_sided(frame, offered.object)) {
        one_sided_.push_back(offered.object);
      }
      last = offered.object;
    });
    device_->cull_back_faces(one_sided_);
    hand_on(candidates, out);
  }

  std::size_t bytes() const override { return one_sided_.capacity() * sizeof(ObjectId); }

 private:
  bool one_sided(const Frame& frame, ObjectId object) const {
    return (cull_open_ || scene_->mesh_of(object).solid) &&
           !touches_near_region(frame.camera, frame.objects.bounds[object]);
  }

  static void hand_on(const Candidates& candidates, DrawSink& out) {
    switch (candidates.form()) {
      case Candidates::Form::everything:
        out.everything();
        break;
      case Candidates::Form::objects:
        for (const std::span<const ObjectId> run : candidates.object_runs()) out.objects(run);
        break;
      case Candidates::Form::ranges:
        for (const std::span<const TriangleRange> run : candidates.range_runs()) out.ranges(run);
        break;
    }
  }

  bool cull_open_;
  CullerInfo info_;
  const Scene* scene_ = nullptr;
  RenderDevice* device_ = nullptr;
  std::vector<ObjectId> one_sided_;
};

}  // namespace

namespace cullers {

CullerEntry backface_gl() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<Gl>(backface_culling::culls_open(values));
          }};
}

}  // namespace cullers
}  // namespace vislab
