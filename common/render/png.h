// Pictures in memory and PNG files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace vislab {

/// 8 bits each of red, green and blue; rows from top to bottom.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  // 3 * width * height

  friend bool operator==(const Image&, const Image&) = default;
};

/// Writes a PNG file under a temporary name beside `path` and renames it, so that `path` is whole
/// or untouched. Throws InputError that names the path if it cannot be written, or if its name does
/// not end in .png (in either case).
void write_png(const std::filesystem::path& path, const Image& image);

/// Throws InputError if the file cannot be read or is not a PNG.
Image read_png(const std::filesystem::path& path);

}  // namespace vislab
