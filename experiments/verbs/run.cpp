#include <algorithm>
#include <charconv>
#include <iostream>
#include <thread>

#include "common/scene/error.h"
#include "experiments/devices/device_spec.h"
#include "experiments/matrix/own_paths.h"
#include "experiments/matrix/resolution.h"
#include "experiments/matrix/size_sweep.h"
#include "experiments/results/folder_lock.h"
#include "experiments/run/matrix_runner.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/sweep_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

constexpr const char* all_sweeps = "stress";
constexpr const char* all_size_sweeps = "model_size";

/// A matrix of the lab, and which blocks of a call are its.
struct PlannedMatrix {
  std::string name;
  std::size_t first_block = 0, end_block = 0;
};

/// What a call asks for.
struct Work {
  std::vector<Block> blocks;
  std::vector<Sweep> sweeps;
  std::vector<std::size_t> first_block;  // of each sweep
  std::vector<PlannedMatrix> matrices;
};

void tell_absent(const std::string& name, const std::vector<std::string>& absent) {
  for (const std::string& culler : absent) {
    std::cerr << "vislab: " << name << " goes on without " << culler
              << ": not in this build (README.md: Peers)\n";
  }
}

void add_sweep(Work& work, Sweep sweep) {
  tell_absent(sweep.name, sweep.absent);
  work.first_block.push_back(work.blocks.size());
  work.blocks.insert(work.blocks.end(), sweep.blocks.begin(), sweep.blocks.end());
  work.sweeps.push_back(std::move(sweep));
}

void add_size_sweep(Work& work, const SizeSweep& sweep) {
  work.blocks.insert(work.blocks.end(), sweep.blocks.begin(), sweep.blocks.end());
}

/// Matrices are looked for before sweeps, and all by name before by file.
void add_named(Work& work, const std::string& name, const Lab& lab,
               const std::filesystem::path& results) {
  const auto is_in = [&](const std::filesystem::path& folder) {
    return std::filesystem::is_regular_file(folder / (name + ".toml"));
  };
  if (!is_in(lab.matrices) && name == all_sweeps) {
    for (Sweep& sweep : load_sweeps(lab.sweeps, results, lab.cullers)) {
      add_sweep(work, std::move(sweep));
    }
    return;
  }
  if (!is_in(lab.matrices) && name == all_size_sweeps) {
    for (const SizeSweep& sweep : load_size_sweeps(lab.size_sweeps, lab.cullers)) {
      add_size_sweep(work, sweep);
    }
    return;
  }
  if (!is_in(lab.matrices) && is_in(lab.size_sweeps)) {
    add_size_sweep(work, load_size_sweep(name, lab.size_sweeps, lab.cullers));
    return;
  }
  const bool is_file = std::filesystem::is_regular_file(name);
  if (!is_in(lab.matrices) && (is_in(lab.sweeps) || (is_file && is_sweep_file(name)))) {
    add_sweep(work, load_sweep(name, lab.sweeps, results, lab.cullers));
    return;
  }
  if (!is_in(lab.matrices) && !std::filesystem::exists(name)) {
    std::vector<std::string> known{all_sweeps, all_size_sweeps};
    for (const auto& [matrix, text] : list_matrices(lab.matrices)) known.push_back(matrix);
    for (const auto& [sweep, text] : list_sweeps(lab.sweeps)) known.push_back(sweep);
    for (const auto& [sweep, text] : list_matrices(lab.size_sweeps)) known.push_back(sweep);
    throw unknown_name("matrix, stress sweep or file", name, known);
  }
  Matrix matrix = load_matrix(name, lab.matrices, lab.cullers);
  tell_absent(name, matrix.absent);
  for (const UnfetchedScene& left_out : leave_out_unfetched(matrix, lab.data)) {
    std::cerr << "vislab: " << name << " goes on without scene " << left_out.scene << ": package "
              << left_out.package << " has not been fetched; `./lab setup` fetches it\n";
  }
  const std::size_t first = work.blocks.size();
  work.blocks.insert(work.blocks.end(), matrix.blocks.begin(), matrix.blocks.end());
  const fs::path file = is_in(lab.matrices) ? lab.matrices / (name + ".toml") : fs::path(name);
  std::error_code code;
  if (fs::equivalent(fs::absolute(file).parent_path(), lab.matrices, code)) {
    work.matrices.push_back({file.stem().string(), first, work.blocks.size()});
  }
}

/// A matrix of which nothing was measured, now or before, was not run.
void note_matrices(const Work& work, const RunOutcome& outcome, const ResultStore& store) {
  for (const PlannedMatrix& matrix : work.matrices) {
    bool is_any_there = false;
    for (std::size_t block = matrix.first_block; block < matrix.end_block; ++block) {
      is_any_there = is_any_there ||
                     std::ranges::any_of(outcome.cells_of_block.at(block),
                                         [&](const std::string& id) { return store.holds(id); });
    }
    if (is_any_there) store.note_matrix(matrix.name);
  }
}

