#include "algorithms/depth/test_then_draw.h"

#include <array>

namespace vislab::depth_culling {

TestThenDraw::TestThenDraw(CullerInfo info, int scale, const SetupOptions& setup)
    : info_(std::move(info)),
      setup_(setup),
      buffer_(scale, RasterOptions{setup, false, 1}),
      keys_(DrawOrder::near_first) {}

void TestThenDraw::build(const Scene& scene, const BuildContext&) {
  scene_ = &scene;
  meshes_.build(scene);
  order_.reserve(scene.object_count());
  kept_.reserve(scene.object_count());
}

void TestThenDraw::reset(std::uint64_t seed) {
  buffer_.forget();
  keys_.reset(seed);
}

void TestThenDraw::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  if (buffer_.start(frame)) begin(frame);
  keys_.start(frame.camera);
  order_.clear();
  kept_.clear();
  for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
    for (const ObjectId object : run) {
      order_.add(keys_.of(frame.objects.bounds[object], object), object);
    }
  });
  order_.sort();
  tested_ += order_.places().size();
  for (const ObjectOrder::Place& next : order_.places()) {
    BoxWindow box;
    const BoxPlace where = place(frame.objects.bounds[next.object], box);
    if (where == BoxPlace::outside || (where == BoxPlace::inside && hides(box))) {
      ++hidden_;
      continue;
    }
    kept_.push_back(next.object);
    draw(next.object, where == BoxPlace::inside ? &box : nullptr, frame);
  }
  out.objects(kept_);
}

BoxPlace TestThenDraw::place(const Aabb& box, BoxWindow& out) {
  return project_box(raster().window(), box, setup_.coverage, out);
}

bool TestThenDraw::hides(const BoxWindow& box) { return raster().hides(box); }

void TestThenDraw::draw(ObjectId object, const BoxWindow*, const Frame& frame) {
  raster().draw(std::array{meshes_.of(object, frame)});
}

std::size_t TestThenDraw::bytes() const {
  return meshes_.bytes() + buffer_.bytes() + order_.bytes() + kept_.capacity() * sizeof(ObjectId);
}

Counters TestThenDraw::counters() const {
  return {{"objects_tested", tested_}, {"objects_hidden", hidden_}};
}

}  // namespace vislab::depth_culling
