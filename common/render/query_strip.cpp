#include "common/render/query_strip.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/render/canvas.h"
#include "common/render/colored_view.h"

namespace vislab {
namespace {

constexpr Color paper = {255, 255, 255};
constexpr Color grey = {110, 110, 110};
constexpr double margin = 16.0;
constexpr double panel_side = 528.0;
constexpr double picture_width = 3.0 * margin + 2.0 * panel_side;
constexpr double strip_width = picture_width - 2.0 * margin;
constexpr double title_height = 40.0;
constexpr double heading_height = 26.0;
constexpr double line_height = 18.0;
constexpr double draw_height = 14.0, query_height = 6.0;
constexpr double caption_height = 26.0;
constexpr double legend_height = 28.0;
/// A frame of more commands than this many lines hold gets narrower marks.
constexpr std::size_t most_lines = 24;

std::uint64_t commands_of(const StripRow& row) {
  std::uint64_t commands = 0;
  for (const StripState& state : row.states) commands += state.commands;
  return commands;
}

std::size_t lines_for(std::uint64_t commands, double mark_width) {
  const auto each = static_cast<std::uint64_t>(strip_width / mark_width);
  return static_cast<std::size_t>(std::max<std::uint64_t>(1, (commands + each - 1) / each));
}

/// The widest marks with which all strips together are not too high.
double mark_width_for(const std::vector<StripRow>& rows) {
  for (const double width : {12.0, 8.0, 6.0, 4.0, 3.0, 2.0}) {
    std::size_t lines = 0;
    for (const StripRow& row : rows) lines += lines_for(commands_of(row), width);
    if (lines <= most_lines + rows.size()) return width;
  }
  return 1.0;
}

void draw_mark(Canvas& canvas, double left, double line_top, double width, bool asks,
               const Color& color) {
  const double height = asks ? query_height : draw_height;
  // A gap between marks that are wide enough for one.
  canvas.fill(left, line_top + draw_height - height, width >= 4.0 ? width - 1.0 : width, height,
              color);
}

void draw_strip(Canvas& canvas, const StripRow& row, double top, double mark_width) {
  const auto each = static_cast<std::uint64_t>(strip_width / mark_width);
  std::uint64_t command = 0;
  for (std::size_t i = 0; i < row.states.size(); ++i) {
    for (std::uint64_t k = 0; k < row.states[i].commands; ++k, ++command) {
      draw_mark(canvas, margin + mark_width * static_cast<double>(command % each),
                top + line_height * static_cast<double>(command / each), mark_width,
                row.states[i].asks, cycled_color(i));
    }
  }
}

void draw_legend(Canvas& canvas, double top) {
  const auto entry = [&](double left, bool asks, const std::string& words) {
    for (std::size_t i = 0; i < 3; ++i) {
      draw_mark(canvas, left + 8.0 * static_cast<double>(i), top, 8.0, asks, grey);
    }
    canvas.text(left + 32.0, top + 12.0, 120.0, 14.0, false, words);
  };
  entry(margin, false, "draws");
  entry(margin + 100.0, true, "queries");
  canvas.text(margin + 220.0, top + 12.0, strip_width - 220.0, 14.0, false,
              "in their order; each change between drawing and asking takes the next of " +
                  std::to_string(cycled_colors) + " colours");
}

void draw_panel(Canvas& canvas, const StripInput& input, const StripRow& row, double left,
                double top) {
  std::vector<Color> colors(input.scene->object_count(), Color{0, 0, 0});
  for (ObjectId object = 0; object < colors.size(); ++object) {
    const std::uint32_t state = row.state_of_object[object];
    if (state != none_id) colors[object] = cycled_color(state);
  }
  const Image image = draw_colored(*input.scene, *input.frame, colors, {}, false);
  const double zoom = std::min(panel_side / image.width, panel_side / image.height);
  canvas.text(left, top + 18.0, panel_side, 14.0, true, row.name);
  canvas.picture(image, {0, 0}, {image.width, image.height}, left, top + caption_height,
                 std::round(zoom * image.width), std::round(zoom * image.height));
}

}  // namespace

Image render_query_strip(const StripInput& input) {
  if (input.scene == nullptr || input.frame == nullptr || input.rows.empty()) {
    throw std::logic_error("render_query_strip: scene, frame and a row are needed");
  }
  for (const StripRow& row : input.rows) {
    if (row.state_of_object.size() != input.scene->object_count()) {
      throw std::logic_error("render_query_strip: a state for each object is needed");
    }
  }
  const Viewport& viewport = input.frame->viewport;
  const double mark_width = mark_width_for(input.rows);
  const double panel_height =
      caption_height + panel_side * std::min(1.0, 1.0 / viewport.aspect()) + margin;
  double strips_height = 0.0;
  for (const StripRow& row : input.rows) {
    strips_height += heading_height + margin +
                     line_height * static_cast<double>(lines_for(commands_of(row), mark_width));
  }
  const double panels_top = title_height + strips_height + legend_height;
  const double panel_rows = std::ceil(static_cast<double>(input.rows.size()) / 2.0);
  Canvas canvas(static_cast<int>(picture_width),
                static_cast<int>(std::ceil(panels_top + panel_rows * panel_height)), paper);
  canvas.text(margin, 28.0, strip_width, 19.0, true, input.title);
  double top = title_height;
  for (const StripRow& row : input.rows) {
    canvas.text(margin, top + 17.0, strip_width, 15.0, true, row.name + "   " + row.note);
    draw_strip(canvas, row, top + heading_height, mark_width);
    top += heading_height + margin +
           line_height * static_cast<double>(lines_for(commands_of(row), mark_width));
  }
  draw_legend(canvas, top);
  for (std::size_t i = 0; i < input.rows.size(); ++i) {
    draw_panel(canvas, input, input.rows[i], margin + (i % 2 == 0 ? 0.0 : panel_side + margin),
               panels_top + panel_height * std::floor(static_cast<double>(i) / 2.0));
  }
  return canvas.image();
}

}  // namespace vislab
