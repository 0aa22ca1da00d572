// occlusion.chc_flat: Coherent Hierarchical Culling without its hierarchy, as the lecture lists it.
//
// Idea: while an answer is on its way, go on. Objects come from near to far. Each is asked about
//   and joins the query queue; what was visible in the last frame is drawn at once, without regard
//   to the answer. After every object, answers that have arrived are taken from the queue's front,
//   and what shows and was not drawn is drawn. Only when the list is done are answers waited for.
// Guarantee: image_exact (threshold_px = 0): left out is only what a question of this frame about
//   its enlarged box found hidden behind what was drawn before, or what is surely outside of the
//   view. Boxes that the near plane may cut are drawn unasked. threshold_px > 0: approximate.
// Cost: O(n log n) to sort; a question for each object in the view. Drawing and asking alternate:
//   up to two changes of state an object. A device gets to work on what is handed over to it, so
//   every flush_every questions are.
// Limits: what is drawn depends on when answers arrive (the image does not); the more is under way,
//   the less is drawn that could hide what is asked. Asks about every visible object every frame.
// Sources: Zachmann slides 61-63. The listing there never takes the front of its list off, so that
//   it would not end, and has no way on for objects outside of the view; both are mended here, and
//   occlusion.wrong[error=never_pops] keeps the listing. Bittner et al. 2004 (with a hierarchy).

#include "algorithms/occlusion/object_list.h"
#include "algorithms/occlusion/visibility_memory.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace occlusion_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "occlusion.chc_flat";
  info.family = "occlusion";
  info.summary =
      "Front to back: asks about each object, draws at once what was visible in the last frame, "
      "and goes on while answers are under way; what shows after all is drawn when its answer "
      "arrives.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::timing;
  info.granularity = Granularity::object;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {
      ParameterSpec::integer("flush_every", 8, 1, 1000, "questions", ParameterSpec::Stage::query,
                             "after how many questions they are handed over to the device; few: "
                             "each costs more; many: answers come late"),
      threshold_parameter()};
  info.cost =
      "O(n log n) for n candidates; a query for each object in the view, and up to two changes of "
      "state for each";
  info.limits =
      "Draws more than it needs to when answers are late. Asks about every visible object in every "
      "frame, with a change of state for most. With threshold_px > 0 it is approximate.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 61-63",
                  "Bittner, Wimmer, Piringer, Purgathofer 2004, Coherent Hierarchical Culling"};
  return info;
}

class ChcFlat : public ICuller {
 public:
  explicit ChcFlat(const ParameterValues& values)
      : flush_every_(static_cast<std::size_t>(values.integer("flush_every"))),
        threshold_px_(static_cast<std::uint64_t>(values.integer("threshold_px"))) {
    info_ = describe();
    if (threshold_px_ > 0) info_.guarantee = Guarantee::approximate;
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    device_ = &required_device(info_.name, context);
    list_.reserve(scene.object_count());
    kept_.reserve(scene.object_count());
    queue_.reserve(scene.object_count());
    memory_.build(scene.object_count());
  }

  void reset(std::uint64_t) override { memory_.reset(); }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    queue_.clear();
    front_ = handed_over_ = 0;
    list_.fill(frame, candidates);
    for (const ListedObject& listed : list_.objects()) {
      if (!listed.askable) {
        kept_.add(listed.object);
        memory_.mark(frame.index, listed.object);
        continue;
      }
      ask(frame, listed, out);
      if (queue_.size() - handed_over_ >= flush_every_) hand_over();
      while (front_ < handed_over_ && device_->ready(queue_[front_].query)) take_answer(frame);
    }
    hand_over();
    kept_.draw(out);
    while (front_ < queue_.size()) take_answer(frame);
    kept_.emit(out);
  }

  std::size_t bytes() const override {
    return list_.bytes() + kept_.bytes() + memory_.bytes() + queue_.capacity() * sizeof(Asked);
  }
  Counters counters() const override {
    return {{"occluded", occluded_}, {"outside", list_.outside()}};
  }

 private:
  struct Asked {
    QueryId query;
    ObjectId object = 0;
    bool drawn = false;
  };

  void ask(const Frame& frame, const ListedObject& listed, DrawSink& out) {
    kept_.draw(out);
    const bool seen_before = memory_.seen_before(frame.index, listed.object);
    queue_.push_back({device_->query({&listed.asked, 1}), listed.object, seen_before});
    if (seen_before) kept_.add(listed.object);
  }

  void hand_over() {
    if (handed_over_ == queue_.size()) return;
    device_->flush();
    handed_over_ = queue_.size();
  }

  /// Of the queue's front; waits if it has not arrived.
  void take_answer(const Frame& frame) {
    const Asked& asked = queue_[front_++];
    if (device_->samples(asked.query) > threshold_px_) {
      memory_.mark(frame.index, asked.object);
      if (!asked.drawn) kept_.add(asked.object);
    } else if (!asked.drawn) {
      ++occluded_;
    }
  }

  std::size_t flush_every_;
  std::uint64_t threshold_px_;
  CullerInfo info_;
  RenderDevice* device_ = nullptr;
  ObjectList list_;
  KeptObjects kept_;
  VisibilityMemory memory_;
  std::vector<Asked> queue_;
  std::size_t front_ = 0;        // of queue_: answers before it were taken
  std::size_t handed_over_ = 0;  // of queue_: questions before it can be answered
  std::uint64_t occluded_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry occlusion_chc_flat() {
  return {describe(),
          [](const ParameterValues& values) { return std::make_unique<ChcFlat>(values); }};
}

}  // namespace cullers
}  // namespace vislab
