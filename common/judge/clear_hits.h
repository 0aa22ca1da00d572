// Tells quickly which hits lie surely away from the edges of the triangle they hit.
#pragma once

#include <array>
#include <vector>

#include "common/judge/samples.h"
#include "common/judge/window_triangle.h"
#include "common/scene/frame.h"

namespace vislab {

/// For one frame and one thread. A hit's distance from the line through an edge follows from its
/// barycentric coordinate: with homogeneous window positions A, B, C and a hit at depth w,
///   distance from BC = barycentric of A * |det(A, B, C)| / (w * length of the normal of line BC),
/// so that a hit costs three multiplications once its triangle's three factors are known. They are
/// kept in a small direct-mapped cache. Lines are nearer than edges, so a hit that passes is clear;
/// one that does not is decided by WindowTriangle, whose answer is the definition.
class ClearHits {
 public:
  ClearHits() : entries_(entry_count) {}

  /// Forgets the frame before. All arguments outlive the use.
  void start(const Frame& frame, const Scene& scene);

  /// Is the hit with barycentrics u, v (of the second and third corner) at planar depth `depth` at
  /// least 1/128 pixel from every edge of `triangle`?
  bool is_clear(TriangleId triangle, float u, float v, float depth, const glm::dvec2& window_px) {
    const Entry& entry = find(triangle);
    return surely_clear(entry, u, v, depth) || decide(triangle, window_px);
  }

  /// How many of eight hits on one triangle are clear.
  std::uint32_t count_clear(TriangleId triangle, const float* u, const float* v, const float* depth,
                            const EightPositions& window_px) {
    const Entry& entry = find(triangle);
    std::uint32_t sure = 0;
    for (int lane = 0; lane < 8; ++lane) sure += surely_clear(entry, u[lane], v[lane], depth[lane]);
    if (sure == 8) return sure;
    std::uint32_t count = 0;
    for (int lane = 0; lane < 8; ++lane) {
      count +=
          surely_clear(entry, u[lane], v[lane], depth[lane]) || decide(triangle, window_px[lane]);
    }
    return count;
  }

 private:
  static constexpr std::size_t entry_count = 1024;

  struct Entry {
    TriangleId triangle = none_id;
    bool cut = false;               // by the near or the far plane
    float cut_slope = 0.0F;         // change of 1 / depth over the margin
    std::array<float, 3> factor{};  // see above, divided by the margin
    std::array<float, 3> slack{};   // for the rounding of barycentrics
  };

  const Entry& find(TriangleId triangle) {
    Entry& entry = entries_[triangle % entry_count];
    if (entry.triangle != triangle) fill(entry, triangle);
    return entry;
  }

  /// Written without branches, and so that NaN is never sure.
  bool surely_clear(const Entry& entry, float u, float v, float depth) const {
    const float w = perspective_ ? depth : 1.0F;
    return (((1.0F - u - v) * entry.factor[0] >= w + entry.slack[0]) &
            (u * entry.factor[1] >= w + entry.slack[1]) &
            (v * entry.factor[2] >= w + entry.slack[2]) &
            (!entry.cut || clear_of_cuts(entry, depth))) != 0;
  }

  void fill(Entry& entry, TriangleId triangle);
  bool clear_of_cuts(const Entry& entry, float depth) const;
  bool decide(TriangleId triangle, const glm::dvec2& window_px) const;

  const Frame* frame_ = nullptr;
  const Scene* scene_ = nullptr;
  bool perspective_ = true;
  glm::dvec3 row_x_, row_y_, row_w_;        // world, relative to the eye, to homogeneous window
  double offset_x_ = 0.0, offset_y_ = 0.0;  // for orthographic cameras
  ObjectId object_ = none_id;               // of the last triangle filled
  std::vector<Entry> entries_;
};

}  // namespace vislab
