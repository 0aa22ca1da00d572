// What the hidden-surface algorithms share as cullers: each paints an image of its own, in which
// every pixel belongs to a triangle, and keeps the triangles that own a pixel.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "algorithms/surface/window_face.h"
#include "common/culler/culler.h"

namespace vislab::surface {

/// The image that a method paints: who owns each pixel.
class OwnerImage {
 public:
  void clear(const Viewport& viewport) {
    viewport_ = viewport;
    owners_.assign(
        static_cast<std::size_t>(viewport.width) * static_cast<std::size_t>(viewport.height),
        none_id);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(viewport_.width) +
           static_cast<std::size_t>(x);
  }
  TriangleId& at(int x, int y) { return owners_[index(x, y)]; }
  std::span<const TriangleId> owners() const { return owners_; }
  const Viewport& viewport() const { return viewport_; }
  std::size_t bytes() const { return owners_.capacity() * sizeof(TriangleId); }

 private:
  Viewport viewport_;
  std::vector<TriangleId> owners_;  // row by row from the bottom; none_id = background
};

/// Base of the family's cullers. Keeps what owns a pixel, in the candidates' order.
class SurfaceCuller : public ICuller {
 public:
  explicit SurfaceCuller(CullerInfo info) : info_(std::move(info)) {}

  const CullerInfo& info() const final { return info_; }
  void build(const Scene& scene, const BuildContext& context) final;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) final;
  std::span<const TriangleId> surface_image() const final { return image_.owners(); }
  std::size_t bytes() const final;

 protected:
  /// Preprocessing of the scene, if there is any.
  virtual void prepare() {}
  /// Paints the candidates into image(), which is clear and has the frame's size.
  virtual void paint(const Frame& frame, const Candidates& candidates) = 0;
  /// Memory of what the method itself holds.
  virtual std::size_t own_bytes() const { return 0; }
  /// Puts the triangles that are kept into the order of drawing; they come in the candidates'.
  virtual void order(std::vector<TriangleRange>& /*kept*/) {}

  const Scene& scene() const { return *scene_; }
  OwnerImage& image() { return image_; }
  const OwnerImage& image() const { return image_; }

  /// Calls f(TriangleId, WindowFace) for every candidate triangle that covers a pixel. The face is
  /// valid during the call.
  template <typename Function>
  void for_each_face(const WindowTransform& window, const Frame& frame,
                     const Candidates& candidates, Function&& f) {
    for_each_range(candidates, frame, *scene_, [&](const TriangleRange& range) {
      const WindowRows rows = window.mesh(frame.objects.transforms[range.object]);
      const Mesh& mesh = scene_->mesh_of(range.object);
      const TriangleId first = scene_->first_triangle(range.object);
      for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
        if (face_.set(window, corners_of(mesh, i, rows))) f(first + i, face_);
      }
    });
  }

  static std::array<WindowPoint, 3> corners_of(const Mesh& mesh, std::uint32_t triangle,
                                               const WindowRows& rows) {
    const glm::uvec3& corners = mesh.triangles[triangle];
    return {rows(glm::dvec3(mesh.positions[corners.x])),
            rows(glm::dvec3(mesh.positions[corners.y])),
            rows(glm::dvec3(mesh.positions[corners.z]))};
  }

 private:
  CullerInfo info_;
  const Scene* scene_ = nullptr;
  OwnerImage image_;
  WindowFace face_;
  std::vector<std::uint8_t> owns_;  // by triangle: a pixel of the image
  std::vector<TriangleRange> kept_;
};

}  // namespace vislab::surface
