#include "report/report.h"

#include <algorithm>
#include <iostream>
#include <tuple>

#include "common/judge/path_truth.h"
#include "common/scene/error.h"
#include "experiments/devices/device_spec.h"
#include "experiments/results/store.h"
#include "experiments/run/path_run.h"
#include "experiments/show/frame_picture.h"
#include "experiments/show/hidden_share.h"
#include "experiments/show/kinds_picture.h"
#include "experiments/show/plan_picture.h"
#include "experiments/show/query_pictures.h"
#include "experiments/show/stored_depth_complexity.h"
#include "experiments/show/surface_pictures.h"
#include "experiments/verbs/missing_cells.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/size_results.h"
#include "experiments/verbs/sweep_results.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

/// From the truth that the block was judged by.
PersistenceCounts stored_persistence(const std::filesystem::path& results, StoredScenes& scenes,
                                     const BlockSummary& block) {
  if (block.cells.empty()) throw InputError("block " + block.scene + " has no cell");
  const std::string& id = block.cells.front().id;
  const StoredScene stored = scenes.of(block, id);
  const ResultStore store = ResultStore::open(results);
  const std::optional<ResultCell> cell = store.load_cell(id);
  if (!cell) throw InputError("cell " + id + " is missing");
  const TruthStore truths(store.truth_folder());
  PersistenceCounter counter(stored.scene.object_count());
  SceneState state(stored.scene);
  PathTruth visible(stored.scene);
  for_each_frame(stored.path, state, block.viewport,
                 [&](std::size_t index, const Frame& frame, const Changes&) {
                   std::optional<FrameTruth> truth = truths.load(cell->frames.at(index).truth);
                   if (!truth) throw InputError("the truth of cell " + id + " is missing");
                   visible.add(std::move(*truth));
                   counter.add(frame, visible.visible_objects(index));
                 });
  return counter.counts();
}

std::vector<double> stored_frame_times(const std::filesystem::path& results,
                                       const CellSummary& cell) {
  const std::optional<ResultCell> stored = ResultStore::open(results).load_cell(cell.id);
  if (!stored) throw InputError("cell " + cell.id + " is missing");
  std::vector<double> times;
  for (std::size_t frame = 0; frame < stored->frames.size(); ++frame) {
    std::vector<double> rounds;
    for (const Round& round : stored->rounds) {
      if (frame < round.frame_ms.size()) rounds.push_back(round.frame_ms[frame]);
    }
    if (!rounds.empty()) times.push_back(median(std::move(rounds)));
  }
  return times;
}

/// Did a query about several boxes find nothing to be seen?
bool shows_joint_queries(const RecordedFrame& row) {
  return std::ranges::any_of(row.states, [](const RecordedState& state) {
    return std::ranges::any_of(state.queries, [](const RecordedQuery& query) {
      return query.boxes.size() > 1 && query.samples == 0U;
    });
  });
}

/// Draws what methods do in the frame after a third of the block's path, on its own device; time
/// lines, of another device than a modelled one, on the first preset.
std::string stored_query_picture(const Lab& lab, StoredScenes& scenes, const BlockSummary& block,
                                 const std::vector<const CellSummary*>& cells, QueryPicture picture,
                                 const std::filesystem::path& file) {
  const StoredScene stored = scenes.of(block, block.cells.front().id);
  DeviceSpec spec = parse_device(block.device);
  GpuModel model = block.device_models.empty() ? GpuModel{} : block.device_models.front();
  if (picture == QueryPicture::timeline && spec.kind != DeviceSpec::Kind::modelled) {
    const GpuPreset& preset = gpu_presets().front();
    spec = parse_device("modelled[preset=" + std::string(preset.name) + "]");
    model = preset.model;
  }
  Path path = stored.path;
  const auto frame_index = static_cast<std::size_t>(block.frames) / 3;
  path.frames.resize(frame_index + 1);
  SceneState state(stored.scene);
  std::vector<RecordedFrame> rows;
  for (const CellSummary* cell : cells) {
    const std::unique_ptr<RenderDevice> device = make_device(spec, model);
    rows.push_back(record_last_frame(lab.cullers, cell->canonical, cell->culler, stored.scene, path,
                                     block.viewport, *device, state));
  }
  Frame frame;
  frame.index = frame_index;
  frame.camera = path.frames[frame_index].camera;
  frame.viewport = block.viewport;
  frame.objects = state.view();
  const std::string place =
      block.scene + ", " + block.path + ", frame " + std::to_string(frame_index);
  if (picture == QueryPicture::boxes && std::ranges::none_of(rows, shows_joint_queries)) {
    throw InputError("in frame " + std::to_string(frame_index) +
                     " no query about several boxes found nothing to be seen");
  }
  write_query_picture(picture, stored.scene, frame, place, spec.text, rows, file);
  return place + ", on " + spec.text;
}

