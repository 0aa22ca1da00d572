#include <iostream>

#include "common/scene/error.h"
#include "experiments/matrix/resolution.h"
#include "experiments/run/path_run.h"
#include "experiments/show/depth_complexity_picture.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

DepthComplexity definition_of(const std::string& name) {
  std::vector<std::string> known;
  for (const DepthComplexity definition : depth_complexities) {
    if (name == to_string(definition)) return definition;
    known.emplace_back(to_string(definition));
  }
  throw unknown_name("definition of depth complexity", name, known);
}

}  // namespace

int show_depth_complexity(const Lab& lab, const ShowCall& call, bool json) {
  const DepthComplexity pictured = definition_of(call.depth_complexity);
  const Viewport viewport = parse_resolution(call.resolution);
  const LoadedScene loaded = load_scene(call.scene, lab.data);
  Path path = load_path(call.path.empty() ? loaded.default_path : call.path, loaded.scene, viewport,
                        0, lab.data);
  const std::size_t last = require_frame(path, call.frame);
  path.frames.resize(last + 1);
  SceneState state(loaded.scene);
  DepthComplexityTable table{};
  for_each_frame(path, state, viewport, [&](std::size_t index, const Frame& frame, const Changes&) {
    if (index != last) return;
    const std::string title = loaded.scene.name + ", depth complexity (" + call.depth_complexity +
                              "), frame " + std::to_string(last);
    table = measure_depth_complexity(loaded.scene, frame, pictured, title, call.output);
  });
  Table printed({"scene", "path", "frame", "definition", "mean", "p95", "max"});
  for (const DepthComplexity definition : depth_complexities) {
    const DepthComplexityFigures& figures = table[static_cast<std::size_t>(definition)];
    printed.add({loaded.scene.name, path.name, std::uint64_t{last},
                 std::string(to_string(definition)), figures.mean, std::uint64_t{figures.p95},
                 std::uint64_t{figures.max}});
  }
  printed.print(std::cout, json);
  std::cerr << "wrote " << call.output.string() << '\n';
  return 0;
}

}  // namespace vislab
