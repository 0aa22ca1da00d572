// A scene and a camera for the cases, and a culler that answers once.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/culler/culler.h"
#include "common/culler/registry.h"

namespace vislab {

/// A culler, built for a scene, asked about everything.
class DetailSide {
 public:
  /// The scene outlives it.
  DetailSide(const std::string& spec, const Scene& scene);

  void cull(const Frame& frame);
  /// What the last cull() kept.
  const std::vector<ObjectId>& kept() const { return sink_.kept; }

 private:
  struct Sink : DrawSink {
    std::vector<ObjectId> kept;

    void everything() override;
    void objects(std::span<const ObjectId> ids) override;
    void ranges(std::span<const TriangleRange> ranges) override;
    void flush() override {}
  };

  Registry registry_;
  std::unique_ptr<ICuller> culler_;
  Sink sink_;
};

/// Convex things of all sizes around the origin, as tight as can be in what a culler measures.
enum class Shape {
  sphere,  // of 192 triangles: in spheres
  box      // of any shape, along the axes: in boxes
};
Scene all_around(Shape shape);

/// From the origin, 120 degrees high and wide.
Camera wide_camera();

}  // namespace vislab
