#include "common/judge/truth.h"

#include <algorithm>

#include "common/scene/content_hash.h"

namespace vislab {
namespace {

/// To be raised when the meaning of truth changes: samples, rays, or what is counted.
constexpr std::uint32_t truth_version = 1;

}  // namespace

std::vector<TriangleId> FrameTruth::visible() const {
  std::vector<TriangleId> visible;
  visible.reserve(hits.size());
  for (const TriangleHits& hit : hits) visible.push_back(hit.triangle);
  // Few triangles are hit by a pixel centre only.
  std::vector<TriangleId> more;
  TriangleId last = none_id;
  for (const TriangleId id : ids) {
    if (id == last || id == none_id) continue;
    last = id;
    if (!std::ranges::binary_search(visible, id)) more.push_back(id);
  }
  std::ranges::sort(more);
  more.erase(std::unique(more.begin(), more.end()), more.end());
  std::vector<TriangleId> all(visible.size() + more.size());
  std::ranges::merge(visible, more, all.begin());
  return all;
}

std::string truth_key(const Frame& frame, const Scene& scene, const TruthSettings& settings) {
  ContentHash hash;
  hash.add(truth_version);
  hash.add(RayCaster::engine());
  hash.add(scene.content_hash());
  hash.add(frame.viewport.width);
  hash.add(frame.viewport.height);
  hash.add(settings.jitter_per_pixel);
  hash.add(settings.seed);
  const auto& [eye, right, up, back] = frame.camera.pose;
  for (const glm::dvec3& v : {eye, right, up, back}) hash.add(v);
  const Lens& lens = frame.camera.lens;
  hash.add(static_cast<int>(lens.projection));
  for (const double number :
       {lens.left, lens.right, lens.bottom, lens.top, lens.near_m, lens.far_m}) {
    hash.add(number);
  }
  for (const glm::dmat4x3& transform : frame.objects.transforms) hash.add(transform);
  hash.add_list(frame.objects.shown);
  return hash.hex();
}

}  // namespace vislab
