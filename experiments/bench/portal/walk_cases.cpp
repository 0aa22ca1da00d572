// Walks through Quake III worlds between places that players reach. Objects are what the worlds'
// leaves show; hidden is an object with a triangle that faces the eye and reaches into the frustum,
// of which no sample of J sees anything.
#include <algorithm>
#include <map>
#include <memory>

#include "common/judge/cullable.h"
#include "common/judge/metrics.h"
#include "experiments/analysis/statistics.h"
#include "experiments/bench/portal/cases.h"
#include "experiments/bench/portal/worlds.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

constexpr int rounds = 15;
/// Truth takes half a second a frame.
constexpr std::size_t truth_step = 4;
constexpr const char* walks[] = {"portal.polygon", "portal.frustum", "portal.cull_box"};

struct WalkTimes {
  double mean_us = 0.0;     // of a frame, the median of the rounds
  double dearest_us = 0.0;  // of the dearest frame, the median of its rounds
  bool repeats = true;      // the same sets in every round
};

WalkTimes times_of(const std::string& spec, const std::string& name) {
  const PortalWorld& world = portal_world(name);
  const std::unique_ptr<ICuller> culler = built_culler(spec, world.scene, 1);
  SceneState state(world.scene);
  WalkTimes times;
  std::vector<double> means;
  std::vector<std::vector<double>> by_frame(world.walk.frames.size());
  std::vector<VisibleSet> first;
  for (int round = 0; round <= rounds; ++round) {
    PathRun run = run_path(*culler, world.scene, world.walk, portal_viewport, 1, state, nullptr);
    if (round == 0) {  // warms up
      first = std::move(run.sets);
      continue;
    }
    times.repeats = times.repeats && run.sets == first;
    double sum = 0.0;
    for (std::size_t frame = 0; frame < by_frame.size(); ++frame) {
      const double us = run.round.update_us[frame] + run.round.cull_us[frame];
      by_frame[frame].push_back(us);
      sum += us;
    }
    means.push_back(sum / static_cast<double>(by_frame.size()));
  }
  times.mean_us = median(std::move(means));
  for (std::vector<double>& samples : by_frame) {
    times.dearest_us = std::max(times.dearest_us, median(std::move(samples)));
  }
  return times;
}

const WalkTimes& walk_times(const std::string& spec, const std::string& name) {
  static std::map<std::string, WalkTimes> known;
  const auto [at, is_new] = known.try_emplace(spec + name);
  if (is_new) at->second = times_of(spec, name);
  return at->second;
}

std::vector<VisibleSet> sets_of(const std::string& spec, const PortalWorld& world) {
  SceneState state(world.scene);
  return run_path(*built_culler(spec, world.scene, 1), world.scene, world.walk, portal_viewport, 1,
                  state, nullptr)
      .sets;
}

bool keeps(const VisibleSet& set, const Scene& scene, ObjectId object) {
  return set.intersects(scene.first_triangle(object), scene.triangle_count(object));
}

/// Objects that a method keeps though the world's set and the frustum exclude them, in all frames.
double kept_beyond_the_set(const std::string& spec, const std::string& name) {
  const PortalWorld& world = portal_world(name);
  const std::vector<VisibleSet> ours = sets_of(spec, world);
  const std::vector<VisibleSet> map = sets_of("portal.map_pvs", world);
  double beyond = 0.0;
  for (std::size_t frame = 0; frame < ours.size(); ++frame) {
    for (ObjectId object = 0; object < world.scene.object_count(); ++object) {
      if (keeps(ours[frame], world.scene, object) && !keeps(map[frame], world.scene, object)) {
        beyond += 1.0;
      }
    }
  }
  return beyond;
}

/// By object: does any triangle face the eye and reach into the frustum?
std::vector<std::uint8_t> could_be_seen(const Frame& frame, const Scene& scene) {
  const CullableTriangles cullable(frame, scene);
  const auto is_one = [](const CulledOf& without) { return without.culled < without.cullable; };
  std::vector<std::uint8_t> answer(scene.object_count(), 0);
  for (const ObjectId object : frame.objects.shown) {
    const TriangleId end = scene.first_triangle(object) + scene.triangle_count(object);
    for (TriangleId t = scene.first_triangle(object); t < end && answer[object] == 0; ++t) {
      const VisibleSet alone({{t, 1}});
      if (!is_one(cullable.back_facing(alone)) && !is_one(cullable.outside(alone))) {
        answer[object] = 1;
      }
    }
  }
  return answer;
}

