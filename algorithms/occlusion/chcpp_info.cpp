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
      ParameterSpec::integer("leaf_triangles", 100, 1, 100'000'000, "triangles", build,
                             "nodes with so many triangles, a draw counting as 20, are asked about "
                             "and drawn as a whole"),
      ParameterSpec::integer("batch", 40, 1, 10'000, "nodes", query,
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
      ParameterSpec::real("box_cost", 0.1, 0.0, 1000.0, "", query,
                          "of the slides' cost model (c1): what a box costs, as a share of what a "
                          "query costs besides"),
      ParameterSpec::choice(
          "persistence", "formula", {"formula", "measured"}, query,
          "how likely hidden nodes stay hidden: 0.99 - 0.7 e^-t, or as counted on "
          "the path so far"),
      ParameterSpec::boolean("tight_bounds", true, build,
                             "units are asked about by the boxes of their parts"),
      ParameterSpec::real("sigma", 1.0, 1.0, 100.0, "", build,
                          "the parts' boxes have at most so many times the surface of the one box"),
      ParameterSpec::integer("max_boxes", 16, 1, TightBounds::most_boxes, "boxes", build,
                             "a unit has at most so many boxes, and fewer if it is light"),
      ParameterSpec::choice("division", "least_room", {"least_room", "finest"}, build,
                            "of the divisions into boxes that sigma allows: the one with the least "
                            "room in its boxes, or the last, as in the paper"),
      ParameterSpec::integer(
          "threshold_px", 0, 0, 1'000'000, "pixels", query,
          "nodes whose boxes together show no more samples than this are left out; a pixel that "
          "several of them cover counts for each; above 0 small things vanish from the image"),
      ParameterSpec::boolean("open_unasked", true, query,
                             "a hidden node whose box shows is opened unasked until its next test; "
                             "without, it is asked about in every frame"),
      ParameterSpec::boolean("reask", true, query,
                             "of many units found visible together the nearer half is drawn and "
                             "the rest asked about again"),
      ParameterSpec::boolean("skip_vain", true, query,
                             "nodes of which nothing is known are drawn unasked while hardly any "
                             "answer of the frame was hidden"),
      ParameterSpec::boolean("sleep", true, query,
                             "after frames in which hardly anything was hidden, the next ones are "
                             "drawn without a question"),
      ParameterSpec::integer("hand_over_triangles", 30'000, 0, 1'000'000'000, "triangles", query,
                             "so much drawn geometry is handed over to the device at once, so that "
                             "it works while the walk goes on; 0: only before questions")};
  info.cost = "O(visible nodes + hidden nodes beside them), and a query for a part of these";
  info.limits =
      "What shows by its boxes but not by itself is drawn. After a cut it knows nothing and waits "
      "for several rounds of answers. With threshold_px > 0 it is approximate.";
  info.sources = {"Mattausch, Bittner, Wimmer 2008, CHC++: Coherent Hierarchical Culling Revisited",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 64-75"};
  return info;
}

}  // namespace vislab::occlusion_culling
