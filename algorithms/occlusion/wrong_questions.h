// Query methods that get one step wrong each: what occlusion.wrong is made of. The table there says
// what is wrong with each and where it comes from.
#pragma once

#include <memory>

#include "common/culler/culler.h"

namespace vislab::occlusion_culling {

std::unique_ptr<ICuller> make_near_box_asked(CullerInfo info);
std::unique_ptr<ICuller> make_unenlarged_boxes(CullerInfo info);
std::unique_ptr<ICuller> make_at_least_threshold(CullerInfo info);
std::unique_ptr<ICuller> make_stale_answers(CullerInfo info);
std::unique_ptr<ICuller> make_recycled_handles(CullerInfo info);
std::unique_ptr<ICuller> make_never_pops(CullerInfo info);

}  // namespace vislab::occlusion_culling
