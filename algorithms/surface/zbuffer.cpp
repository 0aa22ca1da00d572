// surface.zbuffer: every pixel keeps the nearest depth so far and whose it is.
//
// Idea: for each triangle and each pixel that it covers, the depth there, z = -(Ax + By + D) / C,
//   which is linear in the window, is compared with the one kept; the nearer stays. The depth is
//   computed in double and kept as bits says: as an integer of 16, 24 or 32 bits, or as a float.
//   Textbook and thesis have opposite conventions: in the textbook greater is nearer and the buffer
//   starts at 0 (reversed), in the thesis smaller is nearer and it starts at 1 (standard).
// Guarantee: by what is kept. image_exact for float reversed: its steps are 2^-24 of the depth or
//   less, far below the relative difference that the judge excuses, 1e-4. approximate for the
//   others, whose steps do not shrink with the depth. Near 1 it is 1 - near / z, so that a relative
//   difference of 1e-4 is 1e-4 near / z there, which is a step of 2^-bits at z = 1e-4 2^bits near:
//   surfaces that differ by more change places beyond that. Float standard has steps of 2^-24.
// Cost: O(pixels of all candidates); 16 bytes a pixel here, for depths are held as double.
// Limits: every surface that covers a pixel costs a test there, seen or not. Needs no order, and
//   takes interpenetration and cycles as they come.
// Sources: textbook chapter 17, Culling (in German), 17.2.1; Kowalka 2016, 2.4.1.

#include "algorithms/surface/zbuffer_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace surface;

CullerInfo describe() {
  CullerInfo info;
  info.name = "surface.zbuffer";
  info.family = "surface";
  info.summary =
      "Every pixel keeps the nearest depth so far and the triangle that it belongs to; triangles "
      "that own a pixel in the end are kept.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.parameters = {
      ParameterSpec::choice(
          "bits", "32", {"16", "24", "32", "float"}, ParameterSpec::Stage::build,
          "what a depth is kept in: an integer of so many bits, or a float; with fewer, surfaces "
          "far away change places"),
      ParameterSpec::choice(
          "convention", "standard", {"standard", "reversed"}, ParameterSpec::Stage::build,
          "standard: 0 is near and smaller is nearer; reversed: 1 is near and greater is nearer, "
          "which matters for floats, as they are finest around 0")};
  info.cost = "O(pixels that candidates cover): a test each";
  info.limits =
      "Every surface in a pixel costs a test, seen or not. Depths that differ by a part in 10,000 "
      "are confused beyond 2^bits / 10,000 times the near distance, as follows from the steps of "
      "what is kept; float standard is as 24 bits there.";
  info.sources = {"Textbook chapter 17, Culling (in German), 17.2.1",
                  "Kowalka 2016 (thesis, HAW Hamburg), 2.4.1"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry surface_zbuffer() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            const std::string& bits = values.choice("bits");
            DepthFormat format;
            format.bits = bits == "float" ? 0 : std::stoi(bits);
            format.convention = values.choice("convention") == "reversed"
                                    ? DepthConvention::reversed
                                    : DepthConvention::standard;
            CullerInfo info = describe();
            const bool fine_float = bits == "float" && values.choice("convention") == "reversed";
            if (fine_float) info.guarantee = Guarantee::image_exact;
            return std::make_unique<ZBuffer>(
                std::move(info), ZBuffer::Rules{format, format.convention, format.convention});
          }};
}

}  // namespace cullers
}  // namespace vislab
