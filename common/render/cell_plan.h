// A plan of a scene's cells and portals, and of what a culler reached and kept in one frame.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/render/picture.h"

namespace vislab {

struct CellPlanInput {
  const Scene* scene = nullptr;  // with cells
  const Frame* frame = nullptr;
  std::string title;  // scene, culler, frame
  /// By ObjectId; hidden ones are not drawn.
  std::span<const TriangleClass> objects;
  /// How many of those left out though visible the judge excuses, all their lost samples being
  /// disputed.
  std::uint64_t excused = 0;
  std::span<const CellId> reached;
  std::string reached_means = "reached";  // what the lit cells are, for the legend
};

/// x to the right, z downward. Left: the storey of the eye, which is everything as a horizontal
/// plane through the eye cuts it, around what was reached there: cells, those reached lit, portals
/// that lead between them, and the outlines of objects in the colours of their classes. Right: all
/// storeys from above, with the boxes of the objects that were kept or are missing. White: the eye,
/// and the left and right border of its view. Throws std::logic_error if the input does not fit
/// together or the scene has no cells. O(triangles + regions * planes^2).
Image render_cell_plan(const CellPlanInput& input);

}  // namespace vislab
