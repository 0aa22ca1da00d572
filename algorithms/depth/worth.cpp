#include "algorithms/depth/worth.h"

#include <algorithm>

namespace vislab::depth_culling {
namespace {

// Declared, of the size that a processor of 2023 needs.
constexpr double query_ns = 150.0;
constexpr double drawn_triangle_ns = 60.0;
constexpr double buffer_pixel_ns = 0.1;
constexpr int patience = 3;  // frames in a row without profit
constexpr std::uint64_t longest_pause = 512;
constexpr std::uint64_t soon = 3;              // frames after a cut
constexpr double cut_cosine = 0.9;             // of the angle that the view turned by in one frame
constexpr std::size_t changes_that_count = 4;  // one in so many objects

}  // namespace

void Worth::note(const Frame& frame, const Changes& changes) {
  const std::size_t changed = changes.moved.size() + changes.shown.size() + changes.hidden.size();
  if (changed > 0 && changed * changes_that_count >= frame.objects.bounds.size()) wake_soon();
}

bool Worth::tries(const Frame& frame) {
  if (frame.index == frame_) return trying_;
  judge_last_frame();
  if (have_camera_ && cut(frame)) wake_soon();
  camera_ = frame.camera;
  have_camera_ = true;
  frame_ = frame.index;
  trying_ = sleep_ == 0;
  if (!trying_) {
    --sleep_;
    ++frames_asleep_;
  }
  return trying_;
}

void Worth::add(const Work& work) {
  static const CostTable costs = CostTable::typical();
  added_ = true;
  profit_ns_ += static_cast<double>(work.hidden_objects) * costs.draw.ns +
                static_cast<double>(work.hidden_triangles) * costs.triangle.ns -
                static_cast<double>(work.queries) * query_ns -
                static_cast<double>(work.drawn_triangles) * drawn_triangle_ns -
                static_cast<double>(work.buffer_pixels) * buffer_pixel_ns;
}

void Worth::judge_last_frame() {
  if (!added_) return;
  if (profit_ns_ > 0.0) {
    frames_without_profit_ = 0;
    pause_ = first_pause;
  } else if (++frames_without_profit_ >= patience) {
    sleep_ = pause_;
    pause_ = std::min(2 * pause_, longest_pause);
    // One frame is tried after the pause.
    frames_without_profit_ = patience - 1;
  }
  added_ = false;
  profit_ns_ = 0.0;
}

bool Worth::cut(const Frame& frame) const {
  if (glm::dot(camera_.pose.back, frame.camera.pose.back) < cut_cosine) return true;
  const glm::dvec3 moved = frame.camera.pose.eye - camera_.pose.eye;
  const double far_jump = 0.1 * (frame.camera.lens.far_m - frame.camera.lens.near_m);
  return glm::dot(moved, moved) > far_jump * far_jump;
}

void Worth::wake_soon() { sleep_ = std::min(sleep_, soon); }

}  // namespace vislab::depth_culling
