// What a walk through portals still sees of the image: a convex polygon in the plane at distance 1
// from the eye (for orthographic cameras: in the image plane, metres).
//
// Guarantee: nothing is lost by rounding. Windows count as larger by window_slack wherever they cut
//   or are asked, edges too short to have a direction do not cut, and polygons with too many
//   corners are not cut any further, all of which only keeps more.
// Cost: O(corners of the polygon x corners of the window) to cut.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"

namespace vislab::portal_culling {

/// About 1/200 of a pixel of a 512 pixel image.
inline constexpr double window_slack = 1e-5;

struct Rectangle {
  glm::dvec2 min{1e300}, max{-1e300};

  void extend(const glm::dvec2& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  bool overlaps(const Rectangle& other) const {
    return min.x <= other.max.x + window_slack && other.min.x <= max.x + window_slack &&
           min.y <= other.max.y + window_slack && other.min.y <= max.y + window_slack;
  }
};

/// The half plane normal . p + offset >= 0; the normal has length 1.
struct ImageLine {
  glm::dvec2 normal;
  double offset;

  double distance(const glm::dvec2& p) const { return glm::dot(normal, p) + offset; }
};

/// Corners in order, counter-clockwise.
class ImagePolygon {
 public:
  static constexpr std::uint32_t capacity = 24;

  ImagePolygon() = default;
  ImagePolygon(const ImagePolygon& other) { *this = other; }
  /// Copies the corners that there are.
  ImagePolygon& operator=(const ImagePolygon& other);

  void clear() {
    count_ = 0;
    bounds_ = {};
  }
  void add(const glm::dvec2& p) {
    corners_[count_++] = p;
    bounds_.extend(p);
  }
  /// The rectangle's corners.
  void set(const Rectangle& rectangle);
  std::span<const glm::dvec2> corners() const { return {corners_.data(), count_}; }
  std::uint32_t size() const { return count_; }
  const Rectangle& bounds() const { return bounds_; }

  /// Takes away what lies outside of the line. False if that is all; the polygon is not changed
  /// then.
  bool cut(const ImageLine& line);
  /// To be called after cutting.
  void find_bounds();

 private:
  std::array<glm::dvec2, capacity> corners_;
  std::uint32_t count_ = 0;
  Rectangle bounds_;
};

/// A polygon and the lines of its edges, moved outward by window_slack.
class ImageWindow {
 public:
  void set(const ImagePolygon& polygon) {
    polygon_ = polygon;
    find_lines();
  }
  /// What of `polygon` lies in `window`. False if nothing does; this is then of no use.
  bool set_part(const ImagePolygon& polygon, const ImageWindow& window);

  const ImagePolygon& polygon() const { return polygon_; }
  const Rectangle& bounds() const { return polygon_.bounds(); }
  std::span<const ImageLine> lines() const { return {lines_.data(), line_count_}; }

 private:
  void find_lines();

  ImagePolygon polygon_;
  std::array<ImageLine, ImagePolygon::capacity> lines_;
  std::uint32_t line_count_ = 0;
};

/// A camera's image: where points of the world lie in it.
class ImageMap {
 public:
  void set(const Camera& camera) { camera_ = camera; }
  const Camera& camera() const { return camera_; }

  /// The whole image.
  Rectangle whole() const;
  /// The image of a polygon's part behind the near plane; corners counter-clockwise seen from the
  /// eye. Its bounds as corners if there are too many. False if no part lies there.
  bool image_of(std::span<const glm::dvec3> polygon, ImagePolygon& image) const;
  /// The plane, relative to the eye (its d is the distance of the eye), of all points of the world
  /// whose image is on the line; inside is the line's.
  Plane plane_of(const ImageLine& line) const;

 private:
  Camera camera_;
};

/// What a window shows of the world, as planes relative to the eye.
class WindowPlanes {
 public:
  void set(const ImageMap& map, const ImageWindow& window);
  /// Only the four planes of the rectangle.
  void set(const ImageMap& map, const Rectangle& rectangle);
  /// False only if the whole box is outside one of the planes.
  bool meets(const Aabb& box) const;

 private:
  void add(const Plane& plane) { planes_[count_++] = plane; }

  glm::dvec3 eye_{0.0};
  std::array<Plane, ImagePolygon::capacity + 4> planes_;
  std::uint32_t count_ = 0;
};

}  // namespace vislab::portal_culling
