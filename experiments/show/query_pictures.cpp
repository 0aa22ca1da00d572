#include "experiments/show/query_pictures.h"

#include <algorithm>

#include "common/render/modelled_gpu.h"
#include "common/render/query_boxes.h"
#include "common/render/query_strip.h"
#include "common/render/query_timeline.h"
#include "common/scene/error.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

void require_questions(const RecordedFrame& row, const Frame& frame) {
  if (std::ranges::any_of(row.states, &RecordedState::asks)) return;
  throw InputError(row.culler + " asks the device nothing in frame " + std::to_string(frame.index) +
                   "; a picture of queries needs a culler that asks, and a frame in which it does");
}

StripRow strip_row(const RecordedFrame& row, const Scene& scene) {
  StripRow strip;
  strip.name = row.culler;
  strip.state_of_object.assign(scene.object_count(), none_id);
  std::size_t draws = 0;
  std::size_t queries = 0;
  std::size_t boxes = 0;
  for (std::size_t i = 0; i < row.states.size(); ++i) {
    const RecordedState& state = row.states[i];
    strip.states.push_back({state.asks, state.commands()});
    draws += state.drawn.size();
    queries += state.queries.size();
    for (const RecordedQuery& query : state.queries) boxes += query.boxes.size();
    for (const ObjectId object : state.drawn) {
      std::uint32_t& first = strip.state_of_object[object];
      if (first == none_id) first = static_cast<std::uint32_t>(i);
    }
  }
  strip.note = "state changes: " + std::to_string(row.states.size() - 1) +
               ", queries: " + std::to_string(queries) + " (boxes: " + std::to_string(boxes) +
               "), draws: " + std::to_string(draws) + ", flushes: " + std::to_string(row.flushes);
  return strip;
}

QueryBoxesRow boxes_row(const RecordedFrame& row, const Scene& scene) {
  QueryBoxesRow boxes;
  boxes.name = row.culler;
  boxes.is_drawn.assign(scene.object_count(), 0);
  for (const RecordedState& state : row.states) {
    for (const ObjectId object : state.drawn) boxes.is_drawn[object] = 1;
    for (const RecordedQuery& query : state.queries) {
      boxes.queries.push_back({query.boxes, query.samples});
    }
  }
  return boxes;
}

Image timeline(const std::string& title, const std::string& device,
               const std::vector<RecordedFrame>& rows) {
  TimelineInput input;
  input.title = title + ", on " + device;
  for (const RecordedFrame& row : rows) {
    if (row.commands.empty()) {
      throw InputError("a time line needs a modelled device, whose clock and log can be read; " +
                       device + " is none");
    }
    input.rows.push_back({row.culler, row.commands});
  }
  return render_query_timeline(input);
}

}  // namespace

std::string_view to_string(QueryPicture picture) {
  switch (picture) {
    case QueryPicture::strip:
      return "strip";
    case QueryPicture::boxes:
      return "boxes";
    case QueryPicture::timeline:
      break;
  }
  return "timeline";
}

RecordedFrame record_last_frame(const Registry& cullers, const std::string& chain,
                                const std::string& name, const Scene& scene, const Path& path,
                                const Viewport& viewport, RenderDevice& device, SceneState& state) {
  const std::unique_ptr<ICuller> culler = cullers.make(chain);
  if (!culler->info().needs_device) {
    throw InputError(name +
                     " never asks a device; a picture of queries needs a culler that does, such "
                     "as occlusion.stop_and_wait");
  }
  device.load(scene);
  RecordedDevice recorded(device);
  TimedDevice timed(recorded);
  BuildContext context;
  context.cullers = &cullers;
  context.device = &timed;
  culler->build(scene, context);
  run_path(*culler, scene, path, viewport, 1, state, &timed);
  RecordedFrame frame{name, recorded.states(), recorded.flushes(), {}};
  if (const auto* modelled = dynamic_cast<const ModelledGpu*>(&device)) {
    frame.commands = modelled->log();
  }
  return frame;
}

void write_query_picture(QueryPicture picture, const Scene& scene, const Frame& frame,
                         const std::string& title, const std::string& device,
                         const std::vector<RecordedFrame>& rows,
                         const std::filesystem::path& file) {
  for (const RecordedFrame& row : rows) require_questions(row, frame);
  if (picture == QueryPicture::timeline) {
    write_png(file, timeline(title, device, rows));
    return;
  }
  if (picture == QueryPicture::strip) {
    StripInput input{&scene, &frame, title + ", on " + device, {}};
    for (const RecordedFrame& row : rows) input.rows.push_back(strip_row(row, scene));
    write_png(file, render_query_strip(input));
    return;
  }
  QueryBoxesInput input{&scene, &frame, title + ", on " + device, {}};
  for (const RecordedFrame& row : rows) input.rows.push_back(boxes_row(row, scene));
  write_png(file, render_query_boxes(input));
}

}  // namespace vislab
