#include "common/render/picture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/render/canvas.h"
#include "common/render/class_view.h"
#include "common/render/outside_view.h"

namespace vislab {
namespace {

constexpr Color paper = {255, 255, 255};
constexpr Color white = {255, 255, 255};
constexpr Color grey = {110, 110, 110};
constexpr double margin = 16.0;
constexpr double panel_height = 512.0;
constexpr double title_height = 40.0;
constexpr double caption_height = 24.0;
constexpr double legend_row = 26.0;
constexpr int inset_pixels = 24;  // of the frame, along each side
constexpr double inset_zoom = 8.0;

const std::array<const char*, triangle_class_count> labels = {
    "kept and visible", "kept but invisible", "culled rightly", "culled though visible"};

struct Rectangle {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
};

struct Inset {
  glm::ivec2 first;  // upper left pixel of the frame, y down
  glm::ivec2 size;
  std::size_t wrong = 0;  // wrong pixels in it
};

/// The window of inset_pixels squared with the most wrong pixels. More than half of them count as
/// half, so that of a large wrong area the rim is shown, with what should not differ beside it. Of
/// equal windows the highest, then the leftmost. O(pixels of the frame).
Inset worst_inset(const PictureInput& input) {
  const Viewport& viewport = input.frame->viewport;
  const glm::ivec2 size(std::min(inset_pixels, viewport.width),
                        std::min(inset_pixels, viewport.height));
  // sums[y][x]: wrong pixels left of x and above y (y down).
  const auto stride = static_cast<std::size_t>(viewport.width) + 1;
  std::vector<std::uint32_t> sums(stride * (static_cast<std::size_t>(viewport.height) + 1), 0);
  const auto at = [&](int x, int y) -> std::uint32_t& {
    return sums[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
  };
  for (const glm::ivec2& pixel : input.wrong_pixels) {
    at(pixel.x + 1, viewport.height - pixel.y) = 1;
  }
  for (int y = 1; y <= viewport.height; ++y) {
    for (int x = 1; x <= viewport.width; ++x) {
      at(x, y) += at(x - 1, y) + at(x, y - 1) - at(x - 1, y - 1);
    }
  }
  const auto wrong_in = [&](int x, int y) {
    return at(x + size.x, y + size.y) - at(x, y + size.y) - at(x + size.x, y) + at(x, y);
  };
  const auto half = static_cast<std::uint32_t>(size.x * size.y + 1) / 2;
  Inset best{{0, 0}, size, wrong_in(0, 0)};
  std::uint32_t best_score = std::min(wrong_in(0, 0), half);
  for (int y = 0; y + size.y <= viewport.height; ++y) {
    for (int x = 0; x + size.x <= viewport.width; ++x) {
      const std::uint32_t score = std::min(wrong_in(x, y), half);
      if (score > best_score) {
        best = {{x, y}, size, wrong_in(x, y)};
        best_score = score;
      }
    }
  }
  if (best_score == half) return best;
  // A small place: in the middle, if none of it is lost by that.
  glm::ivec2 low = best.first + best.size;
  glm::ivec2 high = best.first;
  for (const glm::ivec2& pixel : input.wrong_pixels) {
    const glm::ivec2 place(pixel.x, viewport.height - 1 - pixel.y);
    if (glm::any(glm::lessThan(place, best.first)) ||
        glm::any(glm::greaterThanEqual(place, best.first + best.size))) {
      continue;
    }
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  const glm::ivec2 middle = glm::clamp((low + high + 1 - size) / 2, glm::ivec2(0),
                                       glm::ivec2(viewport.width, viewport.height) - size);
  const std::uint32_t in_middle = wrong_in(middle.x, middle.y);
  if (in_middle >= best.wrong) best = {middle, size, in_middle};
  return best;
}

void require_consistent(const PictureInput& input) {
  if (input.scene == nullptr || input.frame == nullptr ||
      input.classes.size() != input.scene->triangle_count()) {
    throw std::logic_error("render_picture: scene, frame and a class for each triangle are needed");
  }
  const Viewport& viewport = input.frame->viewport;
  for (const glm::ivec2& pixel : input.wrong_pixels) {
    if (pixel.x < 0 || pixel.y < 0 || pixel.x >= viewport.width || pixel.y >= viewport.height) {
      throw std::logic_error("render_picture: a wrong pixel lies outside the frame");
    }
  }
}

void draw_frustum(Canvas& canvas, const OutsideView& outside, const Camera& seen,
                  const Rectangle& place) {
  const Viewport viewport{static_cast<int>(place.width), static_cast<int>(place.height)};
  const glm::dvec2 corner(place.left, place.top);
  WindowLine line{};
  canvas.clip(place.left, place.top, place.width, place.height);
  for (const auto& [from, to] : frustum_edges(seen, outside.frustum_depth)) {
    if (project_line(outside.camera, viewport, from, to, line)) {
      canvas.line(corner + line.from, corner + line.to, white, 1.5);
    }
  }
  if (project_line(outside.camera, viewport, seen.pose.eye, seen.pose.eye, line)) {
    canvas.disc(corner + line.from, 5.0, white);
  }
  canvas.unclip();
}

void draw_legend(Canvas& canvas, const PictureInput& input, double left, double top, double width) {
  for (std::size_t i = 0; i < triangle_class_count; ++i) {
    const double y = top + legend_row * static_cast<double>(i);
    canvas.fill(left, y, 30.0, 16.0, class_colors[i]);
    canvas.outline(left, y, 30.0, 16.0, grey, 1.0);
    std::string text =
        std::string(labels[i]) + ": " + std::to_string(input.counts[i]) + " " + input.counted;
    if (i == static_cast<std::size_t>(TriangleClass::culled_wrongly) && input.excused > 0) {
      text += ", " + std::to_string(input.excused) + " of them excused (disputed)";
    }
    canvas.text(left + 42.0, y + 13.0, width - 42.0, 14.0, false, text);
  }
}

void draw_inset(Canvas& canvas, const Image& eye_view, const Inset& inset, const Viewport& viewport,
                const Rectangle& place) {
  canvas.picture(eye_view, inset.first, inset.size, place.left, place.top, place.width,
                 place.height);
  canvas.outline(place.left, place.top, place.width, place.height, {0, 0, 0}, 2.0);
  const double text_left = place.left + place.width + 14.0;
  const int lower = viewport.height - inset.first.y - inset.size.y;
  const std::array<std::string, 4> lines = {
      "The worst place, 8 times enlarged", "(the white square in the view above):",
      std::to_string(inset.wrong) + " wrong pixels of " + std::to_string(inset.size.x) + " × " +
          std::to_string(inset.size.y),
      "from pixel (" + std::to_string(inset.first.x) + ", " + std::to_string(lower) +
          ") (lower left corner)"};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    canvas.text(text_left, place.top + 16.0 + 20.0 * static_cast<double>(i), 400.0, 14.0, false,
                lines[i]);
  }
}

}  // namespace

Image render_picture(const PictureInput& input) {
  require_consistent(input);
  const Viewport& viewport = input.frame->viewport;
  const bool has_inset = !input.wrong_pixels.empty();

  const double zoom = std::min(panel_height / viewport.height, 1024.0 / viewport.width);
  const Rectangle eye_place{margin, title_height + caption_height,
                            std::max(1.0, std::round(zoom * viewport.width)),
                            std::max(1.0, std::round(zoom * viewport.height))};
  const double eye_column = std::max(eye_place.width, 512.0);
  const Rectangle outside_place{2.0 * margin + eye_column, eye_place.top, 640.0, panel_height};
  const double width = outside_place.left + outside_place.width + margin;
  const double legend_top = eye_place.top + panel_height + margin;
  const double legend_height =
      std::max(legend_row * triangle_class_count, has_inset ? inset_pixels * inset_zoom : 0.0);
  const double height = legend_top + legend_height + margin;

  ClassView view;
  const Image eye_view = view.draw(*input.scene, input.frame->objects, input.classes,
                                   input.frame->camera, viewport, {1, false});
  const OutsideView outside = fit_outside_view(input, outside_place.width / outside_place.height);
  const Image outside_image = view.draw(
      *input.scene, input.frame->objects, input.classes, outside.camera,
      {static_cast<int>(outside_place.width), static_cast<int>(outside_place.height)}, {2, true});

  Canvas canvas(static_cast<int>(width), static_cast<int>(height), paper);
  canvas.text(margin, 28.0, width - 2.0 * margin, 19.0, true, input.title);
  canvas.text(margin, eye_place.top - 8.0, eye_column, 14.0, false, "from the eye");
  canvas.text(outside_place.left, outside_place.top - 8.0, outside_place.width, 14.0, false,
              "from outside, back faces left away; white: the eye and its view frustum");
  canvas.picture(eye_view, {0, 0}, {eye_view.width, eye_view.height}, eye_place.left, eye_place.top,
                 eye_place.width, eye_place.height);
  canvas.picture(outside_image, {0, 0}, {outside_image.width, outside_image.height},
                 outside_place.left, outside_place.top, outside_place.width, outside_place.height);
  draw_frustum(canvas, outside, input.frame->camera, outside_place);
  draw_legend(canvas, input, margin, legend_top, eye_column);
  if (has_inset) {
    const Inset inset = worst_inset(input);
    const glm::dvec2 scale(eye_place.width / viewport.width, eye_place.height / viewport.height);
    canvas.outline(eye_place.left + inset.first.x * scale.x,
                   eye_place.top + inset.first.y * scale.y, inset.size.x * scale.x,
                   inset.size.y * scale.y, white, 2.0);
    draw_inset(
        canvas, eye_view, inset, viewport,
        {outside_place.left, legend_top, inset.size.x * inset_zoom, inset.size.y * inset_zoom});
  }
  return canvas.image();
}

}  // namespace vislab
