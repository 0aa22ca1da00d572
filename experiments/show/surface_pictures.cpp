#include "experiments/show/surface_pictures.h"

#include <algorithm>

#include "common/judge/surface_judge.h"
#include "common/render/surface_picture.h"
#include "common/scene/error.h"
#include "experiments/context/sources.h"
#include "experiments/results/store.h"
#include "experiments/run/path_run.h"

namespace vislab {

void write_surface_picture(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                           const std::vector<PaintedSurface>& surfaces, const std::string& title,
                           const std::filesystem::path& file) {
  std::vector<std::vector<std::uint8_t>> wrong;
  std::vector<SurfacePanel> panels = {{"truth, by rays", "", truth.ids, {}}};
  for (const PaintedSurface& surface : surfaces) {
    wrong.push_back(wrong_surface_pixels(frame, scene, truth, surface.owners));
    const SurfaceVerdict verdict = judge_surface(frame, scene, truth, surface.owners);
    panels.push_back({surface.name,
                      std::to_string(verdict.surface_px) + " pixels wrong, " +
                          std::to_string(verdict.disputed_surface_px) + " excused",
                      surface.owners, wrong.back()});
  }
  write_png(file, render_surface_picture(scene, frame.viewport, title, panels));
}

std::string write_stored_surfaces(const std::filesystem::path& results, StoredScenes& scenes,
                                  const BlockSummary& block, const std::filesystem::path& file) {
  const ResultStore store = ResultStore::open(results);
  std::vector<ResultCell> cells;
  std::vector<std::uint64_t> wrong;  // by frame
  for (const CellSummary& summary : block.cells) {
    // Negative controls are wrong nearly everywhere: their figures say enough.
    if (!summary.judged || !summary.paints || summary.guarantee == Guarantee::erroneous) continue;
    std::optional<ResultCell> cell = store.load_cell(summary.id);
    if (!cell) throw InputError("cell " + summary.id + " is missing");
    const std::optional<CellVerdicts> verdicts = store.load_verdicts(*cell, judge_source_hash());
    if (!verdicts) throw InputError("cell " + summary.id + " has not been judged");
    wrong.resize(verdicts->surfaces.size(), 0);
    for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] += verdicts->surfaces[i].surface_px;
    cells.push_back(std::move(*cell));
  }
  if (wrong.empty()) throw InputError("only wrong variants were measured on " + block.scene);
  const auto most = std::ranges::max_element(wrong);
  const std::size_t best =
      *most > 0 ? static_cast<std::size_t>(most - wrong.begin()) : wrong.size() / 2;
  const std::string id = cells.front().key.id();
  const StoredScene stored = scenes.of(block, id);
  const std::optional<FrameTruth> truth =
      TruthStore(store.truth_folder()).load(cells.front().frames[best].truth);
  if (!truth) {
    throw InputError("the truth of cell " + id + " is missing; run the matrix again");
  }
  std::vector<PaintedSurface> surfaces;
  for (const ResultCell& cell : cells) {
    surfaces.push_back({cell.culler, store.load_surface(cell.frames[best].surface)});
  }
  const std::string where = block.scene + ", frame " + std::to_string(best) +
                            ": who owns each pixel; wrong ones in vermillion";
  SceneState state(stored.scene);
  for_each_frame(stored.path, state, block.viewport,
                 [&](std::size_t index, const Frame& frame, const Changes&) {
                   if (index != best) return;
                   write_surface_picture(stored.scene, frame, *truth, surfaces, where, file);
                 });
  return where;
}

}  // namespace vislab
