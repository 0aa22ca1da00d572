// Time grows with what is visible, not with what is there: the same views of a city with ten times
// as many boxes in its buildings, which nobody sees.
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>

#include "algorithms/all_cullers.h"
#include "common/culler/culler.h"
#include "common/scene/generators/generators.h"
#include "common/scene/library.h"
#include "experiments/analysis/statistics.h"
#include "experiments/bench/depth/cases.h"

namespace vislab {
namespace {

constexpr Viewport viewport{1024, 512};
constexpr double draw_s = 3.5e-6;  // what the lab's device takes for a small object
constexpr int rounds = 9;

/// Counts what a culler keeps.
struct CountingSink : DrawSink {
  std::size_t all = 0, kept = 0;

  void everything() override { kept = all; }
  void objects(std::span<const ObjectId> ids) override { kept += ids.size(); }
  void ranges(std::span<const TriangleRange> ranges) override { kept += ranges.size(); }
  void flush() override {}
};

struct Pass {
  double cull_s = 0.0;
  std::size_t kept = 0;
};

/// The city with so many boxes inside of its buildings.
std::shared_ptr<const Scene> city_with(std::uint32_t indoor_boxes) {
  static std::map<std::uint32_t, std::shared_ptr<const Scene>> scenes;
  std::shared_ptr<const Scene>& scene = scenes[indoor_boxes];
  if (scene == nullptr) {
    CityParameters city;
    city.street_boxes = 10'000;
    city.indoor_boxes = indoor_boxes;
    Scene made = make_city(city);
    made.finish();
    scene = std::make_shared<const Scene>(std::move(made));
  }
  return scene;
}

/// A culler's time and what it keeps over the views of a path: the median of some passes.
Pass pass_of(const std::string& spec, std::uint32_t indoor_boxes, const std::string& views) {
  const std::shared_ptr<const Scene> scene = city_with(indoor_boxes);
  const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  const Path path = load_path("city_" + views + "_8", *scene, viewport, 0, {data, data / "cache"});
  Registry registry;
  register_all_cullers(registry);
  const std::unique_ptr<ICuller> culler = registry.make(spec);
  BuildContext context;
  context.cullers = &registry;
  culler->build(*scene, context);
  culler->reset(1);
  const SceneState state(*scene);
  CountingSink sink;
  sink.all = scene->object_count();
  std::vector<double> times;
  Pass result;
  std::uint64_t index = 0;
  for (int round = 0; round <= rounds; ++round) {
    double seconds = 0.0;
    result.kept = 0;
    for (const PathFrame& frame : path.frames) {
      // Each view twice, and the second counts: methods that remember the last frame have one.
      for (int again = 0; again < 2; ++again) {
        const Frame now{index++, frame.camera, viewport, state.view(), 0.0};
        sink.kept = 0;
        const auto start = std::chrono::steady_clock::now();
        culler->update(now, {});
        culler->cull(now, Candidates::everything(), sink);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        if (again == 1) seconds += elapsed.count();
      }
      result.kept += sink.kept;
    }
    if (round > 0) times.push_back(seconds);
  }
  result.cull_s = median(times);
  return result;
}

Measurement growth(const std::string& spec, const std::string& views, bool with_drawing) {
  const Pass few = pass_of(spec, 50'000, views);
  const Pass many = pass_of(spec, 500'000, views);
  const auto time = [&](const Pass& pass) {
    return pass.cull_s + (with_drawing ? draw_s * static_cast<double>(pass.kept) : 0.0);
  };
  // Hidden boxes are kept now and then; nearly all must go.
  return {time(many) / time(few), many.kept < 2 * few.kept};
}

}  // namespace

void add_growth_cases(std::vector<BenchCase>& cases) {
  for (const std::string spec : {"depth.masked", "depth.hzb_two_pass", "depth.hzb"}) {
    for (const std::string views : {"street", "elevated"}) {
      const std::string name = "ten times the hidden, " + views;
      cases.push_back({spec, name + ", culling", "times", "", nullptr,
                       [=] { return growth(spec, views, false); }});
      cases.push_back({spec, name + ", frame", "times", "", nullptr,
                       [=] { return growth(spec, views, true); }});
    }
  }
}

}  // namespace vislab
