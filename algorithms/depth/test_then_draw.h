// The plainest culler with a depth buffer: objects from near to far, each tested against what was
// kept and drawn before it. The base of the negative controls, which get one step of it wrong.
//
// Guarantee: image_exact as it stands.
// Cost: O(n log n) for n candidates, and the pixels of what is drawn.
#pragma once

#include <vector>

#include "algorithms/depth/draw_order.h"
#include "algorithms/depth/frame_buffer.h"
#include "algorithms/depth/occluders.h"
#include "common/culler/culler.h"

namespace vislab::depth_culling {

class TestThenDraw : public ICuller {
 public:
  /// `scale`: pixels of the frame along a side of one of the buffer's.
  TestThenDraw(CullerInfo info, int scale, const SetupOptions& setup);
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override;
  void reset(std::uint64_t seed) override;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override;
  std::size_t bytes() const override;
  Counters counters() const override;

 protected:
  /// The buffer was cleared for a new frame.
  virtual void begin(const Frame&) {}
  /// Of a box: what it covers of the buffer.
  virtual BoxPlace place(const Aabb& box, BoxWindow& out);
  /// Is all of it hidden?
  virtual bool hides(const BoxWindow& box);
  /// Draws an object that was kept. `box` is what it covers; null where that is not known.
  virtual void draw(ObjectId object, const BoxWindow* box, const Frame& frame);

  const Scene& scene() const { return *scene_; }
  DepthRaster& raster() { return buffer_.raster(); }
  const OccluderMeshes& meshes() const { return meshes_; }
  const SetupOptions& setup() const { return setup_; }

 private:
  CullerInfo info_;
  SetupOptions setup_;
  const Scene* scene_ = nullptr;
  OccluderMeshes meshes_;
  FrameBuffer<DepthRaster> buffer_;
  DrawKeys keys_;
  ObjectOrder order_;
  std::vector<ObjectId> kept_;
  std::uint64_t tested_ = 0, hidden_ = 0;
};

}  // namespace vislab::depth_culling
