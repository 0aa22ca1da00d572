// The mistakes of depth.wrong that are made with a depth buffer. All of them test objects from near
// to far and draw what they keep, at full size and without a hierarchy; each gets one thing wrong.
#pragma once

#include <memory>

#include "common/culler/culler.h"

namespace vislab::depth_culling {

struct WrongSettings {
  int bits = 16;        // quantised: of a depth value
  double growth = 1.0;  // grown_occluders: metres; loose_bounds: times the box
};

using MakeWrongBuffer = std::unique_ptr<ICuller> (*)(CullerInfo info,
                                                     const WrongSettings& settings);

// Z-pyramids.
std::unique_ptr<ICuller> make_npot_floor(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_update_backwards(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_wrong_reduction(CullerInfo info, const WrongSettings& settings);
// What is asked.
std::unique_ptr<ICuller> make_near_plane_projected(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_euclidean_nearest(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_loose_bounds(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_depth_by_w(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_quantised(CullerInfo info, const WrongSettings& settings);
// What is drawn.
std::unique_ptr<ICuller> make_centres_at_reduced_size(CullerInfo info,
                                                      const WrongSettings& settings);
std::unique_ptr<ICuller> make_rounded_outward(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_grown_occluders(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_boxes_as_occluders(CullerInfo info, const WrongSettings& settings);
// When.
std::unique_ptr<ICuller> make_one_phase(CullerInfo info, const WrongSettings& settings);
std::unique_ptr<ICuller> make_stale_occluders(CullerInfo info, const WrongSettings& settings);

}  // namespace vislab::depth_culling
