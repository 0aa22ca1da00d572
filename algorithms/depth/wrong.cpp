// depth.wrong: the mistakes that sources and engines made with depths, as negative controls.
//
// Idea: each variant makes one documented mistake and does everything else right, so that its
//   damage can be measured, and so that the judge is seen to find it.
// Guarantee: none (erroneous). The table below says of each what its source says or does, what is
//   wrong with it, and what comes of it.
// Cost: O(n log n) for n candidates and the pixels of what is drawn; none of them has a hierarchy
//   but those of the horizon.
// Limits: that is what they are for.
// Sources: in the table.

#include <array>

#include "algorithms/depth/horizon_culler.h"
#include "algorithms/depth/wrong_buffers.h"
#include "common/culler/mistakes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace depth_culling;

struct DepthMistake : Mistake {
  std::unique_ptr<ICuller> (*make)(CullerInfo info, const ParameterValues& values);
};

template <MakeWrongBuffer maker>
std::unique_ptr<ICuller> buffer(CullerInfo info, const ParameterValues& values) {
  return maker(std::move(info), {static_cast<int>(values.integer("bits")), values.real("growth")});
}

std::unique_ptr<ICuller> bounding_rectangle(CullerInfo info, const ParameterValues&) {
  HorizonOptions options;
  options.cover = HorizonOptions::Cover::around;
  return std::make_unique<HorizonCuller>(std::move(info), options);
}

std::unique_ptr<ICuller> unsorted(CullerInfo info, const ParameterValues& values) {
  HorizonOptions options;
  options.distance_error = values.real("noise");
  return std::make_unique<HorizonCuller>(std::move(info), options);
}

constexpr std::array mistakes{
    DepthMistake{{"bounding_rectangle",
                  "An object that is taken for visible joins the axis-aligned rectangle around its "
                  "projection to the occlusion horizon",
                  "the rectangle holds pixels that the object does not cover",
                  "leaves out what is seen past the corners of everything that is no upright "
                  "rectangle in the image",
                  "Zachmann slide 46"},
                 bounding_rectangle},
    DepthMistake{{"unsorted",
                  "Objects join the occlusion horizon in an order that is only roughly from near "
                  "to far",
                  "what the horizon holds then may lie behind what is tested",
                  "leaves out near objects before which far ones were joined, more of them the "
                  "rougher the order (noise)",
                  "Zachmann slides 44-46, whose order is taken for granted"},
                 unsorted},
    DepthMistake{{"npot_floor",
                  "Each level of the Z-pyramid has half the size of the one below, rounded down",
                  "the last row and column of a level of odd size are in no texel above it",
                  "leaves out what is seen at the upper and right border of images whose size is "
                  "not a power of two, and inside of them",
                  "bevy issue 14062, pull requests 12884 and 22603"},
                 buffer<make_npot_floor>},
    DepthMistake{{"update_backwards",
                  "When a value of the Z-pyramid is overwritten, the one above it changes only if "
                  "the new one is farther",
                  "what is drawn comes nearer: a parent changes if the overwritten value was its "
                  "farthest",
                  "leaves out nothing that is seen, but finds next to nothing hidden: parents stay "
                  "at the far plane",
                  "Kowalka 2016, 2.4.2"},
                 buffer<make_update_backwards>},
    DepthMistake{
        {"wrong_reduction", "A texel of the Z-pyramid holds the greatest value of those below it",
         "where greater is nearer (reversed depth) the greatest is the nearest of them",
         "leaves out whatever has something nearer beside it, more of it the larger it is "
         "in the image",
         "NovusCore pull request 26"},
        buffer<make_wrong_reduction>},
    DepthMistake{{"quantised",
                  "Depths are kept in whole numbers of `bits` bits, and what is not nearer by one "
                  "is hidden",
                  "far from the eye a step is many metres, and what lies within one is taken to "
                  "have the same depth",
                  "leaves out far things that stand before others, more of them the farther the "
                  "far plane is in distances of the near one",
                  "16-bit depths with the comparison `less`; NovusCore pull request 26"},
                 buffer<make_quantised>},
    DepthMistake{
        {"near_plane_projected", "The rectangle of a box is that around its corners divided by |w|",
         "a corner behind the eye has no position in the image; divided so, it is "
         "mirrored to where the box is not",
         "leaves out boxes about the eye, such as the ground, behind a wall before it",
         "niagara issue 17; MaskedOcclusionCulling issue 12"},
        buffer<make_near_plane_projected>},
    DepthMistake{
        {"euclidean_nearest", "A box has the depth of its point nearest to the eye",
         "depth is measured along the view, and beside its middle another corner may lie before "
         "that point",
         "leaves out long boxes at the image's sides, more of them the longer they are",
         "Godot issues 94210 and 106184, pull requests 97712 and 108347"},
        buffer<make_euclidean_nearest>},
    DepthMistake{{"depth_by_w", "Nearness is the inverse of w, in every view",
                  "in a parallel view w is 1 for all, and what is not nearer is hidden",
                  "leaves out, in parallel views, what stands on or before something that reaches "
                  "nearer elsewhere, such as the ground",
                  "Godot issue 113329; MaskedOcclusionCulling issue 12"},
                 buffer<make_depth_by_w>},
    DepthMistake{{"loose_bounds",
                  "What is asked is not the object's own box but a larger one (growth times as "
                  "large), as of a sphere around it",
                  "a looser bound is seen more often",
                  "leaves out nothing that is seen, but finds less hidden",
                  "zeux 2023, Approximate projected bounds"},
                 buffer<make_loose_bounds>},
    DepthMistake{{"centres_at_reduced_size",
                  "Occluders are drawn at a quarter of the image's size like an image, a pixel "
                  "counting as covered if its centre is",
                  "a pixel of the buffer is 4 x 4 of the image, of which some are not covered",
                  "leaves out what is seen through gaps and past edges of less than four pixels",
                  "against the inner-conservative rasterising of Masked Software Occlusion "
                  "Culling, section 1"},
                 buffer<make_centres_at_reduced_size>},
    DepthMistake{{"rounded_outward", "Occluders cover every pixel that they touch",
                  "a pixel whose centre they leave free shows what is behind them",
                  "leaves out what is seen past edges and through gaps, up to a pixel wide",
                  "against Masked Software Occlusion Culling, \"Precision\""},
                 buffer<make_rounded_outward>},
    DepthMistake{
        {"grown_occluders",
         "Occluders are drawn from simplified meshes, which may stand out of the true "
         "ones (by `growth` metres)",
         "they cover what the true ones do not", "leaves out what is seen past their edges",
         "Masked Software Occlusion Culling, section 1; Godot documentation, occlusion "
         "culling; Terrain3D issue 301"},
        buffer<make_grown_occluders>},
    DepthMistake{{"boxes_as_occluders",
                  "Occluders are drawn as opaque, whatever shows through them: here, as their "
                  "boxes",
                  "holes, cut out by alpha or by geometry, let one see through",
                  "leaves out what is seen through holes",
                  "GothicVR issue 235; Godot issue 91030; GeometryFX issue 5"},
                 buffer<make_boxes_as_occluders>},
    DepthMistake{
        {"one_phase", "Objects are tested against the depths of the last frame, as they are",
         "what hid something then may have moved away, or the thing itself into view",
         "leaves out for a frame what comes into view behind something that moves",
         "skyrim-community-shaders issue 1508; vulkan-guide issue 76"},
        buffer<make_one_phase>},
    DepthMistake{
        {"stale_occluders", "Occluders are those of the scene as it was built",
         "they may be hidden or elsewhere now", "leaves out what is seen where an occluder was",
         "Godot issue 70373, demonstration pull request 807"},
        buffer<make_stale_occluders>},
};

