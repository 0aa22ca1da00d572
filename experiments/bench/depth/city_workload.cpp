#include "experiments/bench/depth/city_workload.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/geometry/rounding.h"
#include "common/scene/library.h"

namespace vislab {
namespace {

// Of the judge: nearer to an edge, or to what is behind, a sample is disputed.
constexpr double disputed_px = 1.0 / 128.0;
constexpr float disputed_depth = 1e-4F;

/// Is a sample of a placed cube's faces in front of the buffer? Disputed ones count only if
/// `disputes` is false.
bool in_front(const DepthRaster& raster, const Mesh& mesh, const glm::dmat4x3& place,
              bool disputes) {
  const WindowRows rows = raster.window().mesh(place);
  std::array<SetupTriangle, max_setup_pieces> pieces;
  for (const glm::uvec3& corners : mesh.triangles) {
    const auto at = [&](int i) { return rows(mesh.positions[corners[i]]); };
    const SetupResult result =
        set_up_triangle(raster.window(), {at(0), at(1), at(2)}, 0, {}, pieces);
    for (int piece = 0; piece < result.count; ++piece) {
      const SetupTriangle& triangle = pieces[static_cast<std::size_t>(piece)];
      std::array<double, 3> least{};
      for (std::size_t i = 0; i < 3 && disputes; ++i) {
        const WindowEdge& edge = triangle.edges[i];
        least[i] = disputed_px * std::hypot(double(edge.a), double(edge.b));
      }
      bool found = false;
      for_each_covered_pixel(triangle, [&](int x, int y, float nearness) {
        for (std::size_t i = 0; i < 3; ++i) {
          if (static_cast<double>(triangle.edges[i].at(x, y)) < least[i]) return;
        }
        const float margin = disputes ? 1.0F + disputed_depth : 1.0F;
        found = found || nearness > raster.nearness(x, y) * margin;
      });
      if (found) return true;
    }
  }
  return false;
}

}  // namespace

CityWorkload::CityWorkload(const std::string& views) {
  const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  const DataFolders folders{data, data / "cache"};
  scene_ = load_scene("city_100k", folders).scene;
  path_ = load_path("city_" + views + "_8", scene_, size, 0, folders);
  mesh_ = RasterMesh(scene_.meshes[0]);
  const Aabb cube = bounds_of(scene_.meshes[0].positions);
  std::vector<Aabb> bounds;
  for (const Object& object : scene_.objects) {
    bounds.push_back(transformed(cube, object.transform));
  }
  boxes_.assign(bounds.begin() + buildings, bounds.end());
  const auto triangles = static_cast<std::uint32_t>(scene_.meshes[0].triangles.size());
  for (std::uint32_t i = 0; i < buildings; ++i) {
    draws_.push_back({&mesh_, &scene_.objects[i].transform, 0, triangles, i * triangles, true});
  }
  Mesh all;
  building_boxes_.resize((buildings + BoxColumns::width - 1) / BoxColumns::width);
  for (std::size_t i = 0; i < buildings; ++i) {
    building_boxes_[i / BoxColumns::width].put(i % BoxColumns::width, bounds[i]);
    const auto base = static_cast<std::uint32_t>(all.positions.size());
    for (const glm::vec3& position : scene_.meshes[0].positions) {
      const glm::dvec3 p = scene_.objects[i].transform * glm::dvec4(position, 1.0);
      all.positions.emplace_back(rounded_to_float(p));
    }
    for (const glm::uvec3& corners : scene_.meshes[0].triangles) {
      all.triangles.push_back(corners + base);
    }
  }
  mesh_of_all_ = RasterMesh(all);
  static const glm::dmat4x3 in_world(1.0);
  draw_of_all_ = {&mesh_of_all_, &in_world, 0, static_cast<std::uint32_t>(all.triangles.size()), 0,
                  true};
  for (const PathFrame& frame : path_.frames) {
    std::vector<double> distances;
    for (std::size_t i = 0; i < buildings; ++i) {
      distances.push_back(distance_squared(bounds[i], frame.camera.pose.eye));
    }
    std::vector<std::uint32_t>& order = near_first_.emplace_back(buildings);
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(
        order, [&](std::uint32_t a, std::uint32_t b) { return distances[a] < distances[b]; });
  }
}

const std::vector<CityWorkload::Truth>& CityWorkload::truth() const {
  if (!truth_.empty()) return truth_;
  DepthRaster fine({4 * size.width, 4 * size.height}, {}), image(size, {});
  for (std::size_t view = 0; view < view_count(); ++view) {
    Truth& truth = truth_.emplace_back();
    for (DepthRaster* raster : {&fine, &image}) {
      raster->begin(camera(view));
      raster->draw(draws_);
    }
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      BoxWindow window;
      const bool in_view = project_box(image.window(), boxes_[i], Coverage::whole_pixels, window) !=
                           BoxPlace::outside;
      const glm::dmat4x3& place = scene_.objects[buildings + i].transform;
      truth.in_view.push_back(in_view);
      truth.visible.push_back(in_view && in_front(fine, scene_.meshes[0], place, false));
      truth.at_centre.push_back(in_view && in_front(image, scene_.meshes[0], place, true));
    }
  }
  return truth_;
}

}  // namespace vislab
