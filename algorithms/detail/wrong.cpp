// detail.wrong: the mistakes that sources and engines made with the size of objects in the image,
// as negative controls.
//
// Idea: each variant measures objects in one documented wrong way and does everything else right.
// Guarantee: none (erroneous): objects that cover more than the threshold are left out.
// Cost: O(candidates), as detail.screen_size.
// Limits: that is what they are for.
// Sources: in the table.

#include <array>

#include "algorithms/detail/detail_culler.h"
#include "common/culler/mistakes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using detail_culling::DetailCuller;
using detail_culling::DetailSettings;
using detail_culling::SizeMeasure;

struct DetailMistake : Mistake {
  SizeMeasure measure;
};

constexpr std::array mistakes{
    DetailMistake{
        "printed_formula",
        "The projected sphere has the area pi (r n / d)^2, with d along the view's direction",
        "it is an ellipse, longer by 1 / cos of the angle off the axis, and its outline is seen "
        "from a distance that is not d but sqrt(d^2 - r^2): exact / printed is 1.73 at 54.7 "
        "degrees, 1.33 at r / d = 0.5 and 5.3 at 0.9",
        "leaves out objects of up to several times the threshold, at the sides of wide views and "
        "near the camera",
        "Zachmann, Computer-Graphik 2, SS 2012, slide 91", SizeMeasure::printed},
    DetailMistake{
        "near_plane_units", "An object is left out if pi (r n / d)^2 is less than N pixels",
        "that area is in square metres on the near plane, where a pixel is some millionth of one",
        "leaves out nearly everything",
        "Zachmann, Computer-Graphik 2, SS 2012, slides 90-91; cinder issue 1850",
        SizeMeasure::near_plane_units},
    DetailMistake{"inner_sphere",
                  "An object is as large as its radius says, and one without extent is small",
                  "what is thin in one direction is not small in the others",
                  "leaves out sheets, wires and walls however large they are",
                  "OpenSceneGraph pull request 795; gepetto-viewer pull request 52",
                  SizeMeasure::inner_sphere},
};

CullerInfo describe() {
  CullerInfo info;
  info.name = "detail.wrong";
  info.family = "detail";
  info.summary =
      "A negative control: detail culling with one of the wrong measures of size found in the "
      "sources and in engines.";
  info.guarantee = Guarantee::erroneous;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.parameters = detail_culling::threshold_parameters();
  info.parameters.push_back(error_parameter(mistakes));
  info.cost = "O(candidates)";
  info.limits = "Wrong on purpose: leaves out objects that cover more than the threshold.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 90-91",
                  "issues of engines, named with each mistake"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry detail_wrong() {
  return {describe(), [](const ParameterValues& values) {
            const DetailMistake& mistake = chosen_mistake(mistakes, values);
            DetailSettings settings = detail_culling::read_threshold(values);
            settings.measure = mistake.measure;
            return std::make_unique<DetailCuller>(info_of(describe(), mistake), settings);
          }};
}

}  // namespace cullers
}  // namespace vislab
