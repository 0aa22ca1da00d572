// Draws a scene whose triangles have classes, shaded so that shapes are seen.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "common/render/picture.h"

namespace vislab {

using Color = std::array<std::uint8_t, 3>;  // red, green, blue

/// By TriangleClass. Sky blue, yellow and vermillion of the palette of Okabe and Ito (2008), and a
/// dark grey: their lightness (CIE L*) is 70, 90, 35 and 54, so that they differ without hue, too.
inline constexpr std::array<Color, triangle_class_count> class_colors = {
    {{86, 180, 233}, {240, 228, 66}, {78, 84, 92}, {213, 94, 0}}};

/// Behind everything; darker than every class.
inline constexpr Color background_color = {18, 21, 26};

class ClassView {
 public:
  ClassView();
  ~ClassView();

  struct Options {
    int supersampling = 1;  // rendered so many times larger and averaged
    bool only_front_faces = false;
  };

  /// Draws the shown objects with light from the eye. Throws InputError for a viewport that cannot
  /// be drawn.
  Image draw(const Scene& scene, const ObjectsView& objects, std::span<const TriangleClass> classes,
             const Camera& camera, const Viewport& viewport, const Options& options);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace vislab
