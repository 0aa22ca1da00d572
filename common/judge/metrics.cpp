// Judging a visible set.
//
// Idea: what truth shows and the set lacks is found by merging two sorted lists; only if something
// is lost are its samples looked at, each of them alone: the first kept triangle behind the lost
// one is found by a ray, and the pair is disputed or not; of a method that is held to an
// image, also the pair with the triangle that this shows there. Guarantee: every lost sample is
// either false or excused by the rules of is_disputed; none is excused in total. Cost: O(visible +
// runs); with losses, a ray and a dispute for each lost sample of C and J. Limits: as truth's.
#include "common/judge/metrics.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "common/judge/disputed.h"

namespace vislab {
namespace {

/// A sample whose triangle was left out.
struct LostSample {
  glm::dvec2 window_px;
  TriangleId triangle;
  bool disputed = false;
};

/// Says of each lost sample whether it is disputed. There is no image but for samples of C.
void classify(const Frame& frame, const VisibleSet& kept, RayCaster& caster,
              const ShownImage& shown, std::vector<LostSample>& samples) {
  std::vector<glm::dvec2> positions;
  positions.reserve(samples.size());
  for (const LostSample& sample : samples) positions.push_back(sample.window_px);
  const std::vector<RayCaster::Hit> hits = caster.cast(frame, positions, &kept);
  Disputes disputes(frame, caster.scene());
  Disputes disputes_with_image(frame, caster.scene(), shown.steps);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    LostSample& sample = samples[i];
    sample.disputed = disputes(sample.window_px, sample.triangle, hits[i].triangle);
    if (sample.disputed || shown.owners.empty()) continue;
    const auto column = static_cast<std::size_t>(sample.window_px.x);
    const auto row = static_cast<std::size_t>(sample.window_px.y);
    const TriangleId owner =
        shown.owners[row * static_cast<std::size_t>(frame.viewport.width) + column];
    const bool is_shown = owner == none_id || kept.contains(owner);
    sample.disputed = is_shown && disputes_with_image(sample.window_px, sample.triangle, owner);
  }
}

/// Samples of one object, lost and left.
struct ObjectSamples {
  bool lost_undisputed = false;
  bool survives = false;             // some sample is left
  bool survives_undisputed = false;  // and lies clear of its triangle's edges
};

/// Which objects are false, given the samples that were lost.
std::uint64_t count_false_objects(const Frame& frame, const Scene& scene, const FrameTruth& truth,
                                  const VisibleSet& kept,
                                  const std::vector<std::vector<LostSample>*>& lost) {
  std::map<ObjectId, ObjectSamples> objects;
  for (const std::vector<LostSample>* samples : lost) {
    for (const LostSample& sample : *samples) {
      ObjectSamples& object = objects[scene.object_of(sample.triangle)];
      object.lost_undisputed = object.lost_undisputed || !sample.disputed;
    }
  }
  ObjectId current = none_id;
  for (const TriangleHits& hit : truth.hits) {
    if (current == none_id ||
        hit.triangle - scene.first_triangle(current) >= scene.triangle_count(current)) {
      current = scene.object_of(hit.triangle);
    }
    const auto found = objects.find(current);
    if (found == objects.end() || !kept.contains(hit.triangle)) continue;
    found->second.survives = true;
    found->second.survives_undisputed = found->second.survives_undisputed || hit.clear_hits > 0;
  }
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    const TriangleId id = truth.ids[i];
    if (id == none_id) continue;
    const auto found = objects.find(scene.object_of(id));
    if (found == objects.end() || found->second.survives_undisputed || !kept.contains(id)) continue;
    found->second.survives = true;
    const glm::dvec2 window_px(static_cast<double>(i % truth.viewport.width) + 0.5,
                               static_cast<double>(i / truth.viewport.width) + 0.5);
    found->second.survives_undisputed =
        window_triangle(frame, scene, id).edge_distance(window_px) >= disputed_edge_px;
  }
  return std::ranges::count_if(objects, [](const auto& entry) {
    const ObjectSamples& object = entry.second;
    return object.lost_undisputed ? !object.survives_undisputed : !object.survives;
  });
}

