#include "experiments/show/kinds_picture.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "common/culler/cell_walker.h"
#include "common/geometry/frustum.h"
#include "common/scene/error.h"
#include "common/scene/transform.h"
#include "experiments/results/store.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

constexpr double least_threshold_px = 4.0;
constexpr double most_threshold_px = 256.0;  // no larger thing is a detail
constexpr std::size_t frames_looked_at = 48;

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

/// One that decides about objects by itself.
bool stands_alone(const CullerInfo& info) {
  return info.granularity == Granularity::object && !info.needs_device && !info.needs_truth;
}

/// The method's parameter that is a number of pixels; null if it has none.
const ParameterSpec* pixel_threshold(const CullerInfo& info) {
  const auto found = std::ranges::find_if(info.parameters, [](const ParameterSpec& parameter) {
    const bool is_number = parameter.type == ParameterSpec::Type::integer ||
                           parameter.type == ParameterSpec::Type::real;
    return is_number && (parameter.unit == "px" || parameter.unit == "pixels");
  });
  return found == info.parameters.end() ? nullptr : &*found;
}

void prepare(ICuller& culler, const Scene& scene) {
  culler.build(scene, BuildContext{});
  culler.reset(1);
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

/// Does `a` show more than `b`: more kinds, else smaller details, else more of the rarest kind?
bool tells_more(const FrameKinds& a, const FrameKinds& b) {
  return std::tuple(kinds_in(a), -a.detail_px, rarest(a)) >
         std::tuple(kinds_in(b), -b.detail_px, rarest(b));
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

KindFinder::KindFinder(const Scene& scene, const Registry& cullers) : scene_(&scene) {
  for (const auto& [name, entry] : cullers.entries()) {
    if (!stands_alone(entry.info)) continue;
    if (entry.info.guarantee == Guarantee::conservative && !scene.cells.empty()) {
      std::unique_ptr<ICuller> culler = cullers.make(name);
      if (dynamic_cast<const CellWalker*>(culler.get()) == nullptr) continue;
      prepare(*culler, scene);
      walkers_.push_back(std::move(culler));
    }
    const ParameterSpec* const threshold = pixel_threshold(entry.info);
    if (entry.info.guarantee != Guarantee::approximate || threshold == nullptr) continue;
    if (!detail_.empty()) continue;
    for (double px = least_threshold_px; px <= most_threshold_px; px *= 4.0) {
      const std::string value = std::to_string(static_cast<int>(px));
      detail_.push_back({px, cullers.make(name + "[" + threshold->name + "=" + value + "]")});
      prepare(*detail_.back().culler, scene);
    }
  }
}

void KindFinder::update(const Frame& frame, const Changes& changes) {
  for (const auto& walker : walkers_) walker->update(frame, changes);
  for (const DetailCuller& detail : detail_) detail.culler->update(frame, changes);
}

FrameKinds KindFinder::find(const Frame& frame, const FrameTruth& truth) {
  FrameKinds found;
  found.kinds.assign(scene_->triangle_count(), CullingKind::drawn);
  std::vector<std::uint8_t> is_visible(scene_->triangle_count(), 0);
  for (const TriangleId id : truth.visible()) is_visible[id] = 1;
  std::vector<VisibleSet> reached;
  for (const auto& walker : walkers_) reached.push_back(kept_by(*walker, frame));
  const Frustum frustum = frustum_of(frame.camera);
  for (const ObjectId object : frame.objects.shown) {
    const Mesh& mesh = scene_->mesh_of(object);
    const glm::dmat4x3& transform = frame.objects.transforms[object];
    const bool mirrored = determinant(transform) < 0.0;
    const bool unreached = std::ranges::any_of(
        reached, [&](const VisibleSet& kept) { return !keeps_object(kept, object); });
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const TriangleId id = scene_->first_triangle(object) + i;
      if (is_visible[id] != 0) continue;
      const auto corners = world_triangle(mesh, transform, i);
      found.kinds[id] = outside_a_plane(frustum, corners) ? CullingKind::view_frustum
                        : unreached                       ? CullingKind::portal
                        : mesh.solid && faces_away(frame.camera, corners, mirrored)
                            ? CullingKind::back_face
                            : CullingKind::occlusion;
    }
  }
  add_detail(frame, found);
  for (const ObjectId object : frame.objects.shown) {
    const TriangleId first = scene_->first_triangle(object);
    for (TriangleId id = first; id < first + scene_->triangle_count(object); ++id) {
      ++found.counts[static_cast<std::size_t>(found.kinds[id])];
    }
  }
  return found;
}

VisibleSet KindFinder::kept_by(ICuller& culler, const Frame& frame) const {
  RecordingSink sink;
  sink.start(*scene_, frame);
  culler.cull(frame, Candidates::everything(), sink);
  return sink.set();
}

bool KindFinder::keeps_object(const VisibleSet& kept, ObjectId object) const {
  return kept.intersects(scene_->first_triangle(object), scene_->triangle_count(object));
}

/// Moves what detail culling leaves out to that kind, at the least threshold that does.
void KindFinder::add_detail(const Frame& frame, FrameKinds& found) {
  for (const DetailCuller& detail : detail_) {
    const VisibleSet kept = kept_by(*detail.culler, frame);
    for (const ObjectId object : frame.objects.shown) {
      if (keeps_object(kept, object)) continue;
      const TriangleId first = scene_->first_triangle(object);
      for (TriangleId id = first; id < first + scene_->triangle_count(object); ++id) {
        if (found.kinds[id] != CullingKind::drawn) continue;
        found.kinds[id] = CullingKind::detail;
        found.detail_px = detail.threshold_px;
      }
    }
    if (found.detail_px > 0.0) return;
  }
}

KindsPicture write_stored_kinds(const std::filesystem::path& results, const Registry& cullers,
                                StoredScenes& scenes, const BlockSummary& block,
                                const std::filesystem::path& file) {
  if (block.cells.empty()) throw InputError("block " + block.scene + " has no cell");
  const std::string& id = block.cells.front().id;
  const StoredScene stored = scenes.of(block, id);
  const ResultStore store = ResultStore::open(results);
  const std::optional<ResultCell> cell = store.load_cell(id);
  if (!cell) throw InputError("cell " + id + " is missing");
  const TruthStore truths(store.truth_folder());
  const std::size_t step = std::max<std::size_t>(1, stored.path.frames.size() / frames_looked_at);
  std::optional<std::size_t> best_frame;
  FrameKinds best;
  SceneState state(stored.scene);
  KindFinder finder(stored.scene, cullers);
  const auto visit_all = [&](auto&& visit) {
    for_each_frame(stored.path, state, block.viewport, visit);
  };
  visit_all([&](std::size_t index, const Frame& frame, const Changes& changes) {
    finder.update(frame, changes);
    if (index % step != 0 || index >= cell->frames.size()) return;
    const std::optional<FrameTruth> truth = truths.load(cell->frames[index].truth);
    if (!truth) throw InputError("the truth of cell " + id + " is missing; run the matrix again");
    FrameKinds found = finder.find(frame, *truth);
    if (!best_frame || tells_more(found, best)) {
      best_frame = index;
      best = std::move(found);
    }
  });
  if (!best_frame) throw InputError("the path of cell " + id + " has no frame");
  KindsPicture picture;
  picture.place = block.scene + ", " + block.path + ", frame " + std::to_string(*best_frame);
  picture.kinds = kinds_in(best);
  picture.detail_px = best.detail_px;
  visit_all([&](std::size_t index, const Frame& frame, const Changes&) {
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
