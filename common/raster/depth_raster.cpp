#include "common/raster/depth_raster.h"

#include <algorithm>

namespace vislab {

RasterMesh::RasterMesh(const Mesh& mesh) : positions_(mesh.positions), triangles_(mesh.triangles) {
  for (const glm::uvec3& triangle : triangles_) {
    for (int i = 0; i < 3; ++i) bounds_.extend(positions_[triangle[i]]);
  }
}

std::size_t RasterMesh::bytes() const {
  return positions_.capacity() * sizeof(glm::vec3) + triangles_.capacity() * sizeof(glm::uvec3);
}

DepthRaster::DepthRaster(const Viewport& size, const RasterOptions& options)
    : options_(options), window_(Camera{}, size), tiles_(size, options.ids) {}

void DepthRaster::begin(const Camera& camera) {
  window_ = WindowTransform(camera, window_.viewport());
  tiles_.clear(static_cast<float>(window_.nearness(camera.lens.far_m)));
}

float DepthRaster::nearness(int x, int y) const {
  return tiles_.nearness(tiles_.index(x / tile_size, y / tile_size), x % tile_size, y % tile_size);
}

std::uint32_t DepthRaster::id(int x, int y) const {
  return tiles_.id(tiles_.index(x / tile_size, y / tile_size), x % tile_size, y % tile_size);
}

std::size_t DepthRaster::draw(std::span<const RasterDraw> draws) {
  std::size_t drawn = 0;
  for (const RasterDraw& draw_call : draws) {
    const WindowRows rows = window_.mesh(*draw_call.transform);
    const bool mirrored = glm::determinant(glm::dmat3(*draw_call.transform)) < 0.0;
    const auto positions = draw_call.mesh->positions();
    const auto triangles = draw_call.mesh->triangles();
    for (std::uint32_t i = 0; i < draw_call.count; ++i) {
      const glm::uvec3& corners = triangles[draw_call.first + i];
      std::array<SetupTriangle, max_setup_pieces> pieces;
      const SetupResult result = set_up_triangle(
          window_,
          {rows(positions[corners.x]), rows(positions[corners.y]), rows(positions[corners.z])},
          draw_call.first_id + i, options_.setup, pieces);
      const Facing back = mirrored ? Facing::front : Facing::back;
      if (draw_call.front_only && result.facing == back) continue;
      for (int piece = 0; piece < result.count; ++piece) {
        draw(pieces[static_cast<std::size_t>(piece)]);
      }
      drawn += result.count > 0 ? 1 : 0;
    }
  }
  return drawn;
}

void DepthRaster::draw(const SetupTriangle& triangle) {
  for_each_covered_pixel(triangle, [&](int x, int y, float nearness) {
    const std::size_t tile = tiles_.index(x / tile_size, y / tile_size);
    tiles_.store(x / tile_size, y / tile_size);
    const int at = (y % tile_size) * tile_size + x % tile_size;
    float& pixel = tiles_.pixels(tile)[at];
    if (nearness <= pixel) return;
    pixel = nearness;
    tiles_.nearest()[tile] = std::max(tiles_.nearest()[tile], nearness);
    if (tiles_.has_ids()) tiles_.ids(tile)[at] = triangle.id;
  });
}

bool DepthRaster::hides(const BoxWindow& box) const {
  for (int y = box.y0; y < box.y1; ++y) {
    for (int x = box.x0; x < box.x1; ++x) {
      if (!(nearness(x, y) > box.nearness)) return false;
    }
  }
  return true;
}

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
  return hides(place);
}

std::size_t DepthRaster::bytes() const { return tiles_.bytes(); }

}  // namespace vislab
