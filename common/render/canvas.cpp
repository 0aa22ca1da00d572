#include "common/render/canvas.h"

#include <cairo-ft.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <stdexcept>

namespace vislab {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr Color rim_color = {0, 0, 0};

void require(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(std::string("drawing a picture: ") + cairo_status_to_string(status));
  }
}

/// The fonts of all pictures, read from their files: asking the system for a font by name gives
/// another one where it is missing.
class Fonts {
 public:
  /// Never destroyed: cairo keeps glyphs of fonts until the process ends.
  static const Fonts& get() {
    static const Fonts* const fonts = new Fonts;
    return *fonts;
  }
  cairo_font_face_t* face(bool bold) const { return bold ? bold_ : regular_; }

 private:
  Fonts() {
    if (FT_Init_FreeType(&library_) != 0) throw std::runtime_error("FreeType does not start");
    regular_ = read(VISLAB_FONT);
    bold_ = read(VISLAB_FONT_BOLD);
  }

  cairo_font_face_t* read(const char* file) {
    FT_Face face = nullptr;
    if (FT_New_Face(library_, file, 0, &face) != 0) {
      throw std::runtime_error(std::string("the font file ") + file + " cannot be read");
    }
    cairo_font_face_t* const result = cairo_ft_font_face_create_for_ft_face(face, 0);
    require(cairo_font_face_status(result));
    return result;
  }

  FT_Library library_ = nullptr;
  cairo_font_face_t* regular_ = nullptr;
  cairo_font_face_t* bold_ = nullptr;
};

/// Owns a cairo image of 32-bit pixels 0x00RRGGBB.
class Surface {
 public:
  Surface(int width, int height)
      : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)) {
    require(cairo_surface_status(surface_));
  }
  ~Surface() { cairo_surface_destroy(surface_); }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  cairo_surface_t* get() const { return surface_; }
  std::uint32_t* row(int y) const {
    unsigned char* const data = cairo_image_surface_get_data(surface_);
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_));
    return reinterpret_cast<std::uint32_t*>(data + static_cast<std::size_t>(y) * stride);
  }

 private:
  cairo_surface_t* surface_;
};

}  // namespace

struct Canvas::State {
  State(int w, int h) : width(w), height(h), surface(w, h), context(cairo_create(surface.get())) {
    require(cairo_status(context));
    cairo_font_options_t* const options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_SLIGHT);
    cairo_set_font_options(context, options);
    cairo_font_options_destroy(options);
  }
  ~State() { cairo_destroy(context); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void color(const Color& c) const {
    cairo_set_source_rgb(context, c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
  }

  int width;
  int height;
  Surface surface;
  cairo_t* context;
};

Canvas::Canvas(int width, int height, const Color& paper)
    : state_(std::make_unique<State>(width, height)) {
  fill(0.0, 0.0, width, height, paper);
}

Canvas::~Canvas() = default;

void Canvas::text(double left, double y, double width, double size, bool bold,
                  const std::string& words) {
  cairo_t* const cairo = state_->context;
  cairo_save(cairo);
  cairo_set_font_face(cairo, Fonts::get().face(bold));
  cairo_set_font_size(cairo, size);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, words.c_str(), &extents);
  if (extents.x_advance > width) {
    cairo_set_font_size(cairo, size * std::max(0.5, 0.98 * width / extents.x_advance));
  }
  cairo_rectangle(cairo, left, y - 2.0 * size, width, 3.0 * size);
  cairo_clip(cairo);
  state_->color({25, 25, 25});
  cairo_move_to(cairo, left, y);
  cairo_show_text(cairo, words.c_str());
  cairo_restore(cairo);
}

void Canvas::fill(double left, double top, double width, double height, const Color& color) {
  state_->color(color);
  cairo_rectangle(state_->context, left, top, width, height);
  cairo_fill(state_->context);
}

void Canvas::outline(double left, double top, double width, double height, const Color& color,
                     double line_width) {
  state_->color(color);
  cairo_set_line_width(state_->context, line_width);
  cairo_rectangle(state_->context, left, top, width, height);
  cairo_stroke(state_->context);
}

void Canvas::line(const glm::dvec2& from, const glm::dvec2& to, const Color& color,
                  double line_width) {
  cairo_t* const cairo = state_->context;
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
  for (const bool rim : {true, false}) {
    state_->color(rim ? rim_color : color);
    cairo_set_line_width(cairo, rim ? line_width + 2.0 : line_width);
    cairo_move_to(cairo, from.x, from.y);
    cairo_line_to(cairo, to.x, to.y);
    cairo_stroke(cairo);
  }
}

void Canvas::polygon(std::span<const glm::dvec2> corners, const std::optional<Color>& fill,
                     const std::optional<Color>& line, double line_width) {
  if (corners.size() < 2) return;
  cairo_t* const cairo = state_->context;
  cairo_new_path(cairo);
  for (const glm::dvec2& corner : corners) cairo_line_to(cairo, corner.x, corner.y);
  cairo_close_path(cairo);
  if (fill) {
    state_->color(*fill);
    cairo_fill_preserve(cairo);
  }
  if (line) {
    state_->color(*line);
    cairo_set_line_width(cairo, line_width);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke_preserve(cairo);
  }
  cairo_new_path(cairo);
}

void Canvas::disc(const glm::dvec2& center, double radius, const Color& color) {
  for (const bool rim : {true, false}) {
    state_->color(rim ? rim_color : color);
    cairo_arc(state_->context, center.x, center.y, rim ? radius + 1.5 : radius, 0.0, 2.0 * pi);
    cairo_fill(state_->context);
  }
}

void Canvas::picture(const Image& image, const glm::ivec2& first, const glm::ivec2& size,
                     double left, double top, double width, double height) {
  const Surface surface(size.x, size.y);
  cairo_surface_flush(surface.get());
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const std::uint8_t* const pixel =
          &image.rgb[3 * (static_cast<std::size_t>(first.y + y) * image.width + first.x + x)];
      surface.row(y)[x] = (std::uint32_t{pixel[0]} << 16U) | (std::uint32_t{pixel[1]} << 8U) |
                          std::uint32_t{pixel[2]};
    }
  }
  cairo_surface_mark_dirty(surface.get());
  cairo_t* const cairo = state_->context;
  cairo_save(cairo);
  cairo_rectangle(cairo, left, top, width, height);
  cairo_clip(cairo);
  cairo_translate(cairo, left, top);
  cairo_scale(cairo, width / size.x, height / size.y);
  cairo_set_source_surface(cairo, surface.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(cairo),
                           width >= size.x ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  cairo_paint(cairo);
  cairo_restore(cairo);
}

void Canvas::clip(double left, double top, double width, double height) {
  cairo_save(state_->context);
  cairo_rectangle(state_->context, left, top, width, height);
  cairo_clip(state_->context);
}

void Canvas::unclip() { cairo_restore(state_->context); }

Image Canvas::image() const {
  require(cairo_status(state_->context));
  cairo_surface_flush(state_->surface.get());
  Image image{state_->width, state_->height, {}};
  image.rgb.reserve(std::size_t{3} * state_->width * state_->height);
  for (int y = 0; y < state_->height; ++y) {
    const std::uint32_t* const row = state_->surface.row(y);
    for (int x = 0; x < state_->width; ++x) {
      for (const unsigned shift : {16U, 8U, 0U}) {
        image.rgb.push_back(static_cast<std::uint8_t>(row[x] >> shift));
      }
    }
  }
  return image;
}

}  // namespace vislab
