#include "common/scene/path.h"

#include "common/scene/content_hash.h"

namespace vislab {

std::string Path::content_hash() const {
  ContentHash hash;
  hash.add(frames.size());
  for (const PathFrame& frame : frames) {
    const Pose& pose = frame.camera.pose;
    for (const glm::dvec3& v : {pose.eye, pose.right, pose.up, pose.back}) hash.add(v);
    const Lens& lens = frame.camera.lens;
    hash.add(static_cast<int>(lens.projection));
    for (const double value :
         {lens.left, lens.right, lens.bottom, lens.top, lens.near_m, lens.far_m}) {
      hash.add(value);
    }
    const Changes& changes = frame.changes;
    hash.add_list(std::span<const ObjectId>(changes.moved));
    for (const glm::dmat4x3& transform : changes.transforms) hash.add(transform);
    hash.add_list(std::span<const ObjectId>(changes.shown));
    hash.add_list(std::span<const ObjectId>(changes.hidden));
  }
  return hash.hex();
}

}  // namespace vislab