struct WalkTruth {
  std::uint64_t hidden = 0;  // objects that the world's set and the frustum keep, over frames
  std::map<std::string, std::uint64_t> culled;  // of these, by method
  std::map<std::string, std::uint64_t> false_samples, false_objects;
};

WalkTruth find_truth(const std::string& name) {
  const PortalWorld& world = portal_world(name);
  const std::vector<VisibleSet> map = sets_of("portal.map_pvs", world);
  std::map<std::string, std::vector<VisibleSet>> sets;
  for (const char* const spec : walks) sets[spec] = sets_of(spec, world);
  RayCaster caster(world.scene, {});
  SceneState state(world.scene);
  WalkTruth result;
  for_each_frame(
      world.walk, state, portal_viewport, [&](std::size_t i, const Frame& frame, const Changes&) {
        if (i % truth_step != 0) return;
        const FrameTruth truth = caster.trace(frame);
        std::vector<std::uint8_t> is_seen(world.scene.object_count(), 0);
        for (const TriangleHits& hit : truth.hits) is_seen[world.scene.object_of(hit.triangle)] = 1;
        const std::vector<std::uint8_t> can_be = could_be_seen(frame, world.scene);
        for (ObjectId object = 0; object < world.scene.object_count(); ++object) {
          if (can_be[object] == 0 || is_seen[object] != 0 || !keeps(map[i], world.scene, object)) {
            continue;
          }
          ++result.hidden;
          for (const auto& [spec, kept] : sets) {
            if (!keeps(kept[i], world.scene, object)) ++result.culled[spec];
          }
        }
        for (const auto& [spec, kept] : sets) {
          const Verdict verdict = judge_set(frame, truth, kept[i], Granularity::object, caster);
          result.false_samples[spec] += verdict.false_px + verdict.false_jittered;
          result.false_objects[spec] += verdict.false_objects;
        }
      });
  return result;
}

const WalkTruth& walk_truth(const std::string& name) {
  static std::map<std::string, WalkTruth> known;
  const auto [at, is_new] = known.try_emplace(name);
  if (is_new) at->second = find_truth(name);
  return at->second;
}

std::uint64_t count_of(const std::map<std::string, std::uint64_t>& counts,
                       const std::string& spec) {
  const auto found = counts.find(spec);
  return found == counts.end() ? 0 : found->second;
}

Measurement culled_share(const std::string& spec, const std::string& name) {
  const WalkTruth& truth = walk_truth(name);
  return {static_cast<double>(count_of(truth.culled, spec)) / static_cast<double>(truth.hidden),
          truth.hidden > 0};
}

}  // namespace

void add_walk_cases(std::vector<BenchCase>& cases) {
  for (const std::string name : portal_worlds) {
    for (const std::string spec : walks) {
      // The bars are those of exact clipping; the others stand beside it.
      const bool is_held = spec == walks[0];
      const auto bar = [&](Bar held) { return is_held ? held : Bar{}; };
      const auto add = [&](const std::string& what, const std::string& unit,
                           const std::function<Measurement()>& measure, Bar held) {
        cases.push_back({spec, name + ", " + what, unit, "", nullptr, measure, held});
      };
      add(
          "a frame", "us",
          [=] {
            const WalkTimes& times = walk_times(spec, name);
            return Measurement{times.mean_us, times.repeats};
          },
          bar(Bar::at_most(100.0)));
      add(
          "its dearest frame", "us",
          [=] {
            const WalkTimes& times = walk_times(spec, name);
            return Measurement{times.dearest_us, times.repeats};
          },
          bar(Bar::at_most(100.0)));
      add(
          "kept beyond the map's set and the frustum", "objects",
          [=] {
            return Measurement{kept_beyond_the_set(spec, name), true};
          },
          bar(Bar::at_most(0.0)));
      add(
          "culled of what these leave hidden", "", [=] { return culled_share(spec, name); },
          bar(Bar::at_least(0.5)));
      add(
          "false samples", "samples",
          [=] {
            const WalkTruth& truth = walk_truth(name);
            return Measurement{static_cast<double>(count_of(truth.false_samples, spec)),
                               count_of(truth.false_objects, spec) == 0};
          },
          Bar::at_most(0.0));
    }
  }
}

}  // namespace vislab
