#include "experiments/contract/offer.h"

#include <algorithm>
#include <ranges>

namespace vislab {

std::string_view to_string(OfferKind kind) {
  switch (kind) {
    case OfferKind::everything:
      return "everything";
    case OfferKind::objects:
      return "runs of objects";
    case OfferKind::ranges:
      return "ranges of triangles";
    case OfferKind::even_objects:
      return "every other object";
    case OfferKind::odd_objects:
      return "the other objects";
  }
  return "";
}

Offer::Offer(OfferKind kind, const Scene& scene, const Frame& frame) {
  std::vector<VisibleSet::Run> runs;
  if (kind == OfferKind::ranges) {
    fill_ranges(scene, frame);
    candidates_ = Candidates::of(std::span<const std::span<const TriangleRange>>(range_runs_));
    for (const TriangleRange& range : ranges_) {
      runs.push_back({scene.first_triangle(range.object) + range.first, range.count});
    }
  } else {
    fill_objects(kind, frame);
    if (kind != OfferKind::everything) {
      candidates_ = Candidates::of(std::span<const std::span<const ObjectId>>(object_runs_));
    }
    for (const ObjectId object : objects_) {
      runs.push_back({scene.first_triangle(object), scene.triangle_count(object)});
    }
  }
  set_ = VisibleSet(std::move(runs));
}

void Offer::fill_objects(OfferKind kind, const Frame& frame) {
  const std::span<const ObjectId> shown = frame.objects.shown;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const bool offered = kind == OfferKind::everything ||
                         (kind == OfferKind::objects && i % 5 != 4) ||
                         (kind == OfferKind::even_objects && i % 2 == 0) ||
                         (kind == OfferKind::odd_objects && i % 2 == 1);
    if (offered) objects_.push_back(shown[i]);
  }
  if (kind == OfferKind::objects) std::ranges::reverse(objects_);
  const std::span<const ObjectId> all(objects_);
  const std::size_t third = all.size() / 3;
  object_runs_ = {all.first(third), all.subspan(third, 0), all.subspan(third)};
}

void Offer::fill_ranges(const Scene& scene, const Frame& frame) {
  constexpr std::uint32_t piece = 5;
  for (const std::uint32_t turn : {0U, 1U}) {
    for (const ObjectId object : frame.objects.shown) {
      if (object % 4 == 3) continue;
      const std::uint32_t count = scene.triangle_count(object);
      for (std::uint32_t first = turn * piece; first < count; first += 3 * piece) {
        ranges_.push_back({object, first, std::min(piece, count - first)});
      }
    }
  }
  const std::span<const TriangleRange> all(ranges_);
  range_runs_ = {all.first(all.size() / 2), all.subspan(all.size() / 2)};
}

VisibleSet without(const VisibleSet& a, const VisibleSet& b) {
  std::vector<VisibleSet::Run> rest;
  auto taken = b.runs().begin();
  for (VisibleSet::Run run : a.runs()) {
    while (taken != b.runs().end() && taken->first + taken->count <= run.first) ++taken;
    for (auto it = taken; it != b.runs().end() && it->first < run.first + run.count; ++it) {
      if (it->first > run.first) rest.push_back({run.first, it->first - run.first});
      const TriangleId end = std::min(it->first + it->count, run.first + run.count);
      run.count -= end - run.first;
      run.first = end;
    }
    if (run.count > 0) rest.push_back(run);
  }
  return VisibleSet(std::move(rest));
}

VisibleSet united(const VisibleSet& a, const VisibleSet& b) {
  std::vector<VisibleSet::Run> all = a.runs();
  all.insert(all.end(), b.runs().begin(), b.runs().end());
  return VisibleSet(std::move(all));
}

}  // namespace vislab
