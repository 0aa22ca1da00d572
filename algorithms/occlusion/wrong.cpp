// occlusion.wrong: the mistakes that sources and engines made with queries, as negative controls.
//
// Idea: each variant makes one documented mistake and does everything else right, so that its
//   damage can be measured, and so that the judge is seen to find it.
// Guarantee: none (erroneous). The table below says of each what its source says or does, what is
//   wrong with it, and what comes of it.
// Cost: O(n log n) for n candidates, and a query with its wait for each.
// Limits: that is what they are for.
// Sources: in the table.

#include <array>

#include "algorithms/occlusion/wrong_questions.h"
#include "common/culler/mistakes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace occlusion_culling;

struct QueryMistake : Mistake {
  std::unique_ptr<ICuller> (*make)(CullerInfo info);
};

constexpr std::array mistakes{
    QueryMistake{{"near_box_asked",
                  "Every box in the view is asked about, also one that holds the eye or is cut by "
                  "the near plane",
                  "of such a box no face, or not all of one, is drawn: no samples say nothing",
                  "leaves out what the eye stands in or right before",
                  "MinSG, handleCameraInBox; Babylon.js issue 3552"},
                 make_near_box_asked},
    QueryMistake{{"unenlarged_boxes", "The object's own box is asked about, as it is",
                  "devices round corners to a grid and depths to floats: a box may come out "
                  "smaller than what is in it",
                  "leaves out single pixels at the borders of objects whose box is as tight as "
                  "a slab or a wall's",
                  "reasoned: no report known"},
                 make_unenlarged_boxes},
    QueryMistake{{"at_least_threshold",
                  "An object is drawn if its query has at least as many samples as the threshold",
                  "with a threshold of 0 that is always so; more than the threshold is meant",
                  "leaves out nothing that is seen, but culls nothing either",
                  "Zachmann slide 60, against slides 57 and 63"},
                 make_at_least_threshold},
    QueryMistake{{"stale_answers",
                  "Queries are used again from frame to frame by their number, and an answer that "
                  "is there is taken",
                  "it is the answer of the last frame's question of that number, about another "
                  "object",
                  "leaves out objects that come at the place of one that was hidden",
                  "webgl2examples pull request 2 (availability that is not the present query's)"},
                 make_stale_answers},
    QueryMistake{{"recycled_handles",
                  "Answers are kept by slot, and the slot of an object that is gone is given to "
                  "the next that appears",
                  "nothing tells the new object from the old: it inherits that it was hidden",
                  "leaves out objects in the first frame in which they are shown",
                  "cesium-unreal pull request 928"},
                 make_recycled_handles},
    QueryMistake{{"never_pops",
                  "The lecture's listing: the front of the list is asked about and drawn, and "
                  "answers are processed, until list and queue are empty",
                  "the front is never taken off the list, so the loop does not end (here it does, "
                  "after as many turns as there are objects: counter step_limits)",
                  "leaves out everything behind the nearest object", "Zachmann slides 62-63"},
                 make_never_pops},
};

CullerInfo describe() {
  CullerInfo info;
  info.name = "occlusion.wrong";
  info.family = "occlusion";
  info.summary =
      "A negative control: occlusion queries with one of the mistakes found in the sources and in "
      "engines.";
  info.guarantee = Guarantee::erroneous;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {error_parameter(mistakes)};
  info.cost = "O(n log n) for n candidates, and a query with its wait for each";
  info.limits = "Wrong on purpose: leaves out what is seen, or culls nothing.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012",
                  "issues of engines, named with each mistake"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry occlusion_wrong() {
  return {describe(), [](const ParameterValues& values) {
            const QueryMistake& mistake = chosen_mistake(mistakes, values);
            return mistake.make(info_of(describe(), mistake));
          }};
}

}  // namespace cullers
}  // namespace vislab
