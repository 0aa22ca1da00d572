// The acceleration structure that truth is traced in, and how it follows a scene's changes. Only
// the judge's own files include this header: it brings in Embree.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <string>
#include <vector>

#include "common/scene/frame.h"

namespace vislab {

/// Version and instruction set of the ray tracer on this machine, "embree 3.13.5 avx2 robust". The
/// instruction set is held at AVX2 where there is more, because hits at edges differ between
/// instruction sets (Embree issue 423). Throws InputError on a processor without AVX.
std::string ray_engine();

/// How a RayScene traces. Truth has the defaults.
struct RayEngine {
  bool robust = true;
  std::string instruction_set;  // "sse2", "avx" or "avx2"; empty: ray_engine()'s
};

/// An Embree scene of the objects that are shown, both sides of every triangle.
///
/// Vertices are float world positions, computed in double and rounded after Scene::origin() was
/// subtracted. Objects that never change are merged into one geometry; an object that moves or is
/// hidden gets a geometry of its own, and after a few such departures all objects do. Scenes whose
/// flattened triangles would not fit (more than `flat_triangle_limit`) are made of instances of
/// their meshes instead; their rays are transformed to the meshes' frames in float.
///
/// The tree is built by one thread, because among triangles at equal depth the order in the tree
/// decides, and it must not depend on the number of threads.
class RayScene {
 public:
  static constexpr std::size_t flat_triangle_limit = 8'000'000;

  /// Does nothing yet; the scene outlives this. Throws InputError for an instruction set that the
  /// processor does not have.
  explicit RayScene(const Scene& scene, RayEngine engine = {});
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// Makes the structure that of these objects. The first call builds, O(n log n); later ones cost
  /// O(objects) for the comparison and, if anything changed, the rebuilding of what did.
  void follow(const ObjectsView& objects);

  RTCScene handle() const { return top_; }

  /// Which triangle of the scene a hit is. `instance` is RTCHit::instID[0].
  TriangleId triangle_of(unsigned geometry, unsigned primitive, unsigned instance) const {
    if (instanced_) return first_triangle_[instance] + primitive;
    if (geometry != merged_geometry) return first_triangle_[geometry - 1] + primitive;
    return merged_ids_.empty() ? primitive : merged_ids_[primitive];
  }

  /// World vertices of a triangle as it is now, double.
  std::array<glm::dvec3, 3> triangle(TriangleId id) const;

 private:
  static constexpr unsigned merged_geometry = 0;  // geometry 1 + n is object n

  void build();
  void build_instances();
  void build_merged();
  void set_object_vertices(ObjectId object);
  void commit();

  const Scene* scene_;
  RayEngine engine_;
  int scene_flags_;  // of every Embree scene
  RTCDevice device_ = nullptr;
  RTCScene top_ = nullptr;
  bool instanced_ = false;
  int departures_ = 0;  // how often the merged geometry was built again

  std::vector<glm::dmat4x3> transforms_;    // as built
  std::vector<std::uint8_t> shown_;         // as built
  std::vector<std::uint8_t> shown_wanted_;  // scratch of follow()
  std::vector<std::uint8_t> apart_;         // has a geometry of its own (flat scenes)
  std::vector<TriangleId> first_triangle_;  // by object
  std::vector<TriangleId> merged_ids_;      // by merged triangle; empty if all are merged
  std::vector<RTCGeometry> geometries_;     // by object: its instance or own geometry, or null
  std::vector<RTCScene> mesh_scenes_;       // by mesh (instanced scenes)
};

}  // namespace vislab
