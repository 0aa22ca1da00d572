#include "experiments/matrix/resolution.h"

#include <sstream>

#include "common/scene/error.h"

namespace vislab {

Viewport parse_resolution(const std::string& text) {
  std::istringstream in(text);
  Viewport viewport;
  char x = 0;
  in >> std::noskipws;
  if (!(in >> viewport.width >> x >> viewport.height) || x != 'x' || in.peek() != EOF ||
      viewport.width < 1 || viewport.height < 1 || viewport.width > 16384 ||
      viewport.height > 16384) {
    throw InputError("resolution '" + text +
                     "' is not WIDTHxHEIGHT with numbers from 1 to 16384, such as 512x512");
  }
  return viewport;
}

}  // namespace vislab
