#include "experiments/run/block_judge.h"

#include <map>
#include <memory>
#include <tuple>

#include "common/judge/image_judge.h"
#include "experiments/context/sources.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

void add(CulledOf& sum, const CulledOf& frame) {
  sum.cullable += frame.cullable;
  sum.culled += frame.culled;
}

/// The objects of a stored set of whole objects; none for "".
std::vector<ObjectId> objects_of(const std::string& hash, const Scene& scene,
                                 const ResultStore& store) {
  std::vector<ObjectId> objects;
  if (hash.empty()) return objects;
  const VisibleSet set = store.load_set(hash);
  for (const VisibleSet::Run& run : set.runs()) {
    for (TriangleId triangle = run.first; triangle < run.first + run.count;) {
      objects.push_back(scene.object_of(triangle));
      triangle += scene.triangle_count(objects.back());
    }
  }
  return objects;
}

}  // namespace

void judge_cells(const std::vector<const ResultCell*>& cells, const Scene& scene, const Path& path,
                 const Viewport& viewport, const PathTruth& truth, RayCaster& caster, bool drawn,
                 const ResultStore& store, Progress& progress) {
  struct Pending {
    const ResultCell* cell;
    CellVerdicts verdicts;
    StabilityJudge stability;
  };
  std::vector<Pending> pending;
  for (const ResultCell* cell : cells) {
    if (cell->frames.size() == path.frames.size() &&
        !store.load_verdicts(*cell, judge_source_hash())) {
      pending.push_back({cell, {}, StabilityJudge(scene)});
      pending.back().verdicts.judge = judge_source_hash();
      pending.back().verdicts.answers = answer_hash(*cell);
    }
  }
  if (pending.empty()) return;

  const std::unique_ptr<ImageJudge> image = drawn ? std::make_unique<ImageJudge>(scene) : nullptr;
  SceneState state(scene);
  for_each_frame(path, state, viewport, [&](std::size_t index, Frame& frame, const Changes&) {
    progress.step(
        "judging frame " + std::to_string(index + 1) + " of " + std::to_string(path.frames.size()),
        0.9 + 0.1 * static_cast<double>(index) / static_cast<double>(path.frames.size()));
    const FrameTruth& seen = truth.frame(index);
    ImageJudge::Floor floor;
    if (image) {
      image->start(frame, seen);
      floor = image->error_floor(frame);
    }
    const ObjectVisibility visibility = object_visibility(scene, seen);
    const CullableTriangles cullable(frame, scene);
    std::map<std::string, VisibleSet> sets;
    std::map<std::tuple<std::string, std::string, Guarantee, Granularity>, Verdict> verdicts;
    std::map<std::string, ImageVerdict> images;  // by the sets that were drawn, and one-sided
    std::map<std::string, SurfaceVerdict> surfaces;
    for (Pending& entry : pending) {
      const std::string& hash = entry.cell->frames[index].set;
      const Granularity granularity = entry.cell->granularity;
      if (!sets.contains(hash)) sets.emplace(hash, store.load_set(hash));
      const VisibleSet& set = sets.at(hash);
      const std::string& surface = entry.cell->frames[index].surface;
      const std::vector<TriangleId> painted =
          surface.empty() ? std::vector<TriangleId>() : store.load_surface(surface);
      const std::tuple key(hash, surface, entry.cell->guarantee, granularity);
      if (!verdicts.contains(key)) {
        const ShownImage shown = shown_image(entry.cell->guarantee, painted, image.get());
        verdicts.emplace(key, judge_set(frame, seen, set, granularity, caster, shown));
      }
      entry.verdicts.frames.push_back(verdicts.at(key));
      add(entry.verdicts.back_facing, cullable.back_facing(set));
      add(entry.verdicts.outside, cullable.outside(set));
      entry.stability.add(visibility, set);
      if (image) {
        const std::string& one_sided = entry.cell->frames[index].one_sided;
        const std::string drawn_as = hash + " " + one_sided;
        if (!images.contains(drawn_as)) {
          images.emplace(drawn_as, image->judge(frame, set, objects_of(one_sided, scene, store)));
        }
        entry.verdicts.images.push_back(images.at(drawn_as));
      }
      if (!surface.empty()) {
        if (!surfaces.contains(surface)) {
          surfaces.emplace(surface, judge_surface(frame, scene, seen, painted));
        }
        entry.verdicts.surfaces.push_back(surfaces.at(surface));
      }
      entry.verdicts.floor_disputed_px += floor.disputed_px;
      entry.verdicts.floor_undisputed_px += floor.undisputed_px;
    }
  });
  for (Pending& entry : pending) {
    entry.verdicts.stability = entry.stability.verdict();
    store.save_verdicts(entry.cell->key.id(), entry.verdicts);
  }
}

}  // namespace vislab
