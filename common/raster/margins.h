// By how much answers about an image stand back from exact arithmetic, in one place for all that
// give such answers.
#pragma once

namespace vislab {

/// Of a window position, pixels: snapping moves a vertex by up to 1/512, and positions are rounded.
inline constexpr double snapping_margin_px = 1.0 / 32.0;

/// Of a nearness, a depth or a window position, relative: far above what operations on doubles and
/// a few on floats can be off by, far below what can be seen.
inline constexpr double rounding_margin = 1.0 / 1'048'576.0;

}  // namespace vislab
