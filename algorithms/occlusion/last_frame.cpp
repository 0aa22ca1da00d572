// occlusion.last_frame: what engines do that never wait: the answers of an earlier frame decide.
//
// Idea: an object is drawn unless it was asked about `frames_late` frames ago and found hidden
//   then. At the end of the frame all objects in the view are asked about, drawn or not, against
//   the finished depths. Objects that were not asked about then (new ones, ones that were outside
//   of the view or too near to the eye) are drawn.
// Guarantee: none (approximate): what comes into view from behind something is missing for
//   frames_late frames. While nothing moves, nothing is missing.
// Cost: O(n log n) for n candidates, and a question for each object in the view, in one batch: two
//   changes of state a frame. An engine reads the answers frames later; here the device forgets
//   them with the frame, so they are read when the frame is drawn, where everyone waits anyway.
// Limits: pops at every turn, cut and moving occluder. In a chain that offers a frame's objects in
//   several batches the depths are those of the batches so far.
// Sources: Unreal Engine 4 documentation (a frame late); OpenMW pull request 2399; Horde3D issue
//   199; Zachmann slide 61 (the assumption without the check).

#include "algorithms/occlusion/late_answers.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "occlusion.last_frame";
  info.family = "occlusion";
  info.summary =
      "Draws what was not found hidden some frames ago, and asks about everything in the view when "
      "the frame is drawn, for later frames.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {ParameterSpec::integer(
      "frames_late", 1, 1, 4, "frames", ParameterSpec::Stage::build,
      "by how many frames answers are late; so long is missing what comes into view")};
  info.cost = "O(n log n) for n candidates; a query for each object in the view, in one batch";
  info.limits =
      "What comes into view from behind something pops up frames_late frames late: at turns, cuts "
      "and where occluders move.";
  info.sources = {"Unreal Engine 4 documentation, visibility and occlusion culling",
                  "OpenMW pull request 2399; Horde3D issue 199"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry occlusion_last_frame() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<occlusion_culling::LateAnswers>(
                describe(), static_cast<std::size_t>(values.integer("frames_late")));
          }};
}

}  // namespace cullers
}  // namespace vislab
