// The city that software occlusion is compared on: 2,000 box buildings as occluders, 100,000 boxes
// as queries, 1024 x 512 pixels, eight views from the street and eight from above; and which boxes
// are seen in truth.
#pragma once

#include <string>
#include <vector>

#include "common/raster/depth_raster.h"
#include "common/scene/path.h"

namespace vislab {

class CityWorkload {
 public:
  static constexpr Viewport size{1024, 512};
  static constexpr std::size_t buildings = 2000;

  /// `views` is "street" or "elevated". Throws InputError if the scene cannot be loaded.
  explicit CityWorkload(const std::string& views);
  CityWorkload(const CityWorkload&) = delete;
  CityWorkload& operator=(const CityWorkload&) = delete;

  std::size_t view_count() const { return path_.frames.size(); }
  const Camera& camera(std::size_t view) const { return path_.frames[view].camera; }
  /// All buildings, in the order of ids.
  std::span<const RasterDraw> draws() const { return draws_; }
  /// The same as one mesh in the world, whose vertices are rounded to float.
  const RasterDraw& draw_of_all() const { return draw_of_all_; }
  /// Their places in draws() by the distance of their boxes from the eye of a view, nearest first.
  std::span<const std::uint32_t> near_first(std::size_t view) const { return near_first_[view]; }
  /// The boxes of draws().
  std::span<const BoxColumns> building_boxes() const { return building_boxes_; }
  /// The boxes that are asked about.
  const std::vector<Aabb>& boxes() const { return boxes_; }

  /// What is true of each box in a view.
  struct Truth {
    std::vector<bool> in_view;    // may cover a pixel
    std::vector<bool> visible;    // one of 4 x 4 samples a pixel of its faces is in front
    std::vector<bool> at_centre;  // a pixel's centre sees it without dispute
  };
  /// Takes some seconds the first time, for all views.
  const std::vector<Truth>& truth() const;

 private:
  Scene scene_;
  Path path_;
  RasterMesh mesh_, mesh_of_all_;
  std::vector<RasterDraw> draws_;
  RasterDraw draw_of_all_;
  std::vector<std::vector<std::uint32_t>> near_first_;
  std::vector<BoxColumns> building_boxes_;
  std::vector<Aabb> boxes_;
  mutable std::vector<Truth> truth_;
};

}  // namespace vislab
