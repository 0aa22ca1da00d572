#include "common/render/query_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/render/canvas.h"
#include "common/render/colored_view.h"
#include "common/render/outside_view.h"

namespace vislab {
namespace {

constexpr Color paper = {255, 255, 255};
constexpr Color white = {255, 255, 255};
constexpr Color alone_color = {235, 235, 235};
constexpr Color drawn_color = {120, 126, 134};
constexpr double margin = 16.0;
constexpr double title_height = 40.0;
constexpr double heading_height = 26.0;
constexpr double note_height = 22.0;
constexpr double panel_height = 512.0;
constexpr double outside_width = 640.0;

struct Rectangle {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
};

/// The boxes of queries that found nothing to be seen, in their colours.
struct HiddenBoxes {
  std::vector<ColoredBox> together, alone;
};

HiddenBoxes hidden_boxes(const QueryBoxesRow& row) {
  HiddenBoxes boxes;
  std::size_t several = 0;
  for (const BoxesOfQuery& query : row.queries) {
    const bool is_alone = query.boxes.size() < 2;
    const Color color = is_alone ? alone_color : cycled_color(several);
    if (!is_alone) ++several;
    if (query.samples != 0U) continue;
    for (const Aabb& box : query.boxes) {
      (is_alone ? boxes.alone : boxes.together).push_back({box, color});
    }
  }
  return boxes;
}

std::string note_of(const QueryBoxesRow& row) {
  std::size_t several = 0;
  std::size_t boxes = 0;
  std::size_t most = 0;
  std::size_t hidden = 0;
  for (const BoxesOfQuery& query : row.queries) {
    if (query.samples == 0U) ++hidden;
    if (query.boxes.size() < 2) continue;
    ++several;
    boxes += query.boxes.size();
    most = std::max(most, query.boxes.size());
  }
  std::string note = "queries: " + std::to_string(row.queries.size()) +
                     ", found nothing to be seen: " + std::to_string(hidden) +
                     ", of several boxes: " + std::to_string(several);
  if (several > 0) {
    note += " (together " + std::to_string(boxes) + ", at most " + std::to_string(most) + ")";
  }
  return note;
}

void draw_outline(Canvas& canvas, const Camera& camera, const Viewport& viewport,
                  const Rectangle& place, const ColoredBox& box) {
  if (!box.box.valid()) return;
  const auto corner = [&](int i) {
    return glm::dvec3((i & 1) != 0 ? box.box.max.x : box.box.min.x,
                      (i & 2) != 0 ? box.box.max.y : box.box.min.y,
                      (i & 4) != 0 ? box.box.max.z : box.box.min.z);
  };
  const glm::dvec2 scale(place.width / viewport.width, place.height / viewport.height);
  const glm::dvec2 origin(place.left, place.top);
  for (int i = 0; i < 8; ++i) {
    for (const int bit : {1, 2, 4}) {
      WindowLine line{};
      if ((i & bit) != 0 || !project_line(camera, viewport, corner(i), corner(i | bit), line)) {
        continue;
      }
      canvas.line(origin + line.from * scale, origin + line.to * scale, box.color, 1.0);
    }
  }
}

/// Whoever was drawn counts as seen, so that the view holds it.
OutsideView view_of(const QueryBoxesInput& input, const QueryBoxesRow& row, double aspect) {
  std::vector<TriangleClass> classes(input.scene->triangle_count(), TriangleClass::culled_rightly);
  for (ObjectId object = 0; object < row.is_drawn.size(); ++object) {
    if (row.is_drawn[object] == 0) continue;
    std::fill_n(classes.begin() + input.scene->first_triangle(object),
                input.scene->triangle_count(object), TriangleClass::kept_visible);
  }
  PictureInput fitted;
  fitted.scene = input.scene;
  fitted.frame = input.frame;
  fitted.classes = classes;
  return fit_outside_view(fitted, aspect);
}

void draw_from_outside(Canvas& canvas, const QueryBoxesInput& input, const QueryBoxesRow& row,
                       std::span<const Color> colors, const HiddenBoxes& boxes,
                       const Rectangle& place) {
  const OutsideView outside = view_of(input, row, place.width / place.height);
  Frame frame = *input.frame;
  frame.camera = outside.camera;
  frame.viewport = {static_cast<int>(place.width), static_cast<int>(place.height)};
  const Image image = draw_colored(*input.scene, frame, colors, boxes.together, true);
  canvas.picture(image, {0, 0}, {image.width, image.height}, place.left, place.top, place.width,
                 place.height);
  canvas.clip(place.left, place.top, place.width, place.height);
  for (const ColoredBox& box : boxes.alone) {
    draw_outline(canvas, outside.camera, frame.viewport, place, box);
  }
  const glm::dvec2 origin(place.left, place.top);
  WindowLine line{};
  for (const auto& [from, to] : frustum_edges(input.frame->camera, outside.frustum_depth)) {
    if (project_line(outside.camera, frame.viewport, from, to, line)) {
      canvas.line(origin + line.from, origin + line.to, white, 1.5);
    }
  }
  const glm::dvec3& eye = input.frame->camera.pose.eye;
  if (project_line(outside.camera, frame.viewport, eye, eye, line)) {
    canvas.disc(origin + line.from, 5.0, white);
  }
  canvas.unclip();
}

void draw_row(Canvas& canvas, const QueryBoxesInput& input, const QueryBoxesRow& row,
              const Rectangle& eye_place, const Rectangle& outside_place) {
  std::vector<Color> colors(input.scene->object_count(), Color{0, 0, 0});
  for (ObjectId object = 0; object < colors.size(); ++object) {
    if (row.is_drawn[object] != 0) colors[object] = drawn_color;
  }
  const HiddenBoxes boxes = hidden_boxes(row);
  const Image eye = draw_colored(*input.scene, *input.frame, colors, {}, false);
  canvas.picture(eye, {0, 0}, {eye.width, eye.height}, eye_place.left, eye_place.top,
                 eye_place.width, eye_place.height);
  canvas.clip(eye_place.left, eye_place.top, eye_place.width, eye_place.height);
  for (const auto* some : {&boxes.alone, &boxes.together}) {
    for (const ColoredBox& box : *some) {
      draw_outline(canvas, input.frame->camera, input.frame->viewport, eye_place, box);
    }
  }
  canvas.unclip();
  draw_from_outside(canvas, input, row, colors, boxes, outside_place);
}

}  // namespace

Image render_query_boxes(const QueryBoxesInput& input) {
  if (input.scene == nullptr || input.frame == nullptr || input.rows.empty()) {
    throw std::logic_error("render_query_boxes: scene, frame and a row are needed");
  }
  for (const QueryBoxesRow& row : input.rows) {
    if (row.is_drawn.size() != input.scene->object_count()) {
      throw std::logic_error("render_query_boxes: a flag for each object is needed");
    }
  }
  const Viewport& viewport = input.frame->viewport;
  const double zoom = std::min(panel_height / viewport.height, 1024.0 / viewport.width);
  const double eye_width = std::max(1.0, std::round(zoom * viewport.width));
  const double eye_height = std::max(1.0, std::round(zoom * viewport.height));
  const double outside_left = 2.0 * margin + eye_width;
  const double width = outside_left + outside_width + margin;
  const double row_height = heading_height + note_height + panel_height + margin;
  const double rows_top = title_height + note_height;
  Canvas canvas(static_cast<int>(width),
                static_cast<int>(rows_top + row_height * static_cast<double>(input.rows.size())),
                paper);
  canvas.text(margin, 28.0, width - 2.0 * margin, 19.0, true, input.title);
  canvas.text(margin, title_height + 12.0, width - 2.0 * margin, 14.0, false,
              "grey: what was drawn; boxes that showed nothing: of one query in one of " +
                  std::to_string(cycled_colors) +
                  " colours, asked about alone in white. Left from the eye, right from outside");
  for (std::size_t i = 0; i < input.rows.size(); ++i) {
    const QueryBoxesRow& row = input.rows[i];
    const double top = rows_top + row_height * static_cast<double>(i);
    canvas.text(margin, top + 19.0, width - 2.0 * margin, 15.0, true, row.name);
    canvas.text(margin, top + heading_height + 13.0, width - 2.0 * margin, 14.0, false,
                note_of(row));
    const double panels_top = top + heading_height + note_height;
    draw_row(canvas, input, row, {margin, panels_top, eye_width, eye_height},
             {outside_left, panels_top, outside_width, panel_height});
  }
  return canvas.image();
}

}  // namespace vislab
