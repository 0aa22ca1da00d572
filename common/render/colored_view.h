// Draws objects, and boxes among them, each in a colour of its own, shaded so that shapes are seen.
#pragma once

#include <span>

#include "common/render/class_view.h"

namespace vislab {

/// A world box and what it looks like.
struct ColoredBox {
  Aabb box;
  Color color{};
};

/// Okabe's and Ito's colours (2008), which are told apart with every kind of colour vision, in an
/// order in which neighbours differ in lightness, too. They repeat after seven.
Color cycled_color(std::size_t index);
inline constexpr std::size_t cycled_colors = 7;

/// Draws the shown objects that have a colour, `object_colors` being by ObjectId (black: the object
/// is left away), and the boxes with dark edges. Light comes from the eye. `only_front_faces`
/// leaves out the backs of objects, so that rooms are looked into. Nearer things hide others; boxes
/// that are not valid are left away. Throws InputError for a viewport that cannot be drawn,
/// std::logic_error if there is not a colour for each object. O(triangles + pixels).
Image draw_colored(const Scene& scene, const Frame& frame, std::span<const Color> object_colors,
                   std::span<const ColoredBox> boxes, bool only_front_faces);

}  // namespace vislab
