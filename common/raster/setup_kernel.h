// The set-up of many triangles at once: what set_up_triangle and set_up_pair do,
// bit for bit, with SIMD.
//
// Idea: clusters outside of the window are dropped by their boxes; vertices are transformed once a
//   cluster, in double; a first look at the snapped corners drops triangles that face away or hold
//   no pixel's centre; the survivors, packed together, get edges and planes. Triangles that need
//   clipping go through set_up_triangle.
// Guarantee: the same triangles as they give, in the same order, with the same bits.
// Cost: about 20 operations a vertex, and 10 (dropped) to 50 (kept) a triangle.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/raster/box_window.h"
#include "common/raster/raster_mesh.h"
#include "common/raster/triangle_block.h"
#include "common/raster/triangle_setup.h"
#include "common/raster/window_transform.h"

namespace vislab {

/// What a frame's clusters are compared with: the planes of the window and the near plane, in the
/// world; lanes beyond the fifth are repeated.
struct ClusterPlanes {
  static constexpr std::size_t lanes = 8;

  explicit ClusterPlanes(const WindowTransform& window);

  alignas(64) std::array<double, lanes> x, y, z, d;
};

/// Room for the vertices of one cluster, for what is left of its triangles, and for the blocks
/// that come of them. To be kept from frame to frame.
struct SetupScratch {
  static constexpr std::size_t vertices = 3 * RasterCluster::greatest_size;  // a multiple of 16
  static constexpr std::size_t survivors = RasterCluster::greatest_size + 16;

  alignas(64) std::array<double, vertices> x, y, w, depth;
  alignas(64) std::array<std::int32_t, vertices> snapped_x, snapped_y;
  // What a vertex lies beyond of (bits): the near plane, and what positions are clipped to.
  alignas(64) std::array<std::int32_t, vertices> beyond;
  bool any_beyond = false;
  alignas(64) std::array<std::int32_t, survivors> face;

  std::vector<TriangleBlock> blocks;  // written: the first block_count
  std::size_t block_count = 0;
  std::size_t lane = 0;  // the next free one of the last block written; 0: none is begun
  std::size_t drawn = 0;
};

/// A run of triangles of one cluster of a draw.
struct ClusterDraw {
  const RasterDraw* draw = nullptr;
  const RasterCluster* cluster = nullptr;
  std::uint32_t first = 0, count = 0;  // triangles of the mesh
  float beyond_near = 0.0F;            // the least of its box, metres along the view, about
};

/// Appends the clusters of the draws that may have a part in the window.
void find_clusters(const ClusterPlanes& planes, std::span<const RasterDraw> draws,
                   std::vector<ClusterDraw>& out);

/// Where a transformed cluster lies.
struct ClusterWindow {
  BoxPlace place = BoxPlace::undecided;
  BoxWindow window;
};

/// Transforms the cluster's vertices into the scratch. `rows` are the window's, of the draw's
/// transform. With `where`: what the vertices cover at most, with project_box's margins for
/// Coverage::centres or whole_pixels.
void transform_cluster(const WindowTransform& window, const WindowRows& rows,
                       const ClusterDraw& cluster, SetupScratch& scratch, Coverage coverage,
                       ClusterWindow* where);

/// Sets up the triangles of the cluster that was transformed last and appends them to the
/// scratch's blocks. With `ids` every triangle is a lane of its own, else pairs are one
/// quadrilateral.
void set_up_cluster(const WindowTransform& window, const SetupOptions& options, bool ids,
                    const WindowRows& rows, const ClusterDraw& cluster, SetupScratch& scratch);

/// Clears the lanes of the last block that are not used, so that all blocks may be read.
void finish_blocks(SetupScratch& scratch);

}  // namespace vislab