Work work_of(const Lab& lab, const RunCall& call) {
  Work work;
  if (!call.culler.empty()) {
    Block block;
    block.scene = call.scene;
    block.path = call.path;
    block.viewport = parse_resolution(call.resolution);
    block.frames = call.frames;
    block.rounds = call.rounds;
    block.device = parse_device(call.draw).text;
    block.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    work.blocks = single_block(call.culler, block, lab.cullers).blocks;
  }
  for (const std::string& name : call.matrices) add_named(work, name, lab, call.results);
  if (call.threads > 0) {
    for (Block& block : work.blocks) block.threads = call.threads;
  }
  return work;
}

/// The errors, each once: those of a sweep's scene or path, which may come at every value of its
/// dial, as one that names the sweep.
std::vector<std::string> told_once(const std::vector<std::string>& errors,
                                   const std::vector<Sweep>& sweeps) {
  std::vector<std::string> told;
  std::set<std::string> told_sweeps;
  for (const std::string& error : errors) {
    std::string text = error;
    std::string of_sweep;
    for (const Sweep& sweep : sweeps) {
      for (const SweepFile& file : sweep.files) {
        const auto at = text.find(file.file.string());
        if (at == std::string::npos) continue;
        of_sweep = sweep.name;
        text = "sweep " + sweep.name + ", " + text;
        break;
      }
      if (!of_sweep.empty()) break;
    }
    if (!of_sweep.empty() && !told_sweeps.insert(of_sweep).second) continue;
    if (std::ranges::find(told, text) == told.end()) told.push_back(text);
  }
  return told;
}

/// "2/4" as {2, 4}.
std::pair<int, int> parse_shard(const std::string& text) {
  if (text.empty()) return {1, 1};
  const auto slash = text.find('/');
  int shard = 0;
  int shards = 0;
  if (slash != std::string::npos) {
    std::from_chars(text.data(), text.data() + slash, shard);
    std::from_chars(text.data() + slash + 1, text.data() + text.size(), shards);
  }
  if (shard < 1 || shards < shard) {
    throw InputError("--shard '" + text + "' is not i/n with 1 <= i <= n, such as 1/4");
  }
  return {shard, shards};
}

/// The cells of a run, in the columns that a first look needs.
void print_results(const Lab& lab, const RunCall& call, const std::set<std::string>& ids) {
  Table table({"scene",        "path",       "frames",        "culler",
               "device",       "status",     "frame_ms",      "frame_ms_p99",
               "against_none", "cull_us",    "draw_ms",       "submitted_triangles",
               "over",         "recall",     "false_px",      "pixels",
               "image_px",     "surface_px", "false_objects", "false_triangles",
               "excused_px"});
  for (const BlockSummary& block : summarise(present_cells(call.results, lab.cullers))) {
    for (const CellSummary& cell : block.cells) {
      if (!ids.contains(cell.id)) continue;
      const auto judged = [&](auto value) {
        return cell.judged ? TableValue(value) : TableValue();
      };
      table.add({block.scene,
                 block.path,
                 static_cast<std::uint64_t>(block.frames),
                 cell.culler,
                 block.device,
                 cell.status == ResultCell::Status::failed ? "failed: " + cell.reason
                                                           : to_string(cell.status),
                 cell.frame_ms.median.value,
                 cell.frame_ms.p99,
                 cell.against_none.value,
                 cell.cull_us.median.value,
                 cell.draw_ms.median.value,
                 cell.submitted_triangles,
                 judged(cell.over),
                 judged(cell.recall),
                 judged(cell.false_px),
                 judged(cell.pixels),
                 cell.drawn ? judged(cell.image_px) : TableValue(),
                 cell.paints ? judged(cell.surface_px) : TableValue(),
                 judged(cell.false_objects),
                 judged(cell.false_triangles),
                 judged(cell.excused_px)});
    }
  }
  table.print(std::cout, call.json);
}

/// How far a cell of a plan is. Scenes are not loaded: one that was changed since under the same
/// name is found out by the run.
std::string status_of(const Block& block, const BlockCuller& culler,
                      const std::vector<JudgedCell>& stored, const OwnPaths& paths) {
  for (const JudgedCell& judged : stored) {
    const ResultCell& cell = judged.cell;
    if (cell.key.chain != culler.chain || cell.key.replicate != culler.replicate ||
        !paths.is_on(cell, block) || cell.key.viewport != block.viewport ||
        cell.key.seed != block.seed || cell.key.threads != block.threads) {
      continue;
    }
    // The run does not draw large scenes, and looks at few of their frames, whatever is asked.
    const bool reduced = cell.key.device == "none" && block.device != "none";
    if (cell.key.device != block.device && !reduced) continue;
    if (cell.status == ResultCell::Status::failed) return "failed: " + cell.reason;
    if (block.frames > 0 && !reduced && static_cast<int>(cell.frames.size()) != block.frames) {
      continue;
    }
    const auto rounds = static_cast<int>(cell.rounds.size());
    return rounds >= block.rounds
               ? "done"
               : std::to_string(rounds) + " of " + std::to_string(block.rounds) + " rounds";
  }
  return "open";
}

