// The Z-pyramid: the farthest nearness of ever larger squares of a depth buffer.
//
// Idea: level 0 is the buffer, or one texel for each of its tiles. A texel of the next level holds
//   the farthest of 2 x 2 below it, up to a single texel. What is farther than a texel is hidden in
//   all of the texel's square, so that large rectangles are decided by a few texels.
// Guarantee: a texel is never nearer than what it stands for, at every size: levels are rounded up,
//   ceil(w / 2) x ceil(h / 2), so that the last odd row and column count. Rectangles are answered
//   exactly: what a texel does not decide is asked of those below.
// Conventions: values are nearness (window_transform.h), greater is nearer, so the farthest is the
//   least, whichever way a source's depths run.
// Update: what is drawn only comes nearer. So a parent changes only if the texel that is
// overwritten
//   held the parent's farthest value. (Kowalka 2016, 2.4.2, has it backwards: "only if farther".)
// Cost: build O(texels); update O(1), up to 5 texels a level; rectangle O(texels along its border)
//   at worst, usually a few. Memory: 4/3 floats a texel of the finest level.
// Source: Greene, Kass, Miller 1993, Hierarchical Z-Buffer Visibility.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace vislab {

/// Texels [x0, x1) x [y0, y1) of the finest level.
struct TexelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// What makes a Z-pyramid right. Negative controls replace one of these.
struct PyramidRules {
  /// Size of the next level.
  static int halved(int size) { return (size + 1) / 2; }
  /// Of two texels below.
  static float reduced(float a, float b) { return std::min(a, b); }
  /// May a parent change, if a texel below it does?
  static bool concerns_parent(float overwritten, float /*value*/, float parent) {
    return overwritten == parent;
  }
};

template <typename Rules>
class BasicDepthPyramid {
 public:
  /// Of the finest level; both at least 1. All values are the lowest float.
  BasicDepthPyramid(int width, int height) {
    std::size_t first = 0;
    for (int w = width, h = height;;) {
      levels_.push_back({w, h, first});
      first += static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
      if (w == 1 && h == 1) break;
      w = std::max(Rules::halved(w), 1);
      h = std::max(Rules::halved(h), 1);
    }
    texels_.resize(first);
    std::ranges::fill(texels_, std::numeric_limits<float>::lowest());
  }

  int level_count() const { return static_cast<int>(levels_.size()); }
  int width(int level = 0) const { return levels_[static_cast<std::size_t>(level)].width; }
  int height(int level = 0) const { return levels_[static_cast<std::size_t>(level)].height; }
  float at(int level, int x, int y) const { return texels_[index(level, x, y)]; }

  /// All texels have one value.
  void clear(float value) {
    std::ranges::fill(texels_, value);
    touched_ += texels_.size();
  }

