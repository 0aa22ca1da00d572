#include "experiments/run/block_runner.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>

#include "common/geometry/random.h"
#include "common/judge/path_truth.h"
#include "common/render/osmesa_device.h"
#include "common/scene/error.h"
#include "experiments/context/context.h"
#include "experiments/context/sources.h"
#include "experiments/results/hash.h"
#include "experiments/run/block_judge.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

/// Larger fields are not drawn, and looked at in a few frames only: drawing and judging them would
/// take all the time and say little about the culler.
constexpr std::size_t largest_drawn_scene_objects = 100'000;
constexpr std::size_t most_frames_of_larger_scenes = 8;

/// A cell of the block while it is being measured.
struct Runner {
  ResultCell cell;
  std::unique_ptr<ICuller> culler;  // null until it is needed
  bool anchor = false;
  bool wanted = false;  // lacks rounds
  int missing_rounds = 0;
};

/// A fresh name for this run of the block: rounds pair within it.
std::string new_session() {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return hash_text(std::to_string(now) + "/" + std::to_string(::getpid())).substr(0, 12);
}

class BlockRun {
 public:
  BlockRun(const Block& block, const RunSettings& settings, const Registry& registry,
           Progress& progress, const CellWatch& watch, const volatile std::sig_atomic_t& stop)
      : block_(block),
        settings_(settings),
        registry_(registry),
        progress_(progress),
        watch_(watch),
        stop_(stop),
        store_(ResultStore::create(settings.results)) {}

  BlockOutcome run() {
    load();
    collect_cells();
    if (std::ranges::any_of(runners_, &Runner::wanted)) {
      trace_truth();
      build_cullers();
      time_rounds();
    }
    judge();
    for (const Runner& runner : runners_) {
      outcome_.failed += runner.cell.status == ResultCell::Status::failed ? 1 : 0;
    }
    return outcome_;
  }

 private:
  void load() {
    LoadedScene loaded = load_scene(block_.scene, settings_.folders);
    scene_description_ = loaded.description;
    scene_ = std::make_unique<Scene>(std::move(loaded.scene));
    if (scene_->object_count() > largest_drawn_scene_objects) {
      block_.device = "none";
      block_.frames = block_.frames == 0
                          ? static_cast<int>(most_frames_of_larger_scenes)
                          : std::min(block_.frames, static_cast<int>(most_frames_of_larger_scenes));
    }
    path_ = load_path(block_.path.empty() ? loaded.default_path : block_.path, *scene_,
                      block_.viewport, block_.frames, settings_.folders);
    truth_settings_.seed = block_.seed;
    truth_settings_.threads = block_.threads;
  }

  void collect_cells() {
    const std::vector<std::string> anchors = anchor_chains(registry_);
    for (const BlockCuller& culler : block_.cullers) {
      Runner runner;
      const bool control = culler.replicate > 0;
      runner.anchor = control || std::ranges::find(anchors, culler.chain) != anchors.end();
      const std::string short_name = registry_.short_name(culler.chain);
      if (!runner.anchor && !settings_.filter.empty() &&
          short_name.find(settings_.filter) == std::string::npos &&
          culler.chain.find(settings_.filter) == std::string::npos) {
        continue;
      }
      runner.cell = fresh_cell(culler, control ? short_name + " (again)" : short_name);
      if (!settings_.force) {
        if (auto known = store_.load_cell(runner.cell.key.id())) {
          if (known->status != ResultCell::Status::failed || !settings_.retry_failed) {
            runner.cell = std::move(*known);
          }
        }
      }
      const int rounds = static_cast<int>(runner.cell.rounds.size());
      runner.wanted = runner.cell.status != ResultCell::Status::failed && rounds < block_.rounds;
      runner.missing_rounds = block_.rounds - rounds;
      (runner.wanted ? outcome_.measured : outcome_.present) += 1;
      runners_.push_back(std::move(runner));
    }
  }

  ResultCell fresh_cell(const BlockCuller& culler, const std::string& name) const {
    ResultCell cell;
    cell.key.chain = culler.chain;
    cell.key.scene_hash = scene_->content_hash();
    cell.key.path_hash = path_.content_hash();
    cell.key.viewport = block_.viewport;
    cell.key.seed = block_.seed;
    cell.key.device = block_.device;
    cell.key.threads = block_.threads;
    cell.key.simd = "baseline";  // no culler dispatches at run time yet
    cell.key.sources = chain_source_hash(culler.chain);
    cell.key.replicate = culler.replicate;
    cell.culler = name;
    cell.scene = scene_->name;
    cell.path = path_.name;
    cell.scene_description = scene_description_;
    cell.scene_source = block_.scene;
    cell.path_source = block_.path;
    cell.scene_objects = scene_->object_count();
    cell.scene_triangles = scene_->triangle_count();
    return cell;
  }

