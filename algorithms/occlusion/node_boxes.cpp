#include "algorithms/occlusion/node_boxes.h"

#include <algorithm>

#include "common/geometry/frustum.h"
#include "common/render/query_bounds.h"

namespace vislab::occlusion_culling {
namespace {

constexpr std::uint64_t box_triangles = 12;
/// What is drawn has to have so many times the triangles of the boxes that are asked about.
constexpr std::uint64_t worth_boxes = 16;

}  // namespace

void NodeBoxes::build(const Scene& scene, const std::optional<TightBounds::Limits>& limits) {
  tight_ = limits.has_value();
  if (!tight_) return;
  bounds_.build(scene, *limits);
}

std::uint32_t NodeBoxes::append(const Frame& frame, const QueryHierarchy& hierarchy,
                                QueryHierarchy::NodeIndex node, std::vector<Aabb>& out) const {
  const auto askable = [&](const Aabb& box) {
    return box.valid() && !touches_near_region(frame.camera, box);
  };
  const Aabb whole = enlarged_for_query(frame.camera, frame.viewport, hierarchy.node(node).box);
  if (!askable(whole)) return 0;
  const std::size_t first = out.size();
  const std::uint64_t worth = hierarchy.work(node) / (box_triangles * worth_boxes);
  if (!tight_ || !hierarchy.is_unit(node) || worth < 2) {
    out.push_back(whole);
    return 1;
  }
  const auto most =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(worth, TightBounds::most_boxes));
  bounds_.append(hierarchy.structure(), node, frame.objects, most, out);
  for (std::size_t i = first; i < out.size(); ++i) {
    out[i] = enlarged_for_query(frame.camera, frame.viewport, out[i]);
    if (!askable(out[i])) {
      out.resize(first);
      return 0;
    }
  }
  return static_cast<std::uint32_t>(out.size() - first);
}

}  // namespace vislab::occlusion_culling
