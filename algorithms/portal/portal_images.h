// The portals' images, found when they are first asked for in a frame.
#pragma once

#include <cstdint>
#include <vector>

#include "algorithms/portal/image_window.h"
#include "algorithms/portal/portal_graph.h"

namespace vislab::portal_culling {

class PortalImages {
 public:
  void build(const PortalGraph& graph) {
    graph_ = &graph;
    images_.resize(graph.opening_count());
    found_.assign(graph.opening_count(), 0);
    frame_ = 0;
  }

  void start(const Camera& camera) {
    map_.set(camera);
    if (++frame_ != 0) return;
    found_.assign(found_.size(), 0);
    frame_ = 1;
  }

  const ImageMap& map() const { return map_; }

  /// Null if no part of it lies behind the near plane. For portals that lead on (portal_walk.h).
  const ImagePolygon* image(std::uint32_t opening) {
    ImagePolygon& image = images_[opening];
    if (found_[opening] != frame_) {
      found_[opening] = frame_;
      if (!map_.image_of(graph_->corners(graph_->opening(opening)), image)) image.clear();
    }
    return image.size() == 0 ? nullptr : &image;
  }

  std::size_t bytes() const {
    return images_.capacity() * sizeof(ImagePolygon) + found_.capacity() * sizeof(std::uint32_t);
  }

 private:
  const PortalGraph* graph_ = nullptr;
  ImageMap map_;
  std::uint32_t frame_ = 0;
  std::vector<ImagePolygon> images_;  // by opening
  std::vector<std::uint32_t> found_;  // by opening: the frame of its image
};

}  // namespace vislab::portal_culling
