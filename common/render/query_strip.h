// What cullers had a device do in one frame as strips of colour: as the lecture shows it, every
// change between drawing and asking takes another colour (Zachmann, slides 55 and 73).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/render/png.h"
#include "common/scene/frame.h"

namespace vislab {

/// What was done between two changes: draws or queries, so many.
struct StripState {
  bool asks = false;
  std::uint64_t commands = 0;
};

struct StripRow {
  std::string name;  // of the culler
  std::string note;  // what is counted
  std::vector<StripState> states;
  /// By ObjectId: the index of the state in which it was drawn first; none_id: not drawn.
  std::vector<std::uint32_t> state_of_object;
};

struct StripInput {
  const Scene* scene = nullptr;
  const Frame* frame = nullptr;
  std::string title;
  std::vector<StripRow> rows;
};

/// A strip a row, all to the same scale, and below them the frame as each culler had it drawn:
/// objects in the colour of their state. Throws std::logic_error if the input does not fit
/// together, InputError for a viewport that cannot be drawn. O(commands + rows * triangles).
Image render_query_strip(const StripInput& input);

}  // namespace vislab
