#include "algorithms/depth/tree_culler.h"

namespace vislab::depth_culling {

CullerInfo tree_culler_info(const char* name, const char* hierarchy) {
  constexpr auto build = ParameterSpec::Stage::build;
  constexpr auto query = ParameterSpec::Stage::query;
  CullerInfo info;
  info.name = name;
  info.family = "depth";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.parameters = {
      ParameterSpec::choice("hierarchy", hierarchy, {"octree", "bvh"}, build,
                            "what is walked: an octree with each object at one node, or a "
                            "bounding-volume hierarchy, which follows moving objects at less cost"),
      ParameterSpec::integer("leaf_size", 8, 1, 1024, "objects", build,
                             "nodes with so many objects are not divided; greater tests more "
                             "objects one by one, smaller more nodes"),
      scale_parameter(),
      draw_order_parameter(),
      ParameterSpec::boolean("silhouettes", true, query,
                             "objects whose rectangle is visible are asked again by the silhouette "
                             "and the depths of their box, pixel by pixel"),
      ParameterSpec::boolean("sleep", true, query,
                             "whether it stops for a while when hiding does not pay; without, "
                             "frames without occlusion cost what they cost")};
  for (ParameterSpec& spec : OccluderBudget::parameters()) {
    info.parameters.push_back(std::move(spec));
  }
  return info;
}

LooseOctree::Limits octree_limits(const ParameterValues& values) {
  LooseOctree::Limits limits;
  limits.depth = 16;
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return limits;
}

Bvh::Limits bvh_limits(const ParameterValues& values) {
  Bvh::Limits limits;
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return limits;
}

}  // namespace vislab::depth_culling
