// Potentially visible sets of Quake III worlds, the file's own and the lab's, against rays from
// viewpoints all over the cells that a player can get to.
#include <chrono>
#include <map>
#include <memory>

#include "common/judge/region_truth.h"
#include "common/scene/error.h"
#include "common/scene/quake_cells.h"
#include "experiments/bench/portal/cases.h"
#include "experiments/bench/portal/worlds.h"

namespace vislab {
namespace {

constexpr int threads = 2;
constexpr double least_rays = 10e6;
constexpr std::uint32_t viewpoints = 16;
constexpr const char* methods[] = {"portal.pvs", "portal.map_pvs"};

class Watch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Measurement time_of_cells(const std::string& name) {
  const Scene& scene = portal_world(name).scene;
  const Watch watch;
  const QuakeCells cells = find_quake_cells(*scene.quake, scene.bounds(), {});
  return {watch.seconds(), cells.cells.size() == scene.cells.size()};
}

struct BuiltSets {
  std::unique_ptr<ICuller> culler;
  double build_s = 0.0;
};

BuiltSets& built_sets(const std::string& spec, const std::string& name) {
  static std::map<std::string, BuiltSets> known;
  BuiltSets& sets = known[spec + name];
  if (sets.culler == nullptr) {
    const Scene& scene = portal_world(name).scene;
    const Watch watch;
    sets.culler = built_culler(spec, scene, threads);
    sets.build_s = watch.seconds();
  }
  return sets;
}

/// The judge of a world and what its rays hit; the last world is kept.
struct TracedWorld {
  std::string name;
  std::unique_ptr<RegionJudge> judge;
  std::vector<CellTruth> truth;
};

TracedWorld& traced_world(const std::string& name) {
  static TracedWorld traced;
  if (traced.name != name) {
    const Scene& scene = portal_world(name).scene;
    const std::vector<CellId> cells = reachable_cells(scene);
    if (cells.empty()) throw InputError("nobody can get into any cell of " + name);
    RegionSettings settings;
    settings.viewpoints = viewpoints;
    // Cells that are too thin to stand in are traced by none.
    settings.rays = static_cast<std::uint32_t>(
        1.25 * least_rays / (viewpoints * static_cast<double>(cells.size())) + 1.0);
    settings.threads = threads;
    traced.judge = std::make_unique<RegionJudge>(scene, settings);
    traced.truth = traced.judge->trace(cells);
    traced.name = name;
  }
  return traced;
}

/// A counter of sizes, which a culler adds to once a frame.
Measurement set_size(const std::string& counter, const std::string& spec, const std::string& name) {
  const PortalWorld& world = portal_world(name);
  ICuller& culler = *built_sets(spec, name).culler;
  const SceneState state(world.scene);
  const auto count = [&] {
    for (const auto& [known, value] : culler.counters()) {
      if (known == counter) return value;
    }
    throw InputError(spec + " has no counter " + counter);
  };
  const std::uint64_t before = count();
  culler.update({0, world.walk.frames.front().camera, portal_viewport, state.view(), 0.0}, {});
  const std::uint64_t bytes = count() - before;
  return {static_cast<double>(bytes) * 1e-3, bytes > 0};
}

const RegionVerdict& verdict_of(const std::string& spec, const std::string& name) {
  static std::map<std::string, RegionVerdict> known;
  const auto [at, is_new] = known.try_emplace(spec + name);
  if (is_new) {
    const Scene& scene = portal_world(name).scene;
    ICuller& culler = *built_sets(spec, name).culler;
    TracedWorld& traced = traced_world(name);
    at->second = traced.judge->judge(traced.truth, [&](CellId cell) {
      std::optional<std::vector<ObjectId>> set = region_set(culler, cell, scene);
      if (!set) throw InputError(spec + " knows of no set for a cell of " + name);
      return std::move(*set);
    });
  }
  return at->second;
}

Measurement misses(const std::string& spec, const std::string& name) {
  const RegionVerdict& verdict = verdict_of(spec, name);
  return {static_cast<double>(verdict.misses), static_cast<double>(verdict.rays) >= least_rays};
}

}  // namespace

void add_set_cases(std::vector<BenchCase>& cases) {
  for (const std::string name : portal_worlds) {
    const auto add = [&](const std::string& bench, const std::string& what, const std::string& unit,
                         const std::function<Measurement()>& measure, Bar bar) {
      cases.push_back({bench, name + ", " + what, unit, "", nullptr, measure, bar});
    };
    add(
        "cells", "found", "s", [=] { return time_of_cells(name); }, Bar::at_most(10.0));
    for (const std::string spec : methods) {
      add(
          spec, "built on 2 threads", "s",
          [=] {
            return Measurement{built_sets(spec, name).build_s, true};
          },
          Bar::at_most(300.0));
      add(spec, "memory", "kB",
          [=] {
            const std::size_t bytes = built_sets(spec, name).culler->bytes();
            return Measurement{static_cast<double>(bytes) * 1e-3, bytes > 0};
          },
          {});
      add(spec, "the sets, as they are stored", "kB",
          [=] { return set_size("set_bytes", spec, name); }, {});
      add(spec, "the sets, a bit for each pair", "kB",
          [=] { return set_size("set_raw_bytes", spec, name); }, {});
      add(
          spec, "misses of 10 million rays", "rays", [=] { return misses(spec, name); },
          Bar::at_most(0.0));
      add(spec, "kept and not seen from the cell, of what is seen", "",
          [=] {
            return Measurement{verdict_of(spec, name).over(), true};
          },
          {});
      add(spec, "kept and not seen from a point, of what is seen", "",
          [=] {
            return Measurement{verdict_of(spec, name).over_points(), true};
          },
          {});
    }
    add(
        methods[0], "over-inclusion, of that of the map's own", "",
        [=] {
          return Measurement{
              verdict_of(methods[0], name).over() / verdict_of(methods[1], name).over(), true};
        },
        Bar::at_most(1.0));
  }
}

}  // namespace vislab
