// What cullers asked a device about in one frame: the boxes of every query, those of one query in
// one colour (Zachmann, slide 75).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/render/png.h"
#include "common/scene/frame.h"

namespace vislab {

struct BoxesOfQuery {
  std::vector<Aabb> boxes;               // world
  std::optional<std::uint64_t> samples;  // none: nobody looked
};

struct QueryBoxesRow {
  std::string name;  // of the culler
  std::vector<BoxesOfQuery> queries;
  std::vector<std::uint8_t> is_drawn;  // by ObjectId
};

struct QueryBoxesInput {
  const Scene* scene = nullptr;
  const Frame* frame = nullptr;
  std::string title;
  std::vector<QueryBoxesRow> rows;
};

/// A row a culler. Left: the frame as it was drawn, in grey, with the outlines of the boxes of
/// queries that found nothing to be seen. Right: the same from outside, where these boxes stand
/// where nothing was drawn. Queries of several boxes have a colour each, as far as colours go;
/// boxes asked about alone are white outlines. Throws std::logic_error if the input does not fit
/// together, InputError for a viewport that cannot be drawn. O(rows * (triangles + boxes)).
Image render_query_boxes(const QueryBoxesInput& input);

}  // namespace vislab
