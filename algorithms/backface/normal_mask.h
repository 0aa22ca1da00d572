// The culler behind backface.normal_mask, for it and for the wrong variant that tests classes by
// their middle (backface.wrong).
#pragma once

#include <memory>

#include "algorithms/backface/direction_cube.h"
#include "common/culler/culler.h"

namespace vislab::backface_culling {

struct NormalMaskOptions {
  int n = 8;          // squares along an edge of the direction cube
  int sectors = 4;    // a side of the view
  bool open = false;  // test meshes that are not solid too
  ClassTest class_test = ClassTest::corners;
};

/// `info` as the culler describes itself. Throws InputError if n is not 1 … 18.
std::unique_ptr<ICuller> make_normal_mask(CullerInfo info, const NormalMaskOptions& options);

}  // namespace vislab::backface_culling
