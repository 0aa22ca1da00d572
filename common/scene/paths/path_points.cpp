#include "common/scene/paths/path_points.h"

#include <numbers>

#include "common/scene/error.h"

namespace vislab {

Aabb framed(const Scene& scene) {
  const Aabb& box = scene.bounds();
  if (glm::length(box.half_size()) >= 0.5 * min_scene_extent_m) return box;
  const glm::vec3 center(box.center());
  const glm::vec3 reach(static_cast<float>(std::numbers::inv_sqrt3));
  return {center - reach, center + reach};
}

PathPoints::PathPoints(const Settings& path, const Scene& scene) {
  if (!path.flag("relative", false)) return;
  const Aabb box = framed(scene);
  center_ = box.center();
  unit_ = glm::length(box.half_size());
}

glm::dvec3 PathPoints::one(const Settings& table, const std::string& key) const {
  return center_ + table.point(key) * unit_;
}

std::vector<glm::dvec3> PathPoints::list(const Settings& table, const std::string& key,
                                         std::size_t at_least) const {
  std::vector<glm::dvec3> points = table.points(key);
  if (points.size() < at_least) {
    throw InputError(table.where() + ": `" + key + "` needs at least " + std::to_string(at_least) +
                     " points");
  }
  for (glm::dvec3& p : points) p = center_ + p * unit_;
  return points;
}

}  // namespace vislab
