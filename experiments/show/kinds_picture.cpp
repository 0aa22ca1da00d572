#include "experiments/show/kinds_picture.h"

#include <algorithm>
#include <optional>

#include "common/geometry/frustum.h"
#include "common/scene/error.h"
#include "common/scene/transform.h"
#include "experiments/results/store.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

constexpr const char* portal_method = "portal.polygon";
constexpr const char* detail_method = "detail.screen_size";
constexpr double least_threshold_px = 4.0;
constexpr std::size_t frames_looked_at = 12;

VisibleSet kept_by(const Registry& cullers, const std::string& chain, const Scene& scene,
                   const Frame& frame) {
  const std::unique_ptr<ICuller> culler = cullers.make(chain);
  culler->build(scene, BuildContext{});
  culler->reset(1);
  culler->update(frame, {});
  RecordingSink sink;
  sink.start(scene, frame);
  culler->cull(frame, Candidates::everything(), sink);
  return sink.set();
}

bool keeps_object(const Scene& scene, const VisibleSet& kept, ObjectId object) {
  return kept.intersects(scene.first_triangle(object), scene.triangle_count(object));
}

bool outside_a_plane(const Frustum& frustum, const std::array<glm::dvec3, 3>& corners) {
  return std::ranges::any_of(frustum.span(), [&](const Plane& plane) {
    return std::ranges::all_of(corners,
                               [&](const glm::dvec3& p) { return plane.signed_distance(p) < 0.0; });
  });
}

bool faces_away(const Camera& camera, const std::array<glm::dvec3, 3>& corners, bool mirrored) {
  glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (mirrored) normal = -normal;
  const glm::dvec3 to_eye = camera.lens.projection == Projection::perspective
                                ? camera.pose.eye - corners[0]
                                : camera.pose.back;
  return glm::dot(normal, to_eye) < 0.0;
}

/// Moves what detail culling leaves out to that kind, at the least threshold that does.
void add_detail(const Scene& scene, const Frame& frame, const Registry& cullers,
                FrameKinds& found) {
  const double most = 0.01 * frame.viewport.width * frame.viewport.height;
  for (double px = least_threshold_px; px <= most && found.detail_px == 0.0; px *= 4.0) {
    const std::string chain =
        std::string(detail_method) + "[threshold_px=" + std::to_string(static_cast<int>(px)) + "]";
    const VisibleSet kept = kept_by(cullers, chain, scene, frame);
    for (const ObjectId object : frame.objects.shown) {
      if (keeps_object(scene, kept, object)) continue;
      const TriangleId first = scene.first_triangle(object);
      for (TriangleId id = first; id < first + scene.triangle_count(object); ++id) {
        if (found.kinds[id] != CullingKind::drawn) continue;
        found.kinds[id] = CullingKind::detail;
        found.detail_px = px;
      }
    }
  }
}

std::size_t kinds_in(const FrameKinds& found) {
  return static_cast<std::size_t>(
      std::count_if(found.counts.begin() + 1, found.counts.end(), [](auto n) { return n > 0; }));
}

std::uint64_t rarest(const FrameKinds& found) {
  std::uint64_t least = UINT64_MAX;
  for (std::size_t i = 1; i < culling_kind_count; ++i) {
    if (found.counts[i] > 0) least = std::min(least, found.counts[i]);
  }
  return least;
}

std::array<std::string, culling_kind_count> notes_of(const FrameKinds& found) {
  std::array<std::string, culling_kind_count> notes;
  for (std::size_t i = 0; i < culling_kind_count; ++i) {
    notes[i] = std::to_string(found.counts[i]) + " triangles";
  }
  if (found.detail_px > 0.0) {
    notes[static_cast<std::size_t>(CullingKind::detail)] +=
        ", objects of up to " + std::to_string(static_cast<int>(found.detail_px)) + " px";
  }
  return notes;
}

}  // namespace

