#include "experiments/show/hidden_share.h"

#include <limits>

#include "common/judge/cullable.h"
#include "common/scene/error.h"
#include "experiments/results/store.h"
#include "experiments/run/path_run.h"

namespace vislab {

double HiddenTriangles::share() const {
  if (in_frustum == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(hidden) / static_cast<double>(in_frustum);
}

HiddenTriangles hidden_triangles(const Scene& scene, const Frame& frame, const FrameTruth& truth) {
  std::vector<std::uint8_t> is_seen(scene.object_count(), 0);
  for (const TriangleId triangle : truth.visible()) is_seen[scene.object_of(triangle)] = 1;
  const CullableTriangles cullable(frame, scene);
  HiddenTriangles counted;
  for (const ObjectId object : frame.objects.shown) {
    const std::uint32_t triangles = scene.triangle_count(object);
    const VisibleSet alone(std::vector<VisibleSet::Run>{{scene.first_triangle(object), triangles}});
    const CulledOf outside = cullable.outside(alone);
    if (is_seen[object] == 0 && outside.cullable - outside.culled == triangles) continue;
    counted.in_frustum += triangles;
    if (is_seen[object] == 0) counted.hidden += triangles;
  }
  return counted;
}

double stored_hidden_share(const std::filesystem::path& results, StoredScenes& scenes,
                           const BlockSummary& block) {
  if (block.cells.empty()) throw InputError("block " + block.scene + " has no cell");
  const std::string& id = block.cells.front().id;
  const ResultStore store = ResultStore::open(results);
  const std::optional<ResultCell> cell = store.load_cell(id);
  if (!cell) throw InputError("cell " + id + " is missing");
  const StoredScene stored = scenes.of(block, id);
  const TruthStore truths(store.truth_folder());
  HiddenTriangles sum;
  SceneState state(stored.scene);
  for_each_frame(
      stored.path, state, block.viewport,
      [&](std::size_t index, const Frame& frame, const Changes&) {
        const std::optional<FrameTruth> truth = truths.load(cell->frames[index].truth);
        if (!truth) {
          throw InputError("the truth of cell " + id + " is missing; run the matrix again");
        }
        const HiddenTriangles counted = hidden_triangles(stored.scene, frame, *truth);
        sum.in_frustum += counted.in_frustum;
        sum.hidden += counted.hidden;
      });
  return sum.share();
}

}  // namespace vislab
