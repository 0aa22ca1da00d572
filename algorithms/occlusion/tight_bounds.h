// Many small boxes in place of a big one, so that what is hidden is found hidden more often.
//
// Idea: the box of a long, bent or slanting thing shows where the thing does not. Each mesh's
//   triangles are divided in two, again and again, where the two boxes have the least surface; the
//   part whose division takes away most surface goes first. What is asked about is the union of the
//   parts' boxes, as long as their surfaces together are at most sigma times the surface of the one
//   box: the surface is what a query costs to draw. Nodes of a hierarchy are divided the same way,
//   into their children, their objects and the objects' parts.
// Guarantee: conservative: every triangle lies wholly in one of the boxes, in exact arithmetic.
//   Boxes of turned objects grow, as boxes of boxes do; they are cut to the object's own box, and
//   if they are then too large for the rule, the one box stands for them. The rule holds for what
//   is given out, always.
// Cost: build O(t log t) a mesh of t triangles; a node or object costs about 0.1 us a box. Boxes of
//   things that do not move may be kept by the caller.
// Limits: boxes lie along the axes of the world; a plane at 45 degrees gains only by many boxes. A
//   pixel that several of the boxes cover counts for each: thresholds above 0 pixels mean less.
// Sources: Zachmann, Computer-Graphik 2, SS 2012, slides 69-70 (sigma = 1.4); Mattausch, Bittner,
//   Wimmer 2008, CHC++, section 5.2.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/frame.h"
#include "common/spatial/spatial_structure.h"

namespace vislab::occlusion_culling {

class TightBounds {
 public:
  struct Limits {
    double sigma = 1.4;            // at least 1
    std::uint32_t max_boxes = 16;  // that are given out for one object or node; at least 1
  };

  /// Divides the meshes of the scene, which outlives this.
  void build(const Scene& scene, const Limits& limits);

  /// Appends the boxes (world) of an object where it is now: its own box alone if smaller ones gain
  /// nothing. An object whose box is not valid gives that box. Returns how many.
  std::uint32_t append(ObjectId object, const ObjectsView& objects, std::vector<Aabb>& out) const;

  /// Appends boxes (world) that hold all objects at and below a node of a structure over the
  /// objects' present boxes. Returns how many; none for a node without objects. No allocation once
  /// `out` is long enough.
  std::uint32_t append(const SpatialStructure& tree, SpatialStructure::NodeIndex node,
                       const ObjectsView& objects, std::vector<Aabb>& out) const;

  std::size_t bytes() const;

 private:
  /// A part of a mesh: its box in the mesh's frame, and its two halves.
  struct Part {
    Aabb box;
    std::uint32_t first_half = 0;  // in parts_; the other one follows it; 0: not divided
  };
  struct Piece;

  const Scene* scene_ = nullptr;
  Limits limits_;
  std::vector<Part> parts_;                // [0] is unused
  std::vector<std::uint32_t> whole_mesh_;  // in parts_, by mesh
};

}  // namespace vislab::occlusion_culling
