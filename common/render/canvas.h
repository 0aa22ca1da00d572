// A picture to write text and lines on. For .cpp files of this folder only.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/render/class_view.h"

namespace vislab {

/// Positions are pixels from the upper left corner, x right and y down.
class Canvas {
 public:
  Canvas(int width, int height, const Color& paper);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Writes from `left` on, with the baseline at `y`. Text that is wider than `width` is written
  /// smaller, but no smaller than half the size; what is then still too long is cut.
  void text(double left, double y, double width, double size, bool bold, const std::string& words);
  void fill(double left, double top, double width, double height, const Color& color);
  void outline(double left, double top, double width, double height, const Color& color,
               double line_width);
  /// Lines are drawn on a dark rim, so that they are seen on every ground.
  void line(const glm::dvec2& from, const glm::dvec2& to, const Color& color, double line_width);
  /// Fills a polygon, or a line around it, or both; two corners are a line. No rims.
  void polygon(std::span<const glm::dvec2> corners, const std::optional<Color>& fill,
               const std::optional<Color>& line, double line_width);
  void disc(const glm::dvec2& center, double radius, const Color& color);
  /// Draws a part of an image scaled to the given place; pixels stay squares when they grow.
  void picture(const Image& image, const glm::ivec2& first, const glm::ivec2& size, double left,
               double top, double width, double height);
  /// Everything until unclip stays in this rectangle.
  void clip(double left, double top, double width, double height);
  void unclip();

  Image image() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vislab
