#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "common/scene/error.h"
#include "experiments/calibration/device_fit.h"
#include "experiments/devices/device_spec.h"
#include "experiments/matrix/resolution.h"
#include "experiments/show/query_pictures.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

QueryPicture picture_of(const std::string& name) {
  std::vector<std::string> known;
  for (const QueryPicture picture : query_pictures) {
    if (name == to_string(picture)) return picture;
    known.emplace_back(to_string(picture));
  }
  throw unknown_name("picture of queries", name, known);
}

DeviceSpec device_of(const ShowCall& call, QueryPicture picture) {
  const char* const usual = picture == QueryPicture::timeline ? "modelled[preset=gpu]" : "osmesa";
  DeviceSpec spec = parse_device(call.draw.value_or(usual));
  if (spec.kind == DeviceSpec::Kind::none) {
    throw InputError("--draw none: a picture of queries needs a device to ask");
  }
  if (picture == QueryPicture::timeline && spec.kind != DeviceSpec::Kind::modelled) {
    throw InputError("--draw " + spec.text +
                     ": a time line needs a modelled device, whose clock can be read, such as "
                     "modelled[preset=gpu]");
  }
  return spec;
}

/// Dials that are not named are the preset's, or those that OSMesa on this machine is fitted with.
GpuModel preset_model_of(const DeviceSpec& spec) {
  if (spec.preset.empty()) return {};
  if (!spec.is_fitted()) return gpu_preset(spec.preset).model;
  const int threads =
      spec.drawing_threads(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  ::setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 1);
  std::cerr << "fitting the modelled device to OSMesa\n";
  return fit_device(threads).model;
}

}  // namespace

int show_queries(const Lab& lab, const ShowCall& call) {
  const QueryPicture picture = picture_of(call.queries);
  const DeviceSpec spec = device_of(call, picture);
  // Mesa reads this when its first context is made.
  if (spec.synchronous) ::setenv("LP_NUM_THREADS", "0", 1);
  const Viewport viewport = parse_resolution(call.resolution);
  const LoadedScene loaded = load_scene(call.scene, lab.data);
  const Scene& scene = loaded.scene;
  Path path =
      load_path(call.path.empty() ? loaded.default_path : call.path, scene, viewport, 0, lab.data);
  const std::size_t last = require_frame(path, call.frame);
  path.frames.resize(last + 1);
  SceneState state(scene);
  std::vector<RecordedFrame> rows;
  const GpuModel model = preset_model_of(spec);
  for (const std::string& name : call.cullers) {
    const std::unique_ptr<RenderDevice> device = make_device(spec, model);
    rows.push_back(record_last_frame(lab.cullers, name, lab.cullers.short_name(name), scene, path,
                                     viewport, *device, state));
  }
  Frame frame;
  frame.index = last;
  frame.camera = path.frames[last].camera;
  frame.viewport = viewport;
  frame.objects = state.view();
  write_query_picture(picture, scene, frame,
                      scene.name + ", " + path.name + ", frame " + std::to_string(last), spec.text,
                      rows, call.output);
  std::cerr << "wrote " << call.output.string() << '\n';
  return 0;
}

}  // namespace vislab
