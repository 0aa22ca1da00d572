#include "experiments/show/frame_picture.h"

#include <algorithm>

#include "common/judge/disputed.h"
#include "common/render/picture.h"
#include "common/scene/error.h"
#include "experiments/context/sources.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

TriangleClass class_of(bool kept, bool visible) {
  if (kept) return visible ? TriangleClass::kept_visible : TriangleClass::kept_invisible;
  return visible ? TriangleClass::culled_wrongly : TriangleClass::culled_rightly;
}

/// Of a frame without errors: much that is culled beside much that is seen.
double shows(const Verdict& verdict) {
  return static_cast<double>(verdict.visible_triangles) *
         static_cast<double>(verdict.scene_triangles - verdict.submitted_triangles);
}

/// Marks the triangles of a set.
std::vector<std::uint8_t> flags_of(const VisibleSet& set, std::size_t triangles) {
  std::vector<std::uint8_t> flags(triangles, 0);
  for (const VisibleSet::Run& run : set.runs()) {
    std::fill_n(flags.begin() + run.first, run.count, std::uint8_t{1});
  }
  return flags;
}

/// The pixels that the verdict finds wrong, where it names all of them; else those that were lost
/// away from the edges of what was lost: what is seen there instead would have to be traced again.
std::vector<glm::ivec2> wrong_pixels(const Scene& scene, const Frame& frame,
                                     const FrameTruth& truth, const VisibleSet& kept,
                                     const Verdict& verdict) {
  std::vector<glm::ivec2> pixels;
  if (verdict.wrong_px.size() == verdict.false_px) {
    for (const auto& [x, y] : verdict.wrong_px) pixels.emplace_back(x, y);
    return pixels;
  }
  Disputes disputes(frame, scene);
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    const TriangleId lost = truth.ids[i];
    if (lost == none_id || kept.contains(lost)) continue;
    const glm::ivec2 pixel(static_cast<int>(i) % truth.viewport.width,
                           static_cast<int>(i) / truth.viewport.width);
    if (!disputes(glm::dvec2(pixel) + 0.5, lost, none_id)) pixels.push_back(pixel);
  }
  return pixels;
}

}  // namespace

void write_frame_picture(const Scene& scene, const Frame& frame, const FrameTruth& truth,
                         const VisibleSet& kept, const Verdict& verdict, Granularity granularity,
                         const std::string& title, const std::filesystem::path& file) {
  const std::vector<std::uint8_t> is_kept = flags_of(kept, scene.triangle_count());
  std::vector<std::uint8_t> is_visible(scene.triangle_count(), 0);
  for (const TriangleId triangle : truth.visible()) is_visible[triangle] = 1;

  std::vector<TriangleClass> classes(scene.triangle_count(), TriangleClass::culled_rightly);
  PictureInput input;
  for (const ObjectId object : frame.objects.shown) {
    const TriangleId first = scene.first_triangle(object);
    const TriangleId end = first + scene.triangle_count(object);
    if (granularity == Granularity::object) {
      const auto any = [&](const std::vector<std::uint8_t>& flags) {
        return std::find(flags.begin() + first, flags.begin() + end, 1) != flags.begin() + end;
      };
      const TriangleClass whole = class_of(any(is_kept), any(is_visible));
      std::fill(classes.begin() + first, classes.begin() + end, whole);
      ++input.counts[static_cast<std::size_t>(whole)];
    } else {
      for (TriangleId triangle = first; triangle < end; ++triangle) {
        classes[triangle] = class_of(is_kept[triangle] != 0, is_visible[triangle] != 0);
        ++input.counts[static_cast<std::size_t>(classes[triangle])];
      }
    }
  }
  input.scene = &scene;
  input.frame = &frame;
  input.classes = classes;
  input.title = title;
  input.counted = granularity == Granularity::object ? "objects" : "triangles";
  const std::uint64_t lost = input.counts[static_cast<std::size_t>(TriangleClass::culled_wrongly)];
  const std::uint64_t wrong =
      granularity == Granularity::object ? verdict.false_objects : verdict.false_triangles;
  input.excused = lost - std::min(lost, wrong);
  input.wrong_pixels = wrong_pixels(scene, frame, truth, kept, verdict);
  write_png(file, render_picture(input));
}

StoredPictures::StoredPictures(std::filesystem::path results, StoredScenes& scenes)
    : results_(std::move(results)), scenes_(&scenes) {}

std::string StoredPictures::write(const BlockSummary& block, const CellSummary& cell,
                                  const std::filesystem::path& file) {
  const ResultStore store = ResultStore::open(results_);
  const std::optional<ResultCell> stored = store.load_cell(cell.id);
  if (!stored) throw InputError("cell " + cell.id + " is missing");
  const std::optional<CellVerdicts> verdicts = store.load_verdicts(*stored, judge_source_hash());
  if (!verdicts) throw InputError("cell " + cell.id + " has not been judged");

  const StoredScene loaded = scenes_->of(block, cell.id);
  std::size_t best = 0;
  for (std::size_t i = 1; i < verdicts->frames.size(); ++i) {
    const Verdict& a = verdicts->frames[i];
    const Verdict& b = verdicts->frames[best];
    if (a.false_px != b.false_px ? a.false_px > b.false_px : shows(a) > shows(b)) {
      best = i;
    }
  }
  const std::optional<FrameTruth> truth =
      TruthStore(store.truth_folder()).load(stored->frames[best].truth);
  if (!truth)
    throw InputError("the truth of cell " + cell.id + " is missing; run the matrix again");

  const std::string where = block.scene + ", " + cell.culler + ", frame " + std::to_string(best);
  SceneState state(loaded.scene);
  for_each_frame(loaded.path, state, block.viewport,
                 [&](std::size_t index, const Frame& frame, const Changes&) {
                   if (index != best) return;
                   write_frame_picture(loaded.scene, frame, *truth,
                                       store.load_set(stored->frames[best].set),
                                       verdicts->frames[best], cell.granularity, where, file);
                 });
  const Verdict& shown = verdicts->frames[best];
  if (shown.false_px > 0 || shown.under_triangles_count == 0) return where;
  return where + ": no pixel is lost; what is culled though visible is seen between the pixels' " +
         "centres, or where the judge excuses the pixel";
}

}  // namespace vislab
