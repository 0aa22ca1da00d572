#include "algorithms/detail/object_sizes.h"

#include <algorithm>

#include "common/geometry/bounding_spheres.h"
#include "common/scene/used_positions.h"

namespace vislab::detail_culling {
namespace {

/// A sphere in the middle of the box that does not reach beyond its nearest side.
Sphere inscribed(const Aabb& box) {
  const glm::dvec3 half = box.half_size();
  return {glm::vec3(box.center()), static_cast<float>(std::min({half.x, half.y, half.z}))};
}

}  // namespace

bool ObjectSizes::has_spheres() const {
  return measure_ == SizeMeasure::sphere || measure_ == SizeMeasure::printed ||
         measure_ == SizeMeasure::near_plane_units;
}

void ObjectSizes::build(const Scene& scene) {
  scene_ = &scene;
  mesh_spheres_.clear();
  if (has_spheres()) {
    for (const Mesh& mesh : scene.meshes)
      mesh_spheres_.push_back(ritter_sphere(used_positions(mesh)));
    spheres_.resize(scene.object_count());
  }
  moved_ = true;
  reset();
}

void ObjectSizes::reset() {
  if (!has_spheres() || !moved_) return;
  for (ObjectId object = 0; object < spheres_.size(); ++object) {
    const Object& placed = scene_->objects[object];
    spheres_[object] = transformed(mesh_spheres_[placed.mesh], placed.transform);
  }
  moved_ = false;
}

void ObjectSizes::update(const Frame& frame, const Changes& changes) {
  if (!has_spheres()) return;
  for (const ObjectId object : changes.moved) {
    spheres_[object] =
        transformed(mesh_spheres_[scene_->objects[object].mesh], frame.objects.transforms[object]);
    moved_ = true;
  }
}

double ObjectSizes::of(ObjectId object, const Frame& frame, const ProjectedArea& areas) const {
  switch (measure_) {
    case SizeMeasure::sphere:
      return areas.of(spheres_[object]);
    case SizeMeasure::box:
      return areas.of(frame.objects.bounds[object]);
    case SizeMeasure::printed:
      return areas.printed_m2(spheres_[object]) * areas.pixels_of_near_m2();
    case SizeMeasure::near_plane_units:
      return areas.printed_m2(spheres_[object]);
    case SizeMeasure::inner_sphere:
      return areas.of(inscribed(frame.objects.bounds[object]));
  }
  return 0.0;
}

std::size_t ObjectSizes::bytes() const {
  return (mesh_spheres_.capacity() + spheres_.capacity()) * sizeof(Sphere);
}

}  // namespace vislab::detail_culling
