#include "common/render/surface_picture.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "common/geometry/random.h"
#include "common/render/canvas.h"
#include "common/render/class_view.h"

namespace vislab {
namespace {

constexpr Color paper = {255, 255, 255};
constexpr double margin = 16.0;
// On paper a picture is at most 9 cm high: two rows of four panels fill a page's width, and a
// letter of 34 pixels is one of 7 points.
constexpr double title_height = 60.0;
constexpr double caption_height = 96.0;
constexpr double title_size = 36.0;
constexpr double caption_size = 34.0;
constexpr int most_columns = 4;
constexpr int panel_side = 512;  // about; at least one pixel a pixel

/// Of the palette of Okabe and Ito (2008), without orange and vermillion.
constexpr std::array<Color, 6> object_colors = {{{86, 180, 233},
                                                 {240, 228, 66},
                                                 {0, 158, 115},
                                                 {204, 121, 167},
                                                 {0, 114, 178},
                                                 {160, 160, 160}}};
constexpr Color wrong_color = {213, 94, 0};

Color color_of(const Scene& scene, TriangleId triangle) {
  if (triangle == none_id) return background_color;
  Color color = object_colors[scene.object_of(triangle) % object_colors.size()];
  // Neighbours should differ: four steps of lightness in no order.
  constexpr std::array<int, 4> lightness = {100, 88, 76, 64};
  const int share = lightness[Random(triangle).below(lightness.size())];
  for (std::uint8_t& channel : color) {
    channel = static_cast<std::uint8_t>(channel * share / 100);
  }
  return color;
}

Image image_of(const Scene& scene, const Viewport& viewport, const SurfacePanel& panel) {
  Image image{viewport.width, viewport.height, {}};
  image.rgb.reserve(3 * panel.owners.size());
  for (int y = viewport.height - 1; y >= 0; --y) {
    for (int x = 0; x < viewport.width; ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(viewport.width) +
          static_cast<std::size_t>(x);
      const bool wrong = !panel.wrong.empty() && panel.wrong[at] != 0;
      const Color color = wrong ? wrong_color : color_of(scene, panel.owners[at]);
      image.rgb.insert(image.rgb.end(), color.begin(), color.end());
    }
  }
  return image;
}

}  // namespace

Image render_surface_picture(const Scene& scene, const Viewport& viewport, const std::string& title,
                             std::span<const SurfacePanel> panels) {
  const std::size_t pixels =
      static_cast<std::size_t>(viewport.width) * static_cast<std::size_t>(viewport.height);
  for (const SurfacePanel& panel : panels) {
    if (panel.owners.size() != pixels || (!panel.wrong.empty() && panel.wrong.size() != pixels)) {
      throw std::logic_error("render_surface_picture: a panel is not of the viewport's size");
    }
  }
  const int zoom = std::max(1, panel_side / std::max(viewport.width, viewport.height));
  const double width = static_cast<double>(zoom) * viewport.width;
  const double height = static_cast<double>(zoom) * viewport.height;
  const int count = static_cast<int>(panels.size());
  const int columns = std::clamp(count, 1, most_columns);
  const int rows = (count + columns - 1) / columns;
  const double row_height = caption_height + height + margin;
  Canvas canvas(static_cast<int>(margin + columns * (width + margin)),
                static_cast<int>(title_height + rows * row_height), paper);
  canvas.text(margin, 42.0, columns * (width + margin) - margin, title_size, true, title);
  for (int i = 0; i < count; ++i) {
    const SurfacePanel& panel = panels[static_cast<std::size_t>(i)];
    const double left = margin + (i % columns) * (width + margin);
    const double top = title_height + (i / columns) * row_height;
    canvas.text(left, top + 36.0, width, caption_size, true, panel.caption);
    canvas.text(left, top + 78.0, width, caption_size, false, panel.note);
    canvas.picture(image_of(scene, viewport, panel), {0, 0}, {viewport.width, viewport.height},
                   left, top + caption_height, width, height);
  }
  return canvas.image();
}

}  // namespace vislab
