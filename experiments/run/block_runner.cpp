#include "experiments/run/block_runner.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <new>
#include <optional>
#include <stdexcept>

#include "common/geometry/random.h"
#include "common/judge/cell_leaks.h"
#include "common/judge/path_truth.h"
#include "common/judge/region_truth.h"
#include "common/scene/error.h"
#include "common/simd/simd_target.h"
#include "experiments/calibration/calibration.h"
#include "experiments/calibration/device_fit.h"
#include "experiments/context/context.h"
#include "experiments/context/sources.h"
#include "experiments/devices/device_spec.h"
#include "experiments/results/files.h"
#include "experiments/run/block_judge.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

/// Larger fields are not drawn, and looked at in a few frames only (the city of 100,000 small
/// things, drawn in half a second, is not among them): drawing and judging them would take all the
/// time and say little about the culler.
constexpr std::size_t largest_drawn_scene_objects = 150'000;
constexpr std::size_t most_frames_of_larger_scenes = 8;
constexpr std::size_t leak_rays_per_cell = 200;

/// A cell of the block while it is being measured.
struct Runner {
  ResultCell cell;
  std::optional<ResultCell> done_before;  // the result that stays until `cell` is whole
  std::unique_ptr<ICuller> culler;        // null until it is needed, and after a failure
  bool anchor = false;
  int missing_rounds = 0;  // > 0: the cell is wanted
  int new_rounds = 0;
  bool failed_but_kept = false;  // the new cell failed, and `done_before` stays
  std::optional<PathRun> pass;   // of the round under way
};

bool has_failed(const Runner& runner) { return runner.cell.status == ResultCell::Status::failed; }

/// Rounds of different machines or builds do not belong into one cell.
bool same_circumstances(const std::map<std::string, std::string>& a,
                        const std::map<std::string, std::string>& b) {
  const auto fact = [](const auto& context, const char* name) {
    const auto found = context.find(name);
    return found == context.end() ? std::string() : found->second;
  };
  return std::ranges::all_of(std::array{"machine", "compiler", "compiler_flags", "build_type"},
                             [&](const char* name) { return fact(a, name) == fact(b, name); });
}

class BlockRun {
 public:
  BlockRun(const Block& block, const RunSettings& settings, const Registry& registry,
           Progress& progress, const CellWatch& watch, const volatile std::sig_atomic_t& stop)
      : block_(block),
        device_spec_(parse_device(block.device)),
        settings_(settings),
        registry_(registry),
        progress_(progress),
        watch_(watch),
        stop_(stop),
        store_(ResultStore::create(settings.results)) {}

  BlockOutcome run() {
    load();
    collect_cells();
    if (std::ranges::any_of(runners_, [](const Runner& r) { return r.missing_rounds > 0; })) {
      tell_of_leaks();
      if (trace_truth() && stop_ == 0) {
        build_cullers();
        time_rounds();
      }
      outcome_.stopped = stop_ != 0;
    }
    for (Runner& runner : runners_) give_back(runner);
    judge();
    for (const Runner& runner : runners_) {
      outcome_.cells.push_back(runner.cell.key.id());
      const bool failed = has_failed(runner) || runner.failed_but_kept ||
                          settings_.given_up.contains(runner.cell.key.id());
      outcome_.failed += failed ? 1 : 0;
      outcome_.measured += runner.new_rounds > 0 ? 1 : 0;
      const bool was_done = runner.new_rounds == 0 && runner.missing_rounds == 0;
      outcome_.present += was_done && !failed ? 1 : 0;
    }
    return outcome_;
  }

 private:
  void load() {
    context_ = run_context(settings_.repository);
    LoadedScene loaded = load_scene(block_.scene, settings_.folders);
    scene_description_ = loaded.description;
    scene_ = std::make_unique<Scene>(std::move(loaded.scene));
    if (scene_->object_count() > largest_drawn_scene_objects) {
      device_spec_ = parse_device("none");
      block_.device = device_spec_.text;
      block_.frames = block_.frames == 0
                          ? static_cast<int>(most_frames_of_larger_scenes)
                          : std::min(block_.frames, static_cast<int>(most_frames_of_larger_scenes));
    }
    path_ = load_path(block_.path.empty() ? loaded.default_path : block_.path, *scene_,
                      block_.viewport, block_.frames, settings_.folders);
    truth_settings_.seed = block_.seed;
    truth_settings_.threads = block_.threads;
  }

