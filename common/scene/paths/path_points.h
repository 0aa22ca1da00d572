// What ways and lenses are fitted to, and points of a path's description.
#pragma once

#include <string>
#include <vector>

#include "common/scene/scene.h"
#include "common/scene/settings.h"

namespace vislab {

/// The scene's box, or one of 1 m radius around a scene that is a single point: ways and lenses are
/// fitted to it.
Aabb framed(const Scene& scene);

/// Points of a description: in the world, or, if the path's key `relative` is set, from the centre
/// of the scene's box in units of the radius of its circumscribed sphere.
class PathPoints {
 public:
  PathPoints(const Settings& path, const Scene& scene);

  /// A point given as a key of the path or of one of its tables. Throws InputError.
  glm::dvec3 one(const Settings& table, const std::string& key) const;
  /// A list of at least so many points. Throws InputError.
  std::vector<glm::dvec3> list(const Settings& table, const std::string& key,
                               std::size_t at_least) const;

 private:
  glm::dvec3 center_{0.0};
  double unit_ = 1.0;
};

}  // namespace vislab
