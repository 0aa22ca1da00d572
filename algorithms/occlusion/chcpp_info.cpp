#include "algorithms/occlusion/chcpp_info.h"

#include "algorithms/occlusion/tight_bounds.h"

namespace vislab::occlusion_culling {

CullerInfo chcpp_info() {
  constexpr auto build = ParameterSpec::Stage::build;
  constexpr auto query = ParameterSpec::Stage::query;
  CullerInfo info;
  info.name = "occlusion.chcpp";
  info.family = "occlusion";
  info.summary =
      "Draws what was visible, asks about hidden nodes of a hierarchy in batches that share "
      "queries, "
      "and now and then about what is visible.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {
      ParameterSpec::integer("leaf_triangles", 1000, 1, 100'000'000, "triangles", build,
                             "nodes with so many triangles, a draw counting as 20, are asked about "
                             "and drawn as a whole"),
      ParameterSpec::integer("batch", 50, 1, 10'000, "nodes", query,
                             "so many hidden nodes at most wait to be asked about in one go"),
      ParameterSpec::boolean(
          "lazy", true, query,
          "visible units are asked about again behind the hidden nodes; without, "
          "just before they are drawn, a change from drawing to asking each"),
      ParameterSpec::integer("interval", 4, 1, 1000, "frames", query,
                             "visible units are asked about again after so many frames"),
      ParameterSpec::choice(
          "retest", "random", {"random", "aligned"}, query,
          "the first time after a random part of the interval, or after all of it, "
          "so that what appeared together is asked about in one frame"),
      ParameterSpec::boolean("multiqueries", true, query,
                             "nodes that have been hidden for long share queries"),
      ParameterSpec::choice("cost_model", "paper", {"paper", "slides"}, query,
                            "by what multiqueries are grouped: expected queries, or triangles not "
                            "drawn against boxes asked about"),
      ParameterSpec::choice(
          "persistence", "formula", {"formula", "measured"}, query,
          "how likely hidden nodes stay hidden: 0.99 - 0.7 e^-t, or as counted on "
          "the path so far"),
      ParameterSpec::boolean("tight_bounds", true, build,
                             "units are asked about by the boxes of their parts"),
      ParameterSpec::real("sigma", 1.4, 1.0, 100.0, "", build,
                          "the parts' boxes have at most so many times the surface of the one box"),
      ParameterSpec::integer("max_boxes", 16, 1, TightBounds::most_boxes, "boxes", build,
                             "a unit has at most so many boxes, and fewer if it is light"),
      ParameterSpec::integer(
          "threshold_px", 0, 0, 1'000'000, "pixels", query,
          "nodes whose boxes show no more pixels than this are left out; above 0 "
          "small things vanish from the image")};
  info.cost = "O(visible nodes + hidden nodes beside them), and a query for a part of these";
  info.limits =
      "What shows by its boxes but not by itself is drawn. After a cut it knows nothing and waits "
      "for several rounds of answers. With threshold_px > 0 it is approximate.";
  info.sources = {"Mattausch, Bittner, Wimmer 2008, CHC++: Coherent Hierarchical Culling Revisited",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 64-75"};
  return info;
}

}  // namespace vislab::occlusion_culling
