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
    const RasterMesh& mesh = *draw_call.mesh;
    const WindowRows rows = window_.mesh(*draw_call.transform);
    const std::uint32_t end = draw_call.first + draw_call.count;
    for (std::uint32_t i = draw_call.first; i < end;) {
      const std::uint32_t face = mesh.face_of(i);
      SetupResult result;
      if (mesh.is_pair(face) && mesh.face_triangle(face) == i && i + 1 < end) {
        const RasterCluster& cluster = mesh.clusters()[i / RasterCluster::greatest_size];
        std::array<WindowPoint, 4> points;
        for (int corner = 0; corner < 4; ++corner) {
          points[static_cast<std::size_t>(corner)] = rows(mesh.position(cluster, face, corner));
        }
        std::array<SetupTriangle, 2> pieces;
        if (set_up_pair(window_, points, draw_call.first_id + (i - draw_call.first), options_,
                        result, pieces)) {
          drawn += 2 * draw_pieces(draw_call, result, pieces);
          i += 2;
          continue;
        }
      }
      const glm::uvec3& corners = mesh.triangles()[i];
      std::array<SetupTriangle, max_setup_pieces> pieces;
      result =
          set_up_triangle(window_,
                          {rows(mesh.positions()[corners.x]), rows(mesh.positions()[corners.y]),
                           rows(mesh.positions()[corners.z])},
                          draw_call.first_id + (i - draw_call.first), options_, pieces);
      drawn += draw_pieces(draw_call, result, pieces);
      ++i;
    }
  }
  return drawn;
}

std::size_t BruteForceRaster::draw_pieces(const RasterDraw& draw_call, const SetupResult& result,
                                          std::span<const SetupTriangle> pieces) {
  const bool mirrored = glm::determinant(glm::dmat3(*draw_call.transform)) < 0.0;
  const Facing back = mirrored ? Facing::front : Facing::back;
  if (result.count == 0 || (draw_call.front_only && result.facing == back)) return 0;
  for (const SetupTriangle& triangle : pieces.first(static_cast<std::size_t>(result.count))) {
    for_each_covered_pixel(triangle, [&](int x, int y, float nearness) {
      const std::size_t at = pixel(x, y);
      if (nearness <= nearness_[at]) return;
      nearness_[at] = nearness;
      ids_[at] = triangle.id;
    });
  }
  return 1;
}

}  // namespace vislab