PlannedGaps gaps_of(const Lab& lab, const std::filesystem::path& results,
                    const std::vector<JudgedCell>& cells) {
  const std::set<std::string> run = ResultStore::open(results).noted_matrices();
  std::vector<const ResultCell*> present;
  for (const JudgedCell& judged : cells) present.push_back(&judged.cell);
  std::vector<Matrix> matrices = readable_matrices(lab.matrices, lab.cullers);
  for (Matrix& matrix : matrices) leave_out_unfetched(matrix, lab.data);
  return find_planned_gaps(matrices, run, present, lab.cullers, OwnPaths(lab.data));
}

}  // namespace

int report(const Lab& lab, const std::filesystem::path& results,
           const std::filesystem::path& output) {
  std::vector<DamagedCell> damaged;
  const std::vector<JudgedCell> cells = require_present_cells(results, lab.cullers, &damaged);
  ReportInput input;
  std::vector<BlockSummary> blocks = summarise(cells);
  input.sizes = size_results(lab, cells, blocks);
  std::tie(input.blocks, input.sweep_blocks) =
      split_sweeps(lab, without_size_sweeps(lab, cells, std::move(blocks)), results);
  input.sweeps = sweep_results(lab, results, cells);
  input.published = load_published(lab.published, lab.cullers);
  input.errata = load_errata(lab.errata, lab.cullers);
  input.cullers = &lab.cullers;
  StoredScenes scenes(results, lab.data);
  StoredPictures pictures(results, scenes);
  input.picture = [&](const BlockSummary& block, const CellSummary& cell,
                      const std::filesystem::path& file) {
    return pictures.write(block, cell, file);
  };
  input.depth_complexity = [&](const BlockSummary& block, const std::filesystem::path& file) {
    return stored_depth_complexity(results, scenes, block, file);
  };
  input.persistence = [&](const BlockSummary& block) {
    return stored_persistence(results, scenes, block);
  };
  input.surface_picture = [&](const BlockSummary& block, const std::filesystem::path& file) {
    return write_stored_surfaces(results, scenes, block, file);
  };
  input.plan = [&](const BlockSummary& block, const CellSummary& cell,
                   const std::filesystem::path& file) {
    return write_stored_plan(results, lab.cullers, scenes, block, cell, file);
  };
  input.hidden_share = [&](const BlockSummary& block) {
    return stored_hidden_share(results, scenes, block);
  };
  input.query_picture = [&](const BlockSummary& block, const std::vector<const CellSummary*>& shown,
                            QueryPicture picture, const std::filesystem::path& file) {
    return stored_query_picture(lab, scenes, block, shown, picture, file);
  };
  input.kinds_picture = [&](const BlockSummary& block, const std::filesystem::path& file) {
    return write_stored_kinds(results, lab.cullers, scenes, block, file);
  };
  const PlannedGaps gaps = gaps_of(lab, results, cells);
  input.missing_cells = [&](const BlockSummary& block) {
    std::vector<MissingCell> missing;
    for (const CellSummary& cell : block.cells) {
      const auto found = gaps.of_block_with.find(cell.id);
      if (found == gaps.of_block_with.end()) continue;
      for (const PlannedGap& gap : found->second) missing.push_back({gap.name, gap.reason});
      break;
    }
    return missing;
  };
  for (const DamagedCell& cell : damaged) {
    input.missing_blocks.push_back({"a damaged cell", cell.what()});
  }
  for (const PlannedGap& gap : gaps.blocks) input.missing_blocks.push_back({gap.name, gap.reason});
  input.matrices = gaps.matrices;
  input.frame_times = [&](const CellSummary& cell) { return stored_frame_times(results, cell); };
  write_report(input, lab.report, output);
  std::cerr << "wrote " << (output / "index.html").string() << " and "
            << (output / "report.pdf").string() << '\n';
  return 0;
}

}  // namespace vislab
