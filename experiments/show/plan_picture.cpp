#include "experiments/show/plan_picture.h"

#include <algorithm>

#include "common/culler/cell_walker.h"
#include "common/render/cell_plan.h"
#include "common/render/osmesa_device.h"
#include "common/scene/error.h"
#include "experiments/context/sources.h"
#include "experiments/results/store.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

/// By object: does the truth see it, did the culler keep any of it?
std::vector<TriangleClass> classes_of(const Scene& scene, const FrameTruth& truth,
                                      const VisibleSet& kept) {
  std::vector<std::uint8_t> is_visible(scene.object_count(), 0);
  for (const TriangleId triangle : truth.visible()) is_visible[scene.object_of(triangle)] = 1;
  std::vector<TriangleClass> classes(scene.object_count());
  for (ObjectId object = 0; object < classes.size(); ++object) {
    const bool visible = is_visible[object] != 0;
    if (kept.intersects(scene.first_triangle(object), scene.triangle_count(object))) {
      classes[object] = visible ? TriangleClass::kept_visible : TriangleClass::kept_invisible;
    } else {
      classes[object] = visible ? TriangleClass::culled_wrongly : TriangleClass::culled_rightly;
    }
  }
  return classes;
}

std::vector<CellId> cells_that_hold(const Scene& scene, const VisibleSet& kept) {
  std::vector<CellId> cells;
  for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
    if (std::ranges::any_of(scene.cells[cell].objects, [&](ObjectId object) {
          return kept.intersects(scene.first_triangle(object), scene.triangle_count(object));
        })) {
      cells.push_back(cell);
    }
  }
  return cells;
}

std::size_t most_telling(const std::vector<Verdict>& frames) {
  const auto best = std::ranges::max_element(frames, [](const Verdict& a, const Verdict& b) {
    return a.false_px != b.false_px ? a.false_px < b.false_px
                                    : a.submitted_triangles < b.submitted_triangles;
  });
  return static_cast<std::size_t>(best - frames.begin());
}

}  // namespace

ReachedCells reached_cells(const ICuller& culler, const Scene& scene, const VisibleSet& kept) {
  ReachedCells reached;
  const auto* const walker = dynamic_cast<const CellWalker*>(&culler);
  if (walker != nullptr && walker->append_reached_cells(reached.cells)) {
    reached.means = "reached";
  } else {
    reached = {cells_that_hold(scene, kept), "that hold what was kept"};
  }
  return reached;
}

void write_plan_picture(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                        const VisibleSet& kept, const Verdict& verdict, const ReachedCells& reached,
                        const std::string& title, const std::filesystem::path& file) {
  if (scene.cells.empty()) {
    throw InputError("scene " + scene.name +
                     " has no cells to draw a plan of, as house and oa_dm2 have");
  }
  const std::vector<TriangleClass> classes = classes_of(scene, truth, kept);
  CellPlanInput input;
  input.scene = &scene;
  input.frame = &frame;
  input.title = title;
  input.objects = classes;
  input.reached = reached.cells;
  input.reached_means = reached.means;
  const auto lost =
      static_cast<std::uint64_t>(std::ranges::count_if(frame.objects.shown, [&](ObjectId object) {
        return classes[object] == TriangleClass::culled_wrongly;
      }));
  input.excused = lost - std::min(lost, verdict.false_objects);
  write_png(file, render_cell_plan(input));
}

std::string write_stored_plan(const std::filesystem::path& results, const Registry& cullers,
                              StoredScenes& scenes, const BlockSummary& block,
                              const CellSummary& cell, const std::filesystem::path& file) {
  const ResultStore store = ResultStore::open(results);
  const std::optional<ResultCell> stored = store.load_cell(cell.id);
  if (!stored) throw InputError("cell " + cell.id + " is missing");
  const std::optional<CellVerdicts> verdicts = store.load_verdicts(*stored, judge_source_hash());
  if (!verdicts) throw InputError("cell " + cell.id + " has not been judged");
  const std::size_t best = most_telling(verdicts->frames);
  const StoredScene loaded = scenes.of(block, cell.id);
  const std::optional<FrameTruth> truth =
      TruthStore(store.truth_folder()).load(stored->frames[best].truth);
  if (!truth) {
    throw InputError("the truth of cell " + cell.id + " is missing; run the matrix again");
  }
  // Chains may have a stage that asks a device.
  OsMesaDevice device;
  device.load(loaded.scene);
  TimedDevice timed_device(device);
  BuildContext context;
  context.cullers = &cullers;
  context.device = &timed_device;
  const std::unique_ptr<ICuller> culler = cullers.make(cell.canonical);
  culler->build(loaded.scene, context);
  Path path = loaded.path;
  path.frames.resize(best + 1);
  SceneState state(loaded.scene);
  run_path(*culler, loaded.scene, path, block.viewport, 1, state, &timed_device);
  Frame frame;
  frame.index = best;
  frame.camera = path.frames[best].camera;
  frame.viewport = block.viewport;
  frame.objects = state.view();
  const VisibleSet kept = store.load_set(stored->frames[best].set);
  const std::string where =
      block.scene + ", " + block.path + ", " + cell.culler + ", frame " + std::to_string(best);
  write_plan_picture(loaded.scene, frame, *truth, kept, verdicts->frames[best],
                     reached_cells(*culler, loaded.scene, kept), where, file);
  return where;
}

}  // namespace vislab
