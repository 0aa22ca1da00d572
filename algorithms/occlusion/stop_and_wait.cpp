// occlusion.stop_and_wait: asks the device for each object, front to back, whether its box would
// show, and waits for every answer.
//
// Idea: near objects hide far ones. The candidates are taken in the order of the distance of their
//   boxes' nearest points; before each question everything kept so far is drawn; an object whose
//   box adds no sample to the image is hidden by what is drawn, or outside the image.
// Guarantee: image_exact (threshold_px = 0): the box that is asked about is grown until it covers
//   every pixel and every depth that the object's own triangles can get on the device, and a box
//   that may be cut by the near plane is drawn unasked. threshold_px > 0 leaves out objects whose
//   boxes show no more than that many pixels: approximate.
// Cost: O(n log n) to sort, one query and one wait a candidate: the device idles while the
//   processor waits, and the processor while the device draws.
// Limits: slow, as a yardstick for methods that hide the waiting; an object outside the image costs
//   a query too, so chain it behind a frustum culler; a box that shows although its object does not
//   is kept; objects that are equally far or interlocked may not hide each other.
// Sources: Zachmann slides 47-60 (naive draw-and-wait, order by distance, threshold culling);
//   Bittner et al. 2004 (hierarchical stop-and-wait).

#include <algorithm>

#include "algorithms/occlusion/object_list.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace occlusion_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "occlusion.stop_and_wait";
  info.family = "occlusion";
  info.summary =
      "Front to back: asks the device how many samples an object's box would add to what is drawn "
      "so far, waits for the answer, and draws the object if there are any.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {threshold_parameter()};
  info.cost = "O(n log n) for n candidates, and one query with its wait for each";
  info.limits =
      "Waits for every answer, so it pays only where much is hidden behind little; objects outside "
      "the image cost a query each: put a frustum culler before it. A box may show although its "
      "object does not. With threshold_px > 0 it is approximate.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 47-60",
                  "Bittner, Wimmer, Piringer, Purgathofer 2004, Coherent Hierarchical Culling"};
  return info;
}

class StopAndWait : public ICuller {
 public:
  explicit StopAndWait(std::uint64_t threshold_px) : threshold_px_(threshold_px) {
    info_ = describe();
    if (threshold_px_ > 0) info_.guarantee = Guarantee::approximate;
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    device_ = &required_device(info_.name, context);
    order_.reserve(scene.object_count());
    kept_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    view_.start(frame);
    order_.clear();
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        order_.push_back({nearness(frame.camera, frame.objects.bounds[object]), object});
      }
    });
    std::ranges::sort(order_);

    kept_.clear();
    for (const Place& place : order_) {
      if (shows(frame.objects.bounds[place.object], out)) kept_.add(place.object);
    }
    kept_.emit(out);
  }

  std::size_t bytes() const override { return order_.capacity() * sizeof(Place) + kept_.bytes(); }
  Counters counters() const override { return {{"queries", queries_}, {"occluded", occluded_}}; }

 private:
  struct Place {
    double nearness = 0.0;
    ObjectId object = 0;
    auto operator<=>(const Place&) const = default;
  };

  bool shows(const Aabb& box, DrawSink& out) {
    Aabb asked;
    if (view_.place_inside(box, asked) == BoxPlace::unaskable) return true;
    kept_.draw(out);
    const QueryId query = device_->query({&asked, 1});
    device_->flush();
    ++queries_;
    const bool visible = device_->samples(query) > threshold_px_;
    if (!visible) ++occluded_;
    return visible;
  }

  std::uint64_t threshold_px_;
  CullerInfo info_;
  RenderDevice* device_ = nullptr;
  BoxView view_;
  std::vector<Place> order_;
  KeptObjects kept_;
  std::uint64_t queries_ = 0;
  std::uint64_t occluded_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry occlusion_stop_and_wait() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<StopAndWait>(
                static_cast<std::uint64_t>(values.integer("threshold_px")));
          }};
}

}  // namespace cullers
}  // namespace vislab
