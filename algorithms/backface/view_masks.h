// Masks of one camera: which classes of normals face away from the eye in each part of the view,
// for meshes that are placed with one linear part or another.
//
// The view is cut by `sectors` x `sectors` rectangles of equal size on the near plane, as the
// sources have it. A class is in a rectangle's mask if all of its normals face away along all four
// corners of the rectangle; so the work is done once for each corner, when it is first asked for,
// and a rectangle's mask, of one sector or several, is what its four corners have in common.
// Lines beyond the view give objects outside of it corners too. In orthographic views there is one
// direction, and one mask.
// Masks are in the mesh's frame: a corner's direction goes through the inverse of the linear part,
// and normals need nothing. Objects with the same linear part share masks within a frame.
// Memory: 256 bytes a corner, for up to 16 linear parts at a time, and 256 for each of up to 2,048
// rectangles of the linear part in use.
// Source: Zhang and Hoff 1997; Zachmann, Computer-Graphik 2, SS 2012, slides 15-18.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "algorithms/backface/direction_cube.h"
#include "algorithms/backface/sector_kernel.h"

namespace vislab::backface_culling {

class ViewMasks {
 public:
  /// `sectors` a side, 1 … SectorLines::most_sectors.
  ViewMasks(DirectionCube cube, int sectors);

  const DirectionCube& cube() const { return cube_; }

  /// Masks are for this camera from now on. They are kept if nothing changed since the last call.
  void start(const Camera& camera, std::uint64_t frame_index);
  /// Forgets the camera and its masks.
  void reset() { started_ = false; }

  bool orthographic() const { return camera_.lens.projection == Projection::orthographic; }
  /// Of a perspective camera.
  const SectorLines& lines() const { return lines_; }

  /// Chooses the linear part of the next calls.
  void select(const glm::dmat3& linear);
  /// Of an orthographic camera. Valid until the next call.
  const BackMask& orthographic_mask();
  /// The masks of rectangles, in masks(), by the order in which they were first asked for; 0 is an
  /// empty mask, for rectangles that are not known. Numbers hold until select() or make_room().
  std::uint16_t number_of(const Rectangle& rectangle);
  const BackMask* masks() const { return masks_.data(); }
  /// Forgets masks of rectangles unless there is room for this many more, up to 1,024.
  void make_room(std::size_t count);

  /// How many directions all classes were tested against so far.
  std::uint64_t directions_tested() const { return directions_tested_; }

 private:
  /// What is known of one linear part.
  struct Part {
    bool used = false;
    glm::dmat3 linear{1.0};
    glm::dmat3 inverse{1.0};
    double inverse_size = 0.0;          // greatest row sum; not finite if it is nearly singular
    std::vector<std::uint16_t> corner;  // by lines, 1 + index of its mask, 0: none yet
    std::vector<BackMask> masks;
  };
  /// A place of the hash table of rectangles.
  struct Entry {
    Rectangle rectangle;
    std::uint16_t number = 0;
    std::uint16_t round = 0;  // of another round: empty
  };

  void forget_rectangles();
  const BackMask& corner_mask(int x, int y);
  BackMask test(const glm::dvec3& direction);

  DirectionCube cube_;
  int sectors_;
  bool started_ = false;
  Camera camera_;
  std::uint64_t frame_index_ = 0;
  SectorLines lines_;
  std::vector<Part> parts_;
  Part* part_ = nullptr;  // selected
  std::vector<Entry> entries_;
  std::uint16_t round_ = 1;
  std::vector<BackMask> masks_;
  std::uint64_t directions_tested_ = 0;
};

}  // namespace vislab::backface_culling
