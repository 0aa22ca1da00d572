// Time grows with what is visible, not with what is there: the same views of a city with ten times
// as many boxes in its buildings, which nobody sees.
#include <algorithm>
#include <array>
#include <ctime>
#include <map>
#include <memory>

#include "algorithms/all_cullers.h"
#include "common/culler/culler.h"
#include "common/scene/library.h"
#include "experiments/analysis/statistics.h"
#include "experiments/bench/depth/cases.h"

namespace vislab {
namespace {

constexpr Viewport viewport{1024, 512};
constexpr double draw_s = 3.5e-6;  // what the lab's device takes for a small object
constexpr int rounds = 9;
constexpr const char* cullers[] = {"depth.masked", "depth.hzb_two_pass", "depth.hzb"};
constexpr const char* view_sets[] = {"street", "elevated"};

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

const DataFolders& folders() {
  static const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  static const DataFolders both{data, data / "cache"};
  return both;
}

/// Each view is asked for twice: after a cut, when what methods remember is of another view, and
/// again, when it is of the same one.
struct Passes {
  Pass cut, held;
};

/// A culler's time and what it keeps over the views of a path: the medians of some passes.
Passes passes_of(const std::string& spec, const Scene& scene, const std::string& views) {
  const Path path = load_path("city_" + views + "_8", scene, viewport, 0, folders());
  Registry registry;
  register_all_cullers(registry);
  const std::unique_ptr<ICuller> culler = registry.make(spec);
  BuildContext context;
  context.cullers = &registry;
  culler->build(scene, context);
  culler->reset(1);
  const SceneState state(scene);
  CountingSink sink;
  sink.all = scene.object_count();
  std::array<std::vector<double>, 2> times;
  std::array<Pass, 2> results;
  std::uint64_t index = 0;
  for (int round = 0; round <= rounds; ++round) {
    std::array<double, 2> seconds{};
    for (Pass& result : results) result.kept = 0;
    for (const PathFrame& frame : path.frames) {
      for (std::size_t again = 0; again < 2; ++again) {
        const Frame now{index++, frame.camera, viewport, state.view(), 0.0};
        sink.kept = 0;
        const std::clock_t start = std::clock();
        culler->update(now, {});
        culler->cull(now, Candidates::everything(), sink);
        seconds[again] += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        results[again].kept += sink.kept;
      }
    }
    if (round == 0) continue;  // warms up
    for (std::size_t again = 0; again < 2; ++again) times[again].push_back(seconds[again]);
  }
  for (std::size_t again = 0; again < 2; ++again) results[again].cull_s = median(times[again]);
  return {results[0], results[1]};
}

struct Growth {
  Passes few, many;
};

const Growth& growth_of(const std::string& spec, const std::string& views) {
  static std::map<std::string, Growth> all;
  if (all.empty()) {
    for (const bool is_many : {false, true}) {
      const Scene scene = load_scene(is_many ? "city_1m" : "city_100k", folders()).scene;
      for (const std::string each : cullers) {
        for (const std::string set : view_sets) {
          Growth& growth = all[each + set];
          (is_many ? growth.many : growth.few) = passes_of(each, scene, set);
        }
      }
    }
  }
  return all.at(spec + views);
}

Measurement growth(const std::string& spec, const std::string& views, Pass Passes::*which,
                   bool with_drawing) {
  const Growth& of_both = growth_of(spec, views);
  const Pass& few = of_both.few.*which;
  const Pass& many = of_both.many.*which;
  const auto time = [&](const Pass& pass) {
    return pass.cull_s + (with_drawing ? draw_s * static_cast<double>(pass.kept) : 0.0);
  };
  // A hidden box is kept now and then; nearly all must go. The bar of 2 stands in the name: a time
  // that misses it is slow, not wrong.
  return {time(many) / time(few), many.kept < 2 * few.kept};
}

}  // namespace

void add_growth_cases(std::vector<BenchCase>& cases) {
  for (const std::string spec : cullers) {
    for (const std::string views : view_sets) {
      for (const bool cut : {true, false}) {
        const auto which = cut ? &Passes::cut : &Passes::held;
        const std::string name = "ten times the hidden, below 2, " + views +
                                 (cut ? ", after a cut" : ", the view before again");
        cases.push_back({spec, name + ", culling", "times", "", nullptr,
                         [=] { return growth(spec, views, which, false); }});
        cases.push_back({spec, name + ", frame", "times", "", nullptr,
                         [=] { return growth(spec, views, which, true); }});
      }
    }
  }
}

}  // namespace vislab
