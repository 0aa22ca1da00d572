// What is left of the view is a convex polygon in the image, cut by each portal's image.
#pragma once

#include "algorithms/portal/portal_images.h"

namespace vislab::portal_culling {

class PolygonRule {
 public:
  using View = ImageWindow;

  void build(const PortalGraph& graph) { images_.build(graph); }
  void start(const Camera& camera) { images_.start(camera); }
  void whole(View& view) const {
    ImagePolygon image;
    image.set(images_.map().whole());
    view.set(image);
  }
  bool narrow(std::uint32_t opening, const View& view, View& left) {
    const ImagePolygon* image = images_.image(opening);
    return image != nullptr && image->bounds().overlaps(view.bounds()) &&
           left.set_part(*image, view);
  }
  void prepare(const View& view) { planes_.set(images_.map(), view); }
  bool meets(const Aabb& box) const { return planes_.meets(box); }
  std::size_t bytes() const { return images_.bytes(); }

 private:
  PortalImages images_;
  WindowPlanes planes_;
};

}  // namespace vislab::portal_culling
