// The first wrong pixel of a culler's answer: where it is, what should be seen there, and a
// picture.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/culler/visible_set.h"
#include "common/render/png.h"
#include "experiments/contract/scenario.h"

namespace vislab {

/// Who judges what is seen: rays, at pixel centres and jittered samples, or images of a device.
enum class SeenBy { rays, device };

struct Witness {
  std::string scene;
  std::size_t frame = 0;
  /// Of the sample, pixels from the lower left corner of the image; its pixel is the whole part.
  glm::dvec2 window_px{0.0};
  TriangleId triangle = none_id;  // that should be seen; none_id: the background
  ObjectId object = none_id;      // that it belongs to
  TriangleId instead = none_id;   // what is seen without what was left out
  std::uint64_t wrong_px = 0;     // pixel centres of the frame that are wrong, undisputed
  /// The frame as it should be, as it is without what was left out, and where that is wrong.
  Image picture;
};

/// The first wrong pixel, row by row from the lower left, if only the triangles in `drawn` are
/// drawn, without the backs of `one_sided` objects (device only). If no pixel centre is wrong but
/// jittered samples are, the first of these; if all of them are disputed, the first disputed one.
/// Nothing if no sample is lost. `title` heads the picture. O(pixels) rays or two images.
std::optional<Witness> find_witness(Scenario& scenario, std::size_t frame, const VisibleSet& drawn,
                                    std::span<const ObjectId> one_sided, SeenBy judge,
                                    const std::string& title);

}  // namespace vislab