  /// Of cells that came with the scene; a game map's are as its compiler left them.
  void tell_of_leaks() {
    if (scene_->cells.empty() || scene_->quake) return;
    const CellLeaks leaks = find_cell_leaks(*scene_, leak_rays_per_cell, block_.seed);
    if (leaks.leaking_cells == 0) return;
    progress_.line(block_.title() + ": one sees out of " + std::to_string(leaks.leaking_cells) +
                   " of " + std::to_string(scene_->cells.size()) +
                   " cells elsewhere than through a portal; methods that walk through portals "
                   "leave out what is seen there. `vislab check --scene` says where");
  }

  void collect_cells() {
    const std::vector<std::string> anchors = anchor_chains(registry_);
    for (const BlockCuller& culler : block_.cullers) {
      Runner runner;
      const bool control = culler.replicate > 0;
      runner.anchor = control || std::ranges::find(anchors, culler.chain) != anchors.end();
      const std::string short_name = registry_.short_name(culler.chain);
      const bool named = settings_.filter.empty() ||
                         short_name.find(settings_.filter) != std::string::npos ||
                         culler.chain.find(settings_.filter) != std::string::npos;
      if (!runner.anchor && !named) {
        if (device_spec_.is_fitted()) {
          take_over_fit(load_stored(fresh_cell(culler, "").key.id()));
        }
        continue;
      }
      runner.cell = fresh_cell(culler, control ? short_name + " (again)" : short_name);
      take_over_stored(runner, settings_.force && named);
      runners_.push_back(std::move(runner));
    }
  }

  /// A damaged cell is as good as none.
  std::optional<ResultCell> load_stored(const std::string& id) const {
    try {
      return store_.load_cell(id);
    } catch (const DamagedCell&) {
      return std::nullopt;
    }
  }

  bool is_whole(const ResultCell& cell) const {
    return static_cast<int>(cell.rounds.size()) >= block_.rounds;
  }

  /// Cells of a block are compared, so they get one fit: that of the first that is done already.
  void take_over_fit(const std::optional<ResultCell>& stored) {
    if (!stored || stored_fit_ || stored->status == ResultCell::Status::failed) return;
    if (is_whole(*stored) && same_circumstances(stored->context, context_)) {
      stored_fit_ = stored->device_model;
    }
  }

  /// Goes on with what is stored of the cell, unless it is to be measured anew.
  void take_over_stored(Runner& runner, bool force) {
    const std::string id = runner.cell.key.id();
    const bool given_up = settings_.given_up.contains(id);
    std::optional<ResultCell> stored;
    try {
      stored = store_.load_cell(id);
    } catch (const DamagedCell& error) {
      progress_.line(block_.title() + ": " + error.what());
    }
    const bool failed = stored && stored->status == ResultCell::Status::failed;
    const bool by_this_run = stored && !stored->rounds.empty() &&
                             stored->rounds.back().session.starts_with(settings_.run);
    if (!given_up && force && !by_this_run && stored &&
        stored->status == ResultCell::Status::done) {
      runner.done_before = stored;
    }
    if (!given_up && ((force && !by_this_run) || (settings_.retry_failed && failed))) {
      stored.reset();
    }
    if (stored && !failed && !same_circumstances(stored->context, context_)) {
      // A whole cell of another machine is a result, told apart by its context; of another build,
      // or with rounds missing, it is measured anew.
      if (!is_whole(*stored) || stored->context["machine"] == context_["machine"]) stored.reset();
    }
    if (stored && !failed && device_spec_.is_fitted()) {
      take_over_fit(stored);
      const bool another_fit =
          same_circumstances(stored->context, context_) && stored->device_model != stored_fit_;
      if (!is_whole(*stored) || another_fit) stored.reset();
    }
    if (stored) {
      const std::string name = runner.cell.culler;
      const std::string scene_name = runner.cell.scene;
      runner.cell = std::move(*stored);
      runner.cell.culler = name;
      runner.cell.scene = scene_name;
    }
    if (has_failed(runner) || given_up) return;
    runner.missing_rounds =
        std::max(0, block_.rounds - static_cast<int>(runner.cell.rounds.size()));
    if (runner.missing_rounds == 0 && runner.cell.status == ResultCell::Status::running) {
      runner.cell.status = ResultCell::Status::done;  // fewer rounds are wanted than before
      store_.save_cell(runner.cell);
    }
  }

