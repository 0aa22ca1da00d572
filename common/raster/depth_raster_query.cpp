// What a DepthRaster is asked.
#include "common/raster/depth_raster.h"

namespace vislab {

bool DepthRaster::hides(const BoxWindow& box) const { return hides_rectangle(tiles_, box); }

bool DepthRaster::hides(const Aabb& box) const {
  BoxWindow place;
  switch (project_box(window_, box, options_.setup.coverage, place)) {
    case BoxPlace::outside:
      return true;
    case BoxPlace::undecided:
      return false;
    case BoxPlace::inside:
      break;
  }
  return hides_rectangle(tiles_, place) || hides_silhouette(tiles_, place, rays_.planes_of(box));
}

}  // namespace vislab
