// backface.cluster: leaves out clusters of triangles that all face away, one test a cluster.
//
// Idea: a cluster keeps the least and greatest coordinates n, m of its normals and the least d of
//   n_i.(p_i - c). The eye sees all its triangles from behind if if(e - c; n, m).(e - c) <= d:
//   about the work of one plane test for all of them. Clusters are made of triangles whose planes
//   lie near each other (triangle_clusters.h); they need not be connected.
// Guarantee: conservative. Only solid meshes are tested (see backface.polygon); bounds are rounded
//   outward, and the float test has a margin above its rounding. A triangle seen exactly edge-on is
//   kept, and so are triangles without area.
// Cost: O(clusters), 16 at a time, and O(marked runs of triangles). Memory: 44 bytes a cluster (40
//   of them its bound) and 4 a run of triangles. Build: O(n log n).
// Limits: keeps clusters that are partly seen from behind, so its share falls with coarse meshes
//   and large clusters; next to the mesh, where the eye sees a cluster from many sides at once.
// Sources: Johannsen and Carter, "Clustered Backface Culling", 1998 (28 bytes, 40 with c); Zachmann
//   slides 20-25. The slides take the middle and the corners of the box for c and keep what makes d
//   greatest; with clusters as they are made here all three choices of `origin` cull the same to a
//   tenth of a percent while the mesh lies about its own origin.

#include "algorithms/backface/cluster_culler.h"
#include "algorithms/backface/cluster_parameters.h"
#include "algorithms/backface/facing_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.cluster";
  info.family = "backface";
  info.summary =
      "Leaves out clusters of triangles that all face away from the eye, by one test a cluster "
      "with "
      "the least and greatest coordinates of its normals.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.parameters = cluster_parameters(flat_cluster_size);
  info.cost =
      "O(clusters of shown objects) tests, 16 at a time, and O(runs of culled triangles); 40 bytes "
      "a cluster for its bound, and 4 for it and for each of its runs of triangles";
  info.limits =
      "Keeps clusters that are partly seen from behind: on coarse meshes, with large clusters and "
      "next to the mesh that is much. Keeps meshes that are open or cross themselves, and objects "
      "around the eye, whole. With costs=measured answers depend on the machine.";
  info.sources = {"Johannsen and Carter 1998, Clustered Backface Culling",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 20-25, 27-29"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry backface_cluster() {
  return {describe(), [](const ParameterValues& values) {
            return make_cluster_culler(describe(), culls_open(values),
                                       [values](const BuildContext& context) {
                                         return cluster_settings(values, context);
                                       });
          }};
}

}  // namespace cullers
}  // namespace vislab