/// Sizes of the sets; returns the visible triangles that were left out.
std::vector<TriangleId> count_sets(const Frame& frame, const Scene& scene, const FrameTruth& truth,
                                   const VisibleSet& kept, Verdict& verdict) {
  verdict.scene_objects = frame.objects.shown.size();
  for (const ObjectId object : frame.objects.shown) {
    verdict.scene_triangles += scene.triangle_count(object);
    if (kept.intersects(scene.first_triangle(object), scene.triangle_count(object))) {
      ++verdict.kept_objects;
    }
  }
  verdict.submitted_triangles = kept.triangle_count();
  const std::vector<TriangleId> visible = truth.visible();
  std::vector<TriangleId> left_out;
  auto run = kept.runs().begin();
  for (const TriangleId id : visible) {
    while (run != kept.runs().end() && run->first + run->count <= id) ++run;
    if (run == kept.runs().end() || run->first > id) left_out.push_back(id);
  }
  std::uint64_t visible_and_kept_objects = 0;
  ObjectId current = none_id;
  for (const TriangleId id : visible) {
    if (current != none_id && id - scene.first_triangle(current) < scene.triangle_count(current)) {
      continue;
    }
    current = scene.object_of(id);
    ++verdict.visible_objects;
    if (kept.intersects(scene.first_triangle(current), scene.triangle_count(current))) {
      ++visible_and_kept_objects;
    }
  }
  verdict.visible_triangles = visible.size();
  verdict.under_triangles_count = left_out.size();
  verdict.over_triangles_count = verdict.submitted_triangles - (visible.size() - left_out.size());
  verdict.under_objects_count = verdict.visible_objects - visible_and_kept_objects;
  verdict.over_objects_count = verdict.kept_objects - visible_and_kept_objects;
  return left_out;
}

/// max_false_px and wrong_px, from the false samples of C.
void find_worst(const Scene& scene, const std::vector<LostSample>& lost, Granularity granularity,
                Verdict& verdict) {
  constexpr std::size_t most_wrong_px = 64;
  std::map<std::uint32_t, std::vector<glm::dvec2>> by_culprit;
  for (const LostSample& sample : lost) {
    if (sample.disputed) continue;
    const std::uint32_t culprit =
        granularity == Granularity::object ? scene.object_of(sample.triangle) : sample.triangle;
    by_culprit[culprit].push_back(sample.window_px);
  }
  std::vector<const std::vector<glm::dvec2>*> worst;
  for (const auto& [culprit, samples] : by_culprit) worst.push_back(&samples);
  std::ranges::stable_sort(worst, std::greater{},
                           [](const auto* samples) { return samples->size(); });
  if (!worst.empty()) verdict.max_false_px = worst.front()->size();
  for (const std::vector<glm::dvec2>* samples : worst) {
    for (const glm::dvec2& p : *samples) {
      if (verdict.wrong_px.size() == most_wrong_px) return;
      verdict.wrong_px.push_back(
          {static_cast<std::uint16_t>(p.x), static_cast<std::uint16_t>(p.y)});
    }
  }
}

}  // namespace

Verdict judge_set(const Frame& frame, const FrameTruth& truth, const VisibleSet& kept,
                  Granularity granularity, RayCaster& caster, const ShownImage& shown) {
  if (!shown.owners.empty() && shown.owners.size() != truth.ids.size()) {
    throw std::logic_error("an image of another size than truth's was handed to the judge");
  }
  const Scene& scene = caster.scene();
  Verdict verdict;
  verdict.pixels = truth.ids.size();
  verdict.jittered = truth.jittered_samples;
  const std::vector<TriangleId> left_out = count_sets(frame, scene, truth, kept, verdict);
  if (left_out.empty()) return verdict;

  std::vector<LostSample> centres;
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    const TriangleId id = truth.ids[i];
    if (id == none_id || kept.contains(id)) continue;
    const glm::dvec2 window_px(static_cast<double>(i % truth.viewport.width) + 0.5,
                               static_cast<double>(i / truth.viewport.width) + 0.5);
    centres.push_back({window_px, id});
  }
  std::vector<LostSample> jittered;
  for (const RayCaster::Sample& sample : caster.jittered_hits(frame, left_out)) {
    jittered.push_back({sample.window_px, sample.triangle});
  }
  classify(frame, kept, caster, shown, centres);
  classify(frame, kept, caster, {}, jittered);

  std::vector<TriangleId> false_triangles;
  for (const LostSample& sample : centres) {
    ++(sample.disputed ? verdict.disputed_lost_px : verdict.false_px);
    if (!sample.disputed) false_triangles.push_back(sample.triangle);
  }
  for (const LostSample& sample : jittered) {
    if (sample.disputed) continue;
    ++verdict.false_jittered;
    false_triangles.push_back(sample.triangle);
  }
  std::ranges::sort(false_triangles);
  verdict.false_triangles =
      std::unique(false_triangles.begin(), false_triangles.end()) - false_triangles.begin();
  verdict.false_objects = count_false_objects(frame, scene, truth, kept, {&centres, &jittered});
  find_worst(scene, centres, granularity, verdict);
  return verdict;
}

}  // namespace vislab