  /// Everything anew; value(x, y) is that of the finest level.
  template <typename Function>
  void build(Function&& value) {
    float* to = texels_.data();
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(); ++x) *to++ = value(x, y);
    }
    for (int level = 1; level < level_count(); ++level) {
      for (int y = 0; y < height(level); ++y) {
        for (int x = 0; x < width(level); ++x) *to++ = reduction(level, x, y);
      }
    }
    touched_ += texels_.size();
  }
  /// From an image, row by row.
  void build(std::span<const float> finest) {
    build([&, at = std::size_t{0}](int, int) mutable { return finest[at++]; });
  }

  /// A texel of the finest level comes nearer; nothing happens for a value that is not nearer.
  void raise(int x, int y, float value) {
    float& texel = texels_[index(0, x, y)];
    ++touched_;
    if (!(value > texel)) return;
    float overwritten = texel;
    texel = value;
    for (int level = 1; level < level_count(); ++level) {
      x = std::min(x / 2, width(level) - 1);
      y = std::min(y / 2, height(level) - 1);
      float& parent = texels_[index(level, x, y)];
      ++touched_;
      if (!Rules::concerns_parent(overwritten, value, parent)) return;
      overwritten = parent;
      value = reduction(level, x, y);
      touched_ += 4;
      if (value == overwritten) return;
      parent = value;
    }
  }

  /// A value that is not nearer than the farthest of the rectangle, which is not empty: the least
  /// of the at most four texels that it touches at the level that fits.
  float not_nearer_than(const TexelRect& rect) const {
    const int level = fitting_level(rect);
    const TexelRect cover = touched(rect, level);
    float farthest = at(level, cover.x0, cover.y0);
    for (int y = cover.y0; y < cover.y1; ++y) {
      for (int x = cover.x0; x < cover.x1; ++x) {
        farthest = Rules::reduced(farthest, at(level, x, y));
      }
    }
    return farthest;
  }

  /// Is every texel of the rectangle (not empty) nearer than `value`? decide(x, y) answers for a
  /// texel of the finest level that is not: false, or what is known of the part of its square that
  /// is asked about.
  template <typename Decide>
  bool nearer_everywhere(const TexelRect& rect, float value, Decide&& decide) const {
    return nearer(fitting_level(rect), rect, touched(rect, fitting_level(rect)), value, decide);
  }
  bool nearer_everywhere(const TexelRect& rect, float value) const {
    return nearer_everywhere(rect, value, [](int, int) { return false; });
  }

  /// Texels read and written by clear(), build() and raise(), so far.
  std::uint64_t texels_touched() const { return touched_; }
  std::size_t bytes() const {
    return texels_.capacity() * sizeof(float) + levels_.capacity() * sizeof(Level);
  }

 private:
  struct Level {
    int width, height;
    std::size_t first;  // in texels_, which are row by row
  };

  std::size_t index(int level, int x, int y) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    return l.first + static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) +
           static_cast<std::size_t>(x);
  }

  /// Of the 2 x 2 texels below, or those of them that there are.
  float reduction(int level, int x, int y) const {
    const int below = level - 1;
    const int x0 = std::min(2 * x, width(below) - 1), x1 = std::min(2 * x + 1, width(below) - 1);
    const int y0 = std::min(2 * y, height(below) - 1), y1 = std::min(2 * y + 1, height(below) - 1);
    return Rules::reduced(Rules::reduced(at(below, x0, y0), at(below, x1, y0)),
                          Rules::reduced(at(below, x0, y1), at(below, x1, y1)));
  }

  /// The texels of a level that stand for some of the rectangle.
  TexelRect touched(const TexelRect& rect, int level) const {
    const int last_x = width(level) - 1, last_y = height(level) - 1;
    return {std::min(rect.x0 >> level, last_x), std::min(rect.y0 >> level, last_y),
            std::min((rect.x1 - 1) >> level, last_x) + 1,
            std::min((rect.y1 - 1) >> level, last_y) + 1};
  }

  /// The finest level at which the rectangle touches at most 2 x 2 texels.
  int fitting_level(const TexelRect& rect) const {
    int level = 0;
    while (level + 1 < level_count() && (((rect.x1 - 1) >> level) - (rect.x0 >> level) > 1 ||
                                         ((rect.y1 - 1) >> level) - (rect.y0 >> level) > 1)) {
      ++level;
    }
    return level;
  }

  template <typename Decide>
  bool nearer(int level, const TexelRect& rect, const TexelRect& part, float value,
              Decide& decide) const {
    for (int y = part.y0; y < part.y1; ++y) {
      for (int x = part.x0; x < part.x1; ++x) {
        if (at(level, x, y) > value) continue;
        if (level == 0) {
          if (!decide(x, y)) return false;
          continue;
        }
        const TexelRect asked = touched(rect, level - 1);
        const TexelRect below{std::max(2 * x, asked.x0), std::max(2 * y, asked.y0),
                              std::min(2 * x + 2, asked.x1), std::min(2 * y + 2, asked.y1)};
        if (!nearer(level - 1, rect, below, value, decide)) return false;
      }
    }
    return true;
  }

  std::vector<Level> levels_;
  std::vector<float> texels_;
  std::uint64_t touched_ = 0;
};

using DepthPyramid = BasicDepthPyramid<PyramidRules>;

}  // namespace vislab