CullerInfo describe() {
  constexpr auto build = ParameterSpec::Stage::build;
  CullerInfo info;
  info.name = "depth.wrong";
  info.family = "depth";
  info.summary =
      "A negative control: occlusion culling by software depths that makes one of the mistakes "
      "found in the sources and in engines.";
  info.guarantee = Guarantee::erroneous;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.parameters = {
      error_parameter(mistakes),
      ParameterSpec::real("noise", 0.3, 0.0, 0.99, "", build,
                          "unsorted: by which share of its distance an object may be taken for "
                          "nearer or farther than it is; the others do without"),
      ParameterSpec::integer("bits", 16, 4, 32, "", build,
                             "quantised: of a depth value; the others do without"),
      ParameterSpec::real("growth", 1.0, 0.0, 1000.0, "", build,
                          "grown_occluders: by how many metres occluders are too large on each "
                          "side; loose_bounds: how many times as large as the box; the others do "
                          "without")};
  info.cost = "O(n log n) for n candidates, and the pixels of what is drawn";
  info.limits = "Wrong on purpose: leaves out what is seen, or finds less hidden than it should.";
  info.sources = {"Kowalka 2016 (thesis, HAW Hamburg)", "Zachmann, Computer-Graphik 2, SS 2012",
                  "Hasselgren, Andersson, Akenine-Moeller 2016, Masked Software Occlusion Culling",
                  "issues of engines, named with each mistake"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry depth_wrong() {
  return {describe(), [](const ParameterValues& values) {
            const DepthMistake& mistake = chosen_mistake(mistakes, values);
            return mistake.make(info_of(describe(), mistake), values);
          }};
}

}  // namespace cullers
}  // namespace vislab
