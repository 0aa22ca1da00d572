// Rays that pass through some triangles. Only the judge's own files include this header: it brings
// in Embree.
#pragma once

#include "common/judge/ray_scene.h"

namespace vislab {

/// The context of a query in which rays pass through the triangles for which `passes` is true, once
/// `embree.filter` is pass_filter<Passes>. `passes` is called from the thread that asks.
template <typename Passes>
struct PassContext {
  RTCIntersectContext embree;  // first: Embree hands out a pointer to it
  const RayScene* scene;
  Passes passes;  // bool(TriangleId) const
};

template <typename Passes>
void pass_filter(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const PassContext<Passes>*>(arguments->context);
  RTCHitN* hit = arguments->hit;
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const TriangleId triangle = context->scene->triangle_of(
        RTCHitN_geomID(hit, arguments->N, i), RTCHitN_primID(hit, arguments->N, i),
        RTCHitN_instID(hit, arguments->N, i, 0));
    if (context->passes(triangle)) arguments->valid[i] = 0;
  }
}

}  // namespace vislab