  void trace_truth() {
    if (caster_) return;
    caster_ = std::make_unique<RayCaster>(*scene_, truth_settings_);
    truth_ = std::make_unique<PathTruth>(*scene_);
    truth_keys_.clear();
    const TruthStore truth_store(store_.truth_folder());
    SceneState state(*scene_);
    for_each_frame(
        path_, state, block_.viewport, [&](std::size_t index, Frame& frame, const Changes&) {
          progress_.step(
              block_.title() + ": rays of frame " + std::to_string(index + 1) + " of " +
                  std::to_string(path_.frames.size()),
              0.2 * static_cast<double>(index) / static_cast<double>(path_.frames.size()));
          const std::string key = truth_key(frame, *scene_, truth_settings_);
          std::optional<FrameTruth> seen = truth_store.load(key);
          if (!seen) {
            seen = caster_->trace(frame);
            truth_store.save(key, *seen);
          }
          truth_->add(std::move(*seen));
          truth_keys_.push_back(key);
        });
  }

  /// Runs `work` for a cell; what it throws makes the cell fail.
  template <typename Function>
  void guarded(Runner& runner, Function&& work) {
    watch_.begin(runner.cell.key.id(), block_.timeout_s);
    try {
      work();
    } catch (const std::bad_alloc&) {
      fail(runner, "out of memory");
    } catch (const std::exception& error) {
      fail(runner, error.what());
    }
    watch_.end();
  }

  void fail(Runner& runner, const std::string& reason) {
    runner.cell.status = ResultCell::Status::failed;
    runner.cell.reason = reason;
    runner.wanted = false;
    runner.culler = nullptr;
    store_.save_cell(runner.cell);
    progress_.line(block_.title() + ": " + runner.cell.culler + " failed: " + reason);
  }

  void build_cullers() {
    // Mesa reads this when its first context is made.
    ::setenv("LP_NUM_THREADS", std::to_string(block_.threads).c_str(), 1);
    if (block_.device != "none") {
      device_ = std::make_unique<OsMesaDevice>();
      device_->load(*scene_);
      timed_device_ = std::make_unique<TimedDevice>(*device_);
    }
    std::map<std::string, std::string> context = run_context(settings_.repository);
    context["device"] = device_ ? device_->description() : "none";
    BuildContext build_context;
    build_context.cullers = &registry_;
    build_context.truth = truth_.get();
    build_context.device = timed_device_.get();
    build_context.threads = block_.threads;
    for (Runner& runner : runners_) {
      if (!runner.wanted && !runner.anchor) continue;
      if (runner.cell.status == ResultCell::Status::failed) continue;
      runner.culler = registry_.make(runner.cell.key.chain);
      if (runner.wanted) {
        const CullerInfo& info = runner.culler->info();
        runner.cell.guarantee = info.guarantee;
        runner.cell.repeatability = info.repeatability;
        runner.cell.granularity = info.granularity;
        runner.cell.asks_device = info.needs_device;
        runner.cell.context = context;
        // On record before it starts: if the process dies, the failure has a place to be written
        // to.
        store_.save_cell(runner.cell);
      }
      guarded(runner, [&] {
        const auto start = std::chrono::steady_clock::now();
        runner.culler->build(*scene_, build_context);
        const std::chrono::duration<double, std::milli> elapsed =
            std::chrono::steady_clock::now() - start;
        if (runner.cell.rounds.empty()) runner.cell.build_ms = elapsed.count();
        runner.cell.bytes = runner.culler->bytes();
      });
    }
  }