  /// What was done before is the result as long as the cell that was to replace it is not whole.
  static void give_back(Runner& runner) {
    if (!runner.done_before) return;
    runner.cell = std::move(*runner.done_before);
    runner.done_before.reset();
    runner.new_rounds = 0;
    runner.missing_rounds = 0;
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
    cell.key.simd = simd_target();
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
    std::size_t moves = 0;
    for (const PathFrame& frame : path_.frames) moves += frame.changes.moved.size();
    cell.moving_objects = static_cast<double>(moves) / static_cast<double>(path_.frames.size());
    return cell;
  }

  /// False if the run is stopped before all frames are traced; those that were are stored.
  bool trace_truth() {
    if (caster_) return truth_->frame_count() == path_.frames.size();
    caster_ = std::make_unique<RayCaster>(*scene_, truth_settings_);
    truth_ = std::make_unique<PathTruth>(*scene_);
    truth_keys_.clear();
    const TruthStore truth_store(store_.truth_folder());
    SceneState state(*scene_);
    for_each_frame(
        path_, state, block_.viewport, [&](std::size_t index, Frame& frame, const Changes&) {
          if (stop_ != 0) return;
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
    return truth_->frame_count() == path_.frames.size();
  }

  /// Runs `work` for a cell; what it throws makes the cell fail, unless a file cannot be written.
  template <typename Function>
  void guarded(Runner& runner, Function&& work) {
    watch_.begin(runner.cell.key.id(), block_.timeout_s);
    try {
      work();
    } catch (const WriteError&) {
      throw;  // not the method's fault: it is not marked as failed
    } catch (const std::bad_alloc&) {
      fail(runner, "out of memory");
    } catch (const std::exception& error) {
      fail(runner, error.what());
    }
    watch_.end();
  }

  void fail(Runner& runner, const std::string& reason) {
    runner.culler = nullptr;
    progress_.line(block_.title() + ": " + runner.cell.culler + " failed: " + reason);
    // An anchor that only ran beside others keeps the result that it has.
    if (runner.missing_rounds == 0) return;
    runner.missing_rounds = 0;
    if (runner.done_before) {
      runner.failed_but_kept = true;
      outcome_.failed_but_kept.push_back(runner.cell.culler + ": " + reason +
                                         "; the result from before is kept");
      return;
    }
    runner.cell.status = ResultCell::Status::failed;
    runner.cell.reason = reason;
    store_.save_cell(runner.cell);
  }

  void build_cullers() {
    // Mesa reads this when its first context is made.
    const int drawing_threads = device_spec_.drawing_threads(block_.threads);
    ::setenv("LP_NUM_THREADS", std::to_string(drawing_threads).c_str(), 1);
    const CostTable costs = costs_of_block();
    make_device_of_block();
    BuildContext build_context;
    build_context.cullers = &registry_;
    build_context.truth = truth_.get();
    build_context.device = timed_device_.get();
    build_context.threads = block_.threads;
    for (Runner& runner : runners_) {
      const bool wanted = runner.missing_rounds > 0;
      if ((!wanted && !runner.anchor) || has_failed(runner)) continue;
      if (settings_.given_up.contains(runner.cell.key.id())) continue;
      runner.culler = registry_.make(runner.cell.key.chain);
      if (wanted) {
        const CullerInfo& info = runner.culler->info();
        runner.cell.guarantee = info.guarantee;
        runner.cell.repeatability = info.repeatability;
        runner.cell.granularity = info.granularity;
        runner.cell.culls = info.culls;
        runner.cell.asks_device = info.needs_device;
        runner.cell.context = context_;
        // Rounds of one cell are of one build: what was handed to the first is handed to all.
        if (!runner.cell.costs || runner.cell.rounds.empty()) runner.cell.costs = costs;
        runner.cell.device_model = device_model_;
        // On record before it starts, so that a failure has a place to be written to. What was
        // there before stays until there is something better.
        if (!load_stored(runner.cell.key.id())) store_.save_cell(runner.cell);
      }
      build_context.costs = runner.cell.costs ? &*runner.cell.costs : &costs;
      guarded(runner, [&] {
        const auto start = std::chrono::steady_clock::now();
        runner.culler->build(*scene_, build_context);
        const std::chrono::duration<double, std::milli> elapsed =
            std::chrono::steady_clock::now() - start;
        if (runner.cell.rounds.empty()) runner.cell.build_ms = elapsed.count();
        runner.cell.bytes = runner.culler->bytes();
        if (wanted) judge_regions(runner);
      });
    }
    region_judge_.reset();
  }

  /// What is traced from the scene's cells serves all cullers of the block.
  void judge_regions(Runner& runner) {
    if (scene_->cells.empty() || !region_set(*runner.culler, 0, *scene_)) return;
    progress_.step(block_.title() + ": rays from all over the cells", 0.2);
    if (!region_judge_) {
      RegionSettings settings;
      settings.seed = block_.seed;
      settings.threads = block_.threads;
      region_judge_ = std::make_unique<RegionJudge>(*scene_, settings);
      region_truth_ = region_judge_->trace(reachable_cells(*scene_));
    }
    runner.cell.regions = region_judge_->judge(region_truth_, [&](CellId cell) {
      return region_set(*runner.culler, cell, *scene_).value_or(std::vector<ObjectId>());
    });
    runner.cell.regions->witnesses.clear();
  }

  void make_device_of_block() {
    GpuModel preset_model;
    if (device_spec_.is_fitted()) {
      preset_model = fit_of_block();
    } else if (device_spec_.kind == DeviceSpec::Kind::modelled) {
      preset_model = gpu_preset(device_spec_.preset).model;
    }
    device_ = make_device(device_spec_, preset_model);
    if (device_) {
      device_->load(*scene_);
      timed_device_ = std::make_unique<TimedDevice>(*device_);
    }
    if (device_spec_.kind == DeviceSpec::Kind::modelled) {
      device_model_ = device_spec_.model(preset_model);
    }
    context_["device"] = device_ ? device_->description() : "none";
  }

  GpuModel fit_of_block() {
    if (stored_fit_) return *stored_fit_;
    const int threads = device_spec_.drawing_threads(block_.threads);
    const auto known = settings_.device_fits.find(threads);
    if (known != settings_.device_fits.end()) return known->second;
    progress_.step(block_.title() + ": fitting the modelled device", 0.2);
    const GpuModel model = fit_device(threads).model;
    watch_.fitted(model);
    return model;
  }

  CostTable costs_of_block() {
    const auto known = settings_.costs.find(device_spec_.drawing_threads(block_.threads));
    if (known != settings_.costs.end()) return known->second;
    progress_.step(block_.title() + ": what drawing and testing cost", 0.2);
    const CostTable costs = calibrate();
    watch_.calibrated(costs);
    return costs;
  }

  void time_rounds() {
    // Rounds pair within a session; a block that is tried again after a crash begins another.
    const std::string session = settings_.run + "." + std::to_string(settings_.given_up.size());
    SceneState state(*scene_);
    const auto pass = [&](Runner& runner) {
      return run_path(*runner.culler, *scene_, path_, block_.viewport, block_.seed, state,
                      timed_device_.get());
    };
    int rounds = 0;
    for (const Runner& runner : runners_) rounds = std::max(rounds, runner.missing_rounds);
    // One pass that is not kept: caches, page tables and the driver's buffers are warm afterwards.
    if (Runner& first = runners_.front(); first.culler) guarded(first, [&] { pass(first); });

    Random random(block_.seed);
    for (int round = 0; round < rounds && stop_ == 0; ++round) {
      std::vector<Runner*> order;
      for (Runner& runner : runners_) {
        if (runner.culler && (runner.anchor || runner.missing_rounds > 0)) order.push_back(&runner);
      }
      for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[random.below(i)]);
      }
      for (std::size_t i = 0; i < order.size() && stop_ == 0; ++i) {
        Runner& runner = *order[i];
        const double done = round + static_cast<double>(i) / static_cast<double>(order.size());
        progress_.step(block_.title() + ": round " + std::to_string(round + 1) + " of " +
                           std::to_string(rounds) + ", " + runner.cell.culler,
                       0.2 + 0.7 * done / rounds);
        guarded(runner, [&] {
          runner.pass = pass(runner);
          runner.pass->round.session = session;
          runner.pass->round.number = round;
        });
      }
      if (stop_ == 0) keep_round(order);
      for (Runner* runner : order) runner->pass.reset();
    }
  }

