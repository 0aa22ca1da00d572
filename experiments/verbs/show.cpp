#include <iostream>

#include "common/judge/image_judge.h"
#include "common/judge/path_truth.h"
#include "common/render/osmesa_device.h"
#include "common/scene/error.h"
#include "experiments/matrix/resolution.h"
#include "experiments/run/path_run.h"
#include "experiments/show/frame_picture.h"
#include "experiments/show/plan_picture.h"
#include "experiments/show/surface_pictures.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

std::size_t require_frame(const Path& path, int frame) {
  const auto index = static_cast<std::size_t>(frame);
  if (index >= path.frames.size()) {
    throw InputError("--frame " + std::to_string(frame) + ": path " + path.name +
                     " has frames 0 to " + std::to_string(path.frames.size() - 1));
  }
  return index;
}

int show(const Lab& lab, const ShowCall& call) {
  const std::unique_ptr<ICuller> culler = lab.cullers.make(call.cullers.front());
  const Viewport viewport = parse_resolution(call.resolution);
  const LoadedScene loaded = load_scene(call.scene, lab.data);
  const Scene& scene = loaded.scene;
  Path path =
      load_path(call.path.empty() ? loaded.default_path : call.path, scene, viewport, 0, lab.data);
  const std::size_t last = require_frame(path, call.frame);
  // A culler may live on what it saw before: it is given the whole path up to the frame.
  path.frames.resize(last + 1);

  RayCaster caster(scene, {});
  PathTruth truth(scene);
  SceneState state(scene);
  for_each_frame(path, state, viewport, [&](std::size_t index, const Frame& frame, const Changes&) {
    const bool needed = index == last || culler->info().needs_truth;
    truth.add(needed ? caster.trace(frame) : FrameTruth{});
  });
  OsMesaDevice device;
  device.load(scene);
  TimedDevice timed_device(device);
  BuildContext context;
  context.cullers = &lab.cullers;
  context.truth = &truth;
  context.device = &timed_device;
  culler->build(scene, context);
  const PathRun run = run_path(*culler, scene, path, viewport, 1, state, &timed_device);

  Frame frame;
  frame.index = last;
  frame.camera = path.frames[last].camera;
  frame.viewport = viewport;
  frame.objects = state.view();
  const Granularity granularity = culler->info().granularity;
  ImageJudge image(scene);
  image.start(frame, truth.frame(last));
  const ShownImage shown = shown_image(culler->info().guarantee, run.surfaces[last], &image);
  const Verdict verdict =
      judge_set(frame, truth.frame(last), run.sets[last], granularity, caster, shown);
  const std::string title = scene.name + ", " + lab.cullers.short_name(call.cullers.front()) +
                            ", frame " + std::to_string(last);
  if (call.plan) {
    write_plan_picture(scene, frame, truth.frame(last), run.sets[last], verdict,
                       reached_cells(*culler, scene, run.sets[last]), title, call.output);
    std::cerr << "wrote " << call.output.string() << '\n';
    return 0;
  }
  if (!run.surfaces[last].empty()) {
    write_surface_picture(scene, frame, truth.frame(last),
                          {{lab.cullers.short_name(call.cullers.front()), run.surfaces[last]}},
                          scene.name + ", frame " + std::to_string(last) +
                              ": who owns each pixel; wrong ones in vermillion",
                          call.output);
    std::cerr << "wrote " << call.output.string() << '\n';
    return 0;
  }
  write_frame_picture(scene, frame, truth.frame(last), run.sets[last], verdict, granularity, title,
                      call.output);
  std::cerr << "wrote " << call.output.string() << '\n';
  return 0;
}

}  // namespace vislab