FrameKinds kinds_of_frame(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                          const Registry& cullers) {
  FrameKinds found;
  found.kinds.assign(scene.triangle_count(), CullingKind::drawn);
  std::vector<std::uint8_t> is_visible(scene.triangle_count(), 0);
  for (const TriangleId id : truth.visible()) is_visible[id] = 1;
  std::optional<VisibleSet> reached;
  if (!scene.cells.empty()) reached = kept_by(cullers, portal_method, scene, frame);
  const Frustum frustum = frustum_of(frame.camera);
  for (const ObjectId object : frame.objects.shown) {
    const Mesh& mesh = scene.mesh_of(object);
    const glm::dmat4x3& transform = frame.objects.transforms[object];
    const bool mirrored = determinant(transform) < 0.0;
    const bool unreached = reached && !keeps_object(scene, *reached, object);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const TriangleId id = scene.first_triangle(object) + i;
      if (is_visible[id] != 0) continue;
      const auto corners = world_triangle(mesh, transform, i);
      found.kinds[id] = outside_a_plane(frustum, corners) ? CullingKind::view_frustum
                        : unreached                       ? CullingKind::portal
                        : mesh.solid && faces_away(frame.camera, corners, mirrored)
                            ? CullingKind::back_face
                            : CullingKind::occlusion;
    }
  }
  add_detail(scene, frame, cullers, found);
  for (const ObjectId object : frame.objects.shown) {
    const TriangleId first = scene.first_triangle(object);
    for (TriangleId id = first; id < first + scene.triangle_count(object); ++id) {
      ++found.counts[static_cast<std::size_t>(found.kinds[id])];
    }
  }
  return found;
}

KindsPicture write_stored_kinds(const std::filesystem::path& results, const Registry& cullers,
                                StoredScenes& scenes, const BlockSummary& block,
                                const std::filesystem::path& file) {
  if (block.cells.empty()) throw InputError("block " + block.scene + " has no cell");
  const std::string& id = block.cells.front().id;
  const StoredScene& stored = scenes.of(block, id);
  const ResultStore store = ResultStore::open(results);
  const std::optional<ResultCell> cell = store.load_cell(id);
  if (!cell) throw InputError("cell " + id + " is missing");
  const TruthStore truths(store.truth_folder());
  const std::size_t step = std::max<std::size_t>(1, stored.path.frames.size() / frames_looked_at);
  std::optional<std::size_t> best_frame;
  FrameKinds best;
  SceneState state(stored.scene);
  const auto visit_all = [&](auto&& visit) {
    for_each_frame(
        stored.path, state, block.viewport,
        [&](std::size_t index, const Frame& frame, const Changes&) { visit(index, frame); });
  };
  visit_all([&](std::size_t index, const Frame& frame) {
    if (index % step != 0 || index >= cell->frames.size()) return;
    const std::optional<FrameTruth> truth = truths.load(cell->frames[index].truth);
    if (!truth) throw InputError("the truth of cell " + id + " is missing; run the matrix again");
    FrameKinds found = kinds_of_frame(stored.scene, frame, *truth, cullers);
    if (!best_frame ||
        std::pair(kinds_in(found), rarest(found)) > std::pair(kinds_in(best), rarest(best))) {
      best_frame = index;
      best = std::move(found);
    }
  });
  if (!best_frame) throw InputError("the path of cell " + id + " has no frame");
  KindsPicture picture;
  picture.place = block.scene + ", " + block.path + ", frame " + std::to_string(*best_frame);
  picture.kinds = kinds_in(best);
  picture.detail_px = best.detail_px;
  visit_all([&](std::size_t index, const Frame& frame) {
    if (index != *best_frame) return;
    KindsPictureInput input;
    input.scene = &stored.scene;
    input.frame = &frame;
    input.kinds = best.kinds;
    input.title = picture.place;
    input.notes = notes_of(best);
    write_png(file, render_kinds_picture(input));
  });
  return picture;
}

}  // namespace vislab