  void time_rounds() {
    const std::string session = new_session();
    const std::size_t frames = path_.frames.size();
    SceneState state(*scene_);
    int rounds = 0;
    for (const Runner& runner : runners_) {
      if (runner.wanted) rounds = std::max(rounds, runner.missing_rounds);
    }
    // One pass that is not kept: caches, page tables and the driver's buffers are warm afterwards.
    if (Runner& first = runners_.front(); first.culler) {
      guarded(first, [&] {
        run_path(*first.culler, *scene_, path_, block_.viewport, block_.seed, state,
                 timed_device_.get());
      });
    }
    Random random(block_.seed);
    for (int round = 0; round < rounds && stop_ == 0; ++round) {
      std::vector<Runner*> order;
      for (Runner& runner : runners_) {
        if (runner.culler && (runner.anchor || runner.missing_rounds > round)) {
          order.push_back(&runner);
        }
      }
      for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[random.below(i)]);
      }
      std::map<std::string, AnchorRound> anchor_rounds;
      std::size_t done = 0;
      for (Runner* runner : order) {
        if (stop_ != 0) break;
        progress_.step(
            block_.title() + ": round " + std::to_string(round + 1) + " of " +
                std::to_string(rounds) + ", " + runner->cell.culler,
            0.2 + 0.7 * (round + static_cast<double>(done) / static_cast<double>(order.size())) /
                      rounds);
        ++done;
        guarded(*runner, [&] {
          PathRun run = run_path(*runner->culler, *scene_, path_, block_.viewport, block_.seed,
                                 state, timed_device_.get());
          run.round.session = session;
          run.round.number = round;
          if (runner->anchor && runner->cell.key.replicate == 0) {
            anchor_rounds[runner->cell.key.chain] = {session, round, run.round.frame_ms};
          }
          if (runner->missing_rounds > round) keep(*runner, std::move(run), frames);
        });
      }
      for (Runner* runner : order) {
        if (runner->missing_rounds <= round) continue;
        if (runner->cell.status == ResultCell::Status::failed) continue;
        for (const auto& [chain, anchor] : anchor_rounds) {
          runner->cell.anchors[chain].push_back(anchor);
        }
        store_.save_cell(runner->cell);
      }
    }
    outcome_.stopped = stop_ != 0;
  }

  /// Adds a pass to its cell and saves it; a different answer than before makes the cell fail,
  /// unless the culler says that its answers depend on time.
  void keep(Runner& runner, PathRun run, std::size_t frames) {
    ResultCell& cell = runner.cell;
    for (std::size_t i = 0; i < frames; ++i) {
      run.frames[i].truth = truth_keys_[i];
      if (!cell.frames.empty() && cell.repeatability != Repeatability::timing &&
          cell.frames[i].set != run.frames[i].set) {
        throw InputError("not repeatable as it declares (" +
                         std::string(to_string(cell.repeatability)) + "): frame " +
                         std::to_string(i) + " differs from an earlier round");
      }
      store_.save_set(run.frames[i].set, run.sets[i]);
    }
    if (cell.frames.empty()) cell.frames = std::move(run.frames);
    cell.rounds.push_back(std::move(run.round));
    if (static_cast<int>(cell.rounds.size()) >= block_.rounds) {
      cell.status = ResultCell::Status::done;
    }
    store_.save_cell(cell);
  }

  void judge() {
    std::vector<const ResultCell*> judged;
    for (const Runner& runner : runners_) {
      if (runner.cell.frames.empty()) continue;
      if (store_.load_verdicts(runner.cell.key.id(), judge_source_hash())) continue;
      judged.push_back(&runner.cell);
    }
    if (judged.empty()) return;
    trace_truth();
    judge_cells(judged, *scene_, path_, block_.viewport, *truth_, *caster_, block_.device != "none",
                store_, progress_);
  }

  Block block_;
  const RunSettings& settings_;
  const Registry& registry_;
  Progress& progress_;
  const CellWatch& watch_;
  const volatile std::sig_atomic_t& stop_;
  ResultStore store_;
  BlockOutcome outcome_;
  std::unique_ptr<Scene> scene_;
  std::string scene_description_;
  Path path_;
  TruthSettings truth_settings_;
  std::unique_ptr<RayCaster> caster_;
  std::unique_ptr<PathTruth> truth_;
  std::vector<std::string> truth_keys_;
  std::unique_ptr<OsMesaDevice> device_;
  std::unique_ptr<TimedDevice> timed_device_;
  std::vector<Runner> runners_;
};

}  // namespace

BlockOutcome run_block(const Block& block, const RunSettings& settings, const Registry& registry,
                       Progress& progress, const CellWatch& watch,
                       const volatile std::sig_atomic_t& stop) {
  return BlockRun(block, settings, registry, progress, watch, stop).run();
}

}  // namespace vislab
