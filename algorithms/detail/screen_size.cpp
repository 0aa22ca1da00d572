// detail.screen_size: leaves out what covers less of the image than a threshold.
//
// Idea: the bounding volume's area in the image, in pixels, is at least what the object covers. The
//   threshold is the dial between speed and quality; when the camera moves, it may be larger.
// Guarantee: approximate. An object that is left out covers at most the threshold's area, whatever
//   its place in the image and its distance; of pixel centres a convex outline of that area and
//   perimeter P covers at most the area + P / 2 + 1. What many small objects cover together is not
//   bounded. With a threshold of 0 it is conservative: only what lies wholly before the near plane
//   goes, whatever else may cover nothing.
// Cost: O(candidates), about 40 operations each for spheres and 200 for boxes.
// Limits: objects outside of the image are kept if they are large: their whole area counts, so that
//   nothing changes at the image's border. Put a frustum culler in front. A jump of the camera
//   counts as motion. What an object hides is not asked: a small thing that is left out may show
//   what was behind it.
// Sources: Zachmann, Computer-Graphik 2, SS 2012, slides 90-91, with the exact area in place of the
//   estimate printed there.

#include "algorithms/detail/detail_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using detail_culling::DetailCuller;
using detail_culling::DetailSettings;
using detail_culling::SizeMeasure;

CullerInfo describe() {
  CullerInfo info;
  info.name = "detail.screen_size";
  info.family = "detail";
  info.summary =
      "Leaves out objects whose bounding volume covers at most a threshold's area of the image, "
      "by the exact projected area of a sphere or a box.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.parameters = detail_culling::threshold_parameters();
  info.parameters.push_back(ParameterSpec::choice(
      "area", "sphere", {"sphere", "box"}, ParameterSpec::Stage::build,
      "whose area is measured: a sphere around the mesh, or the object's world box; the tighter "
      "one leaves out more of what is below the threshold"));
  info.cost = "O(candidates): about 40 operations each for spheres, 200 for boxes";
  info.limits =
      "Leaves out visible things, each of at most threshold_px; many of them may cover any area "
      "in sum. Objects beside the image are measured as a whole, so that it does not take the "
      "place of a frustum culler.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 90-91"};
  return info;
}

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  DetailSettings settings = detail_culling::read_threshold(values);
  settings.measure = values.choice("area") == "box" ? SizeMeasure::box : SizeMeasure::sphere;
  CullerInfo info = describe();
  if (settings.threshold_px == 0.0) info.guarantee = Guarantee::conservative;
  return std::make_unique<DetailCuller>(std::move(info), settings);
}

}  // namespace

namespace cullers {

CullerEntry detail_screen_size() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
