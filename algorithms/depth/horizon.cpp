// depth.horizon: the occlusion horizon, for cities: one interval of hidden rows for each column of
// the image.
//
// Idea: from near to far, an object whose rectangle is covered by what is nearer is hidden; else it
//   is kept, and a rectangle that it covers for certain is joined to the horizon as soon as
//   everything that is looked at lies behind it (horizon_culler.h).
// Guarantee: image_exact: rectangles lie inside of convex solids, smaller by what a device may snap
//   and farther by what it may round (convex_parts.h). With ground=assumed approximate: what is
//   below the horizon is taken for hidden, which it is only if everything stands on the ground.
// Cost: O(k log k) for k nodes and objects that are not hidden by a node above them, and O(columns)
//   for each test.
// Limits: meshes without a closed, convex part hide nothing. One interval a column: what is covered
//   above and below a gap is not known. Cameras that roll make rectangles in objects small. The
//   order is part of the method: an occluder may join only when all that is still to be looked at
//   lies behind it, so there is no parameter `order`; depth.wrong[error=unsorted] shows what
//   another one does.
// Sources: Zachmann, Computer-Graphik 2, SS 2012, slides 44-46; Downs, Moeller and Sequin 2001.

#include "algorithms/depth/horizon_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using depth_culling::Ground;
using depth_culling::HorizonCuller;
using depth_culling::HorizonOptions;

CullerInfo describe() {
  CullerInfo info;
  info.name = "depth.horizon";
  info.family = "depth";
  info.summary =
      "Sweeps the scene from near to far and keeps, for each column of the image, the rows that "
      "are covered: an object whose rectangle is covered is hidden, any other covers a rectangle "
      "inside of its convex parts.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.parameters = {
      ParameterSpec::choice(
          "ground", "covered", {"covered", "assumed"}, ParameterSpec::Stage::build,
          "below what is covered nothing is hidden, or (assumed) everything, which is right only "
          "where all that hides stands on the ground and the camera is upright"),
      ParameterSpec::real("occluder_px", 256.0, 0.0, 1e9, "pixels", ParameterSpec::Stage::build,
                          "objects whose boxes cover fewer pixels hide nothing: less to compute, "
                          "and less is found hidden")};
  info.cost =
      "O(k log k) for k nodes and objects that no node above them hides, and O(columns of a box) "
      "for each test";
  info.limits =
      "Only closed convex parts of meshes hide anything; one interval of rows a column. Always "
      "near first: another order is wrong (depth.wrong[error=unsorted]). With ground=assumed, what "
      "is seen below bridges and overhangs is lost.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 44-46",
                  "Downs, Moeller and Sequin 2001, Occlusion Horizons for Driving through Urban "
                  "Scenery"};
  return info;
}

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  CullerInfo info = describe();
  HorizonOptions options;
  options.occluder_px = values.real("occluder_px");
  if (values.choice("ground") == "assumed") {
    options.ground = Ground::assumed;
    info.guarantee = Guarantee::approximate;
  }
  return std::make_unique<HorizonCuller>(std::move(info), options);
}

}  // namespace

namespace cullers {

CullerEntry depth_horizon() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
