// Base of the cullers that test one stored plane a triangle and differ in where they take the eye
// to be.
#pragma once

#include <optional>

#include "algorithms/backface/facing_culler.h"
#include "algorithms/backface/plane_kernel.h"

namespace vislab::backface_culling {

class PlaneCuller : public FacingCuller {
 public:
  using FacingCuller::FacingCuller;
  Counters counters() const final { return {{"triangles_tested", triangles_tested_}}; }

 protected:
  /// The eye of an object, once for all of its ranges. Nothing: the object is kept whole.
  virtual std::optional<PlaneTest> find_eye(const ObjectView& view, const MeshFrame& frame) = 0;

  void clear() final;
  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame,
                const BuildContext& context) final;
  std::span<const std::uint64_t> mark_mesh(const ObjectView& view) final;
  void mark_range(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                  std::uint64_t* back) final;
  std::size_t mesh_bytes() const final;

 private:
  std::vector<std::size_t> place_;  // by mesh, in planes_
  std::vector<PlaneArrays> planes_;
  std::optional<PlaneTest> test_;  // of the object under test
  std::uint64_t triangles_tested_ = 0;
};

}  // namespace vislab::backface_culling
