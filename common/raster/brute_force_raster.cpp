#include "common/raster/brute_force_raster.h"

#include <algorithm>

namespace vislab {

BruteForceRaster::BruteForceRaster(const Viewport& size, const SetupOptions& options)
    : options_(options), window_(Camera{}, size) {
  nearness_.resize(pixel(0, size.height));
  ids_.resize(nearness_.size());
}

void BruteForceRaster::begin(const Camera& camera) {
  window_ = WindowTransform(camera, window_.viewport());
  std::ranges::fill(nearness_, static_cast<float>(window_.nearness(camera.lens.far_m)));
  std::ranges::fill(ids_, none_id);
}

std::size_t BruteForceRaster::draw(std::span<const RasterDraw> draws) {
  std::size_t drawn = 0;
  for (const RasterDraw& draw_call : draws) {
    const WindowRows rows = window_.mesh(*draw_call.transform);
    const bool mirrored = glm::determinant(glm::dmat3(*draw_call.transform)) < 0.0;
    const Facing back = mirrored ? Facing::front : Facing::back;
    const auto positions = draw_call.mesh->positions();
    for (std::uint32_t i = 0; i < draw_call.count; ++i) {
      const glm::uvec3& corners = draw_call.mesh->triangles()[draw_call.first + i];
      const std::array<WindowPoint, 3> points{
          rows(positions[corners.x]), rows(positions[corners.y]), rows(positions[corners.z])};
      std::array<SetupTriangle, max_setup_pieces> pieces;
      const SetupResult result =
          set_up_triangle(window_, points, draw_call.first_id + i, options_, pieces);
      if (draw_call.front_only && result.facing == back) continue;
      for (int piece = 0; piece < result.count; ++piece) {
        const SetupTriangle& triangle = pieces[static_cast<std::size_t>(piece)];
        for_each_covered_pixel(triangle, [&](int x, int y, float nearness) {
          const std::size_t at = pixel(x, y);
          if (nearness <= nearness_[at]) return;
          nearness_[at] = nearness;
          ids_[at] = triangle.id;
        });
      }
      drawn += result.count > 0 ? 1 : 0;
    }
  }
  return drawn;
}

}  // namespace vislab