/// What is called by its name has to be described in the folder; files are read by the run.
void require_described(const std::string& kind, const std::string& name,
                       const std::filesystem::path& folder) {
  if (name.find_first_of("/.") != std::string::npos || std::filesystem::exists(name) ||
      std::filesystem::exists(folder / (name + ".toml"))) {
    return;
  }
  std::vector<std::string> known;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") known.push_back(entry.path().stem().string());
  }
  std::ranges::sort(known);
  throw unknown_name(kind, name, known);
}

void require_filter_fits(const Lab& lab, const RunCall& call, const std::vector<Block>& blocks) {
  if (call.filter.empty()) return;
  std::set<std::string> names;
  for (const Block& block : blocks) {
    for (const BlockCuller& culler : block.cullers) {
      if (culler.chain.find(call.filter) != std::string::npos) return;
      names.insert(lab.cullers.short_name(culler.chain));
    }
  }
  if (std::ranges::any_of(names, [&](const std::string& name) {
        return name.find(call.filter) != std::string::npos;
      })) {
    return;
  }
  throw unknown_name("part of a chain of these matrices", call.filter,
                     {names.begin(), names.end()});
}

}  // namespace

int plan(const Lab& lab, const RunCall& call) {
  Table table({"block", "scene", "path", "resolution", "frames", "rounds", "device", "threads",
               "culler", "status"});
  std::vector<JudgedCell> stored;
  if (std::filesystem::exists(call.results / "cells"))
    stored = present_cells(call.results, lab.cullers);
  const OwnPaths paths(lab.data);
  const std::vector<Block> blocks = work_of(lab, call).blocks;
  for (const Block& block : blocks) {
    require_described("scene or file", block.scene, lab.data.data / "scenes");
    if (!block.path.empty()) {
      require_described("path or file", block.path, lab.data.data / "paths");
    }
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Block& block = blocks[i];
    for (const BlockCuller& culler : block.cullers) {
      table.add({std::uint64_t{i + 1}, block.scene, block.path.empty() ? "default" : block.path,
                 std::to_string(block.viewport.width) + "x" + std::to_string(block.viewport.height),
                 static_cast<std::uint64_t>(block.frames), static_cast<std::uint64_t>(block.rounds),
                 block.device, static_cast<std::uint64_t>(block.threads),
                 lab.cullers.short_name(culler.chain) + (culler.replicate > 0 ? " (again)" : ""),
                 status_of(block, culler, stored, paths)});
    }
  }
  table.print(std::cout, call.json);
  return 0;
}

int run(const Lab& lab, const RunCall& call) {
  const Work work = work_of(lab, call);
  require_filter_fits(lab, call, work.blocks);
  RunOptions options;
  options.settings.folders = lab.data;
  options.settings.repository = lab.repository;
  options.settings.results = call.results;
  options.settings.filter = call.filter;
  options.settings.force = call.force;
  options.settings.retry_failed = call.retry_failed;
  std::tie(options.shard, options.shards) = parse_shard(call.shard);
  options.quiet = call.quiet;
  // Wrong folders are told before any work.
  const ResultStore store = ResultStore::create(call.results);
  const FolderLock lock(call.results, [&] {
    std::cerr << "vislab: another run writes into " << call.results.string()
              << "; waiting for it to end\n";
  });
  for (const Sweep& sweep : work.sweeps) write_sweep_files(sweep);
  const RunOutcome outcome = run_blocks(work.blocks, options, lab.cullers);
  if (call.filter.empty()) note_matrices(work, outcome, store);
  for (std::size_t i = 0; i < work.sweeps.size(); ++i) {
    note_sweep_cells(work.sweeps[i], outcome, work.first_block[i], call.results);
  }
  if (outcome.errors.empty() || !outcome.cells.empty()) print_results(lab, call, outcome.cells);
  if (!outcome.errors.empty()) {
    std::string all;
    for (const std::string& error : told_once(outcome.errors, work.sweeps)) {
      all += (all.empty() ? "" : "\n") + error;
    }
    throw InputError(all);
  }
  for (const std::string& failure : outcome.failures) std::cerr << "vislab: " << failure << '\n';
  if (outcome.stopped) {
    std::cerr << (call.force ? "stopped; what was not measured again is as it was\n"
                             : "stopped; the same call goes on from here\n");
    return 1;
  }
  return outcome.failed > 0 || !outcome.failures.empty() ? 1 : 0;
}

}  // namespace vislab
