#include "common/render/png.h"

#include <png.h>

#include <stdexcept>
#include <string>

#include "common/scene/error.h"
#include "common/scene/file_bytes.h"
#include "common/scene/write_file.h"

namespace vislab {
namespace {

std::vector<char> encoded(const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  std::vector<char> bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) ==
      0) {
    throw std::runtime_error(std::string("PNG: ") + header.message);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  if (lower_extension(path) != "png") {
    throw InputError(path.string() +
                     ": pictures are written as PNG; give a name that ends in .png");
  }
  const std::vector<char> bytes = encoded(image);
  try {
    write_file(path, {bytes.data(), bytes.size()});
  } catch (const WriteError& error) {
    throw WriteError(std::string(error.what()) +
                     "; name a file in a folder that exists, is writable and has room");
  }
}

Image read_png(const std::filesystem::path& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  const auto fail = [&] {
    const std::string reason = header.message;
    png_image_free(&header);
    throw InputError(path.string() + " cannot be read as a PNG picture: " + reason);
  };
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) fail();
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  if (png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr) == 0) fail();
  return image;
}

}  // namespace vislab
