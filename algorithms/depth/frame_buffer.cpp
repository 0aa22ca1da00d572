#include "algorithms/depth/frame_buffer.h"

namespace vislab::depth_culling {

ParameterSpec scale_parameter() {
  return ParameterSpec::choice(
      "scale", "full", {"full", "half", "quarter"}, ParameterSpec::Stage::query,
      "the buffer's width and height as a part of the frame's; below full only pixels that an "
      "occluder covers wholly count, so that smaller is cheaper, as safe, and hides less");
}

int read_scale(const ParameterValues& values) {
  const std::string& scale = values.choice("scale");
  return scale == "quarter" ? 4 : scale == "half" ? 2 : 1;
}

}  // namespace vislab::depth_culling