  /// Adds the passes of a whole round to their cells, each with the round's anchors, and saves
  /// them.
  void keep_round(const std::vector<Runner*>& order) {
    std::map<std::string, AnchorRound> anchors;
    for (const Runner* runner : order) {
      if (!runner->anchor || runner->cell.key.replicate > 0 || !runner->pass) continue;
      const Round& round = runner->pass->round;
      anchors[runner->cell.key.chain] = {round.session, round.number, round.frame_ms};
    }
    for (Runner* runner : order) {
      if (!runner->pass || runner->missing_rounds == 0) continue;
      guarded(*runner, [&] {
        add_answers(runner->cell, *runner->pass);
        for (const auto& [chain, anchor] : anchors) runner->cell.anchors[chain].push_back(anchor);
        runner->cell.rounds.push_back(std::move(runner->pass->round));
        ++runner->new_rounds;
        if (--runner->missing_rounds == 0) {
          runner->cell.status = ResultCell::Status::done;
          runner->done_before.reset();
        }
        if (!runner->done_before) store_.save_cell(runner->cell);
      });
    }
  }

  /// The first pass gives the answers; a later one that differs makes the cell fail, unless the
  /// culler says that its answers depend on time, and time is real.
  void add_answers(ResultCell& cell, PathRun& run) {
    const bool is_modelled = device_spec_.kind == DeviceSpec::Kind::modelled;
    const bool repeats =
        cell.repeatability != Repeatability::timing || is_modelled || device_spec_.synchronous;
    if (is_modelled && !cell.rounds.empty() && cell.rounds.front().frame_ms != run.round.frame_ms) {
      throw std::runtime_error("the modelled device's times differ from an earlier round's");
    }
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      run.frames[i].truth = truth_keys_[i];
      if (!cell.frames.empty() && repeats &&
          (cell.frames[i].set != run.frames[i].set ||
           cell.frames[i].one_sided != run.frames[i].one_sided ||
           cell.frames[i].surface != run.frames[i].surface ||
           cell.frames[i].counters != run.frames[i].counters)) {
        throw std::runtime_error("not repeatable as it declares (" +
                                 std::string(to_string(cell.repeatability)) + "): frame " +
                                 std::to_string(i) + " differs from an earlier round");
      }
      store_.save_set(run.frames[i].set, run.sets[i]);
      if (!run.frames[i].one_sided.empty()) {
        store_.save_set(run.frames[i].one_sided, run.one_sided[i]);
      }
      if (!run.frames[i].surface.empty()) {
        store_.save_surface(run.frames[i].surface, run.surfaces[i]);
      }
    }
    if (cell.frames.empty()) cell.frames = std::move(run.frames);
  }

  void judge() {
    std::vector<const ResultCell*> judged;
    for (const Runner& runner : runners_) {
      if (runner.cell.frames.empty()) continue;
      if (store_.load_verdicts(runner.cell, judge_source_hash())) continue;
      judged.push_back(&runner.cell);
    }
    if (judged.empty()) return;
    if (!trace_truth()) {
      outcome_.stopped = true;
      return;
    }
    judge_cells(judged, *scene_, path_, block_.viewport, *truth_, *caster_,
                device_spec_.kind != DeviceSpec::Kind::none, store_, progress_);
  }

  Block block_;
  DeviceSpec device_spec_;
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
  std::map<std::string, std::string> context_;
  TruthSettings truth_settings_;
  std::unique_ptr<RayCaster> caster_;
  std::unique_ptr<RegionJudge> region_judge_;  // while cullers are built
  std::vector<CellTruth> region_truth_;
  std::unique_ptr<PathTruth> truth_;
  std::vector<std::string> truth_keys_;
  std::unique_ptr<RenderDevice> device_;  // null: nothing is drawn
  std::optional<GpuModel> device_model_;  // of a modelled device
  std::optional<GpuModel> stored_fit_;    // of a fitted one, if a cell of the block is done
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
