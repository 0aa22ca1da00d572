// surface.bsp: the painter's algorithm, with the order from a tree of the polygons' own planes.
//
// Idea: the planes of the triangles divide space, and triangles that a plane cuts are cut there
//   (polygon_bsp.h). For any viewer the tree gives its fragments from back to front, to be drawn
//   one over the other without a depth test, or from front to back, where each is drawn only into
//   pixels that are still free, so that nothing is drawn twice. A fragment has the pixels of its
//   whole triangle that lie on its sides of the cuts: both sides of a cut ask the sign of one line,
//   so there are no cracks and no overlaps.
// Guarantee: image_exact as long as epsilon_m is 0, for interpenetrating and cyclically overlapping
//   triangles, too. approximate otherwise: what lies nearer to a plane than epsilon_m counts as
//   lying in it, and may come before what hides it.
// Cost: build O(n log n) fragments on average, O(n^2) at worst, and O(n^2) tests for solids, whose
//   trees are as deep as they have faces. A frame is O(fragments), and back to front the pixels of
//   all of them.
// Limits: static. Objects that stand elsewhere than when the tree was built are drawn after it,
// with
//   a depth test; the tree is never rebuilt. Scenes whose tree exceeds max_fragments are refused.
//   What is emitted is whole triangles in the order of their first fragments; for triangles that
//   were cut there may be no such order, so a device has to draw them with a depth test.
// Sources: textbook chapter 17, Culling (in German), 17.2.3, figures 17.5 to 17.7; Fuchs, Kedem and
//   Naylor 1980.

#include "algorithms/surface/bsp_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace surface;

CullerInfo describe() {
  CullerInfo info;
  info.name = "surface.bsp";
  info.family = "surface";
  info.summary =
      "Sorts fragments of triangles by a tree of the triangles' own planes and paints them back to "
      "front, or front to back into free pixels only; triangles that own a pixel are kept.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::hidden;
  info.space = Space::object;
  info.stage = PipelineStage::raster;
  info.parameters = {
      ParameterSpec::choice(
          "order", "back_to_front", {"back_to_front", "front_to_back"}, ParameterSpec::Stage::query,
          "back_to_front: the painter's, with overdraw; front_to_back: only into free pixels, "
          "nothing is drawn twice"),
      ParameterSpec::choice(
          "splitter", "sampled", {"first", "sampled"}, ParameterSpec::Stage::build,
          "whose plane divides next: first, as if triangles were inserted one after another; "
          "sampled, the one of eight that cuts least and halves best; first cuts more and makes "
          "deeper trees"),
      ParameterSpec::real(
          "epsilon_m", 0.0, 0.0, 1000.0, "m", ParameterSpec::Stage::build,
          "what is nearer to a plane than this counts as lying in it, on top of what rounding "
          "needs; more cuts less and confuses what is nearly coplanar"),
      ParameterSpec::integer("max_fragments", 1'000'000, 1, 100'000'000, "",
                             ParameterSpec::Stage::build,
                             "scenes whose tree gets larger than this are refused")};
  info.cost =
      "build O(n log n) fragments on average, O(n^2) at worst; a frame O(fragments) and their "
      "pixels";
  info.limits =
      "Static: objects that moved are drawn last, with a depth test. Refuses scenes whose tree "
      "exceeds max_fragments; solids of many faces make trees as deep as they have faces. With "
      "epsilon_m, nearly coplanar surfaces change places.";
  info.sources = {"Textbook chapter 17, Culling (in German), 17.2.3, figures 17.5-17.7",
                  "Fuchs, Kedem and Naylor 1980, On visible surface generation by a priori tree "
                  "structures"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry surface_bsp() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            BspPainter::Options options;
            options.order = values.choice("order") == "front_to_back"
                                ? BspPainter::Order::front_to_back
                                : BspPainter::Order::back_to_front;
            options.splitter = values.choice("splitter") == "first"
                                   ? PolygonBsp<3>::Splitter::first
                                   : PolygonBsp<3>::Splitter::sampled;
            options.epsilon_m = values.real("epsilon_m");
            options.max_fragments = static_cast<std::uint64_t>(values.integer("max_fragments"));
            CullerInfo info = describe();
            if (options.epsilon_m > 0.0) info.guarantee = Guarantee::approximate;
            return std::make_unique<BspPainter>(std::move(info), options);
          }};
}

}  // namespace cullers
}  // namespace vislab
