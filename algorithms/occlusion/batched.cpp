// occlusion.batched: asks about objects in batches, and draws at once what was visible before.
//
// Idea: between drawing and asking the device changes its state, and an answer takes its time; both
//   cost more than the question. So questions wait in two queues until a batch of them is together.
//   Objects that were visible in the last frame are drawn at once, unasked, and join the V-queue:
//   its answers are only the next frame's guesses, and nobody waits for them before the frame's
//   end. Objects that were not seen join the I-queue: after its batch is asked, the answers are
//   read, and what shows is drawn.
// Guarantee: image_exact (threshold_px = 0): left out is only what a question of this frame about
//   its enlarged box found hidden behind what was drawn before, or what is surely outside of the
//   view. Boxes that the near plane may cut are drawn unasked. threshold_px > 0 leaves out objects
//   whose boxes show no more than that many pixels: approximate.
// Cost: O(n log n) to sort; a question for each object in the view, every frame; one wait for each
//   I-batch and one at the end. A batch of b saves b - 1 of b changes of state and waits, but what
//   is found visible is drawn only after its batch, too late to hide others of the same one.
// Limits: every visible object is asked about in every frame, so it loses where little is hidden;
//   the first frame and a cut find nothing seen before, and then all waits for I-batches.
// Sources: Zachmann slides 54-57 (I-queue and V-queue, batches of 20-80), 60 (threshold).

#include "algorithms/occlusion/object_list.h"
#include "algorithms/occlusion/visibility_memory.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace occlusion_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "occlusion.batched";
  info.family = "occlusion";
  info.summary =
      "Front to back: draws at once what was visible in the last frame, and asks the device about "
      "objects in batches, those not seen before and those seen before apart.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {
      ParameterSpec::integer("batch", 80, 1, 1000, "questions", ParameterSpec::Stage::query,
                             "how many questions are asked together; few: many changes of state "
                             "and waits; many: objects of one batch do not hide each other"),
      threshold_parameter()};
  info.cost =
      "O(n log n) for n candidates; a query for each object in the view; a wait for each batch of "
      "objects that were not seen before";
  info.limits =
      "Asks about every visible object in every frame, so it loses where little is hidden. Objects "
      "of one batch do not hide each other. With threshold_px > 0 it is approximate.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 54-57, 60"};
  return info;
}

class Batched : public ICuller {
 public:
  explicit Batched(const ParameterValues& values)
      : batch_(static_cast<std::size_t>(values.integer("batch"))),
        threshold_px_(static_cast<std::uint64_t>(values.integer("threshold_px"))) {
    info_ = describe();
    if (threshold_px_ > 0) info_.guarantee = Guarantee::approximate;
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    device_ = &required_device(info_.name, context);
    const std::size_t objects = scene.object_count();
    list_.reserve(objects);
    kept_.reserve(objects);
    memory_.build(objects);
    invisible_.reserve(batch_);
    visible_.reserve(batch_);
    asked_.reserve(objects);
    answers_.reserve(batch_);
  }

  void reset(std::uint64_t) override { memory_.reset(); }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    asked_.clear();
    list_.fill(frame, candidates);
    for (const ListedObject& listed : list_.objects()) {
      if (!listed.askable) {
        keep(frame, listed.object);
      } else if (memory_.seen_before(frame.index, listed.object)) {
        kept_.add(listed.object);
        visible_.push_back(&listed);
        if (visible_.size() == batch_) ask_visible(out);
      } else {
        invisible_.push_back(&listed);
        if (invisible_.size() == batch_) ask_invisible(frame, out);
      }
    }
    if (!invisible_.empty()) ask_invisible(frame, out);
    if (!visible_.empty()) ask_visible(out);
    kept_.emit(out);
    for (const Asked& asked : asked_) {
      if (device_->samples(asked.query) > threshold_px_) memory_.mark(frame.index, asked.object);
    }
  }

  std::size_t bytes() const override {
    return list_.bytes() + kept_.bytes() + memory_.bytes() + asked_.capacity() * sizeof(Asked) +
           (invisible_.capacity() + visible_.capacity()) * sizeof(const ListedObject*) +
           answers_.capacity() * sizeof(QueryId);
  }
  Counters counters() const override {
    return {{"batches", batches_}, {"occluded", occluded_}, {"outside", list_.outside()}};
  }

 private:
  struct Asked {
    QueryId query;
    ObjectId object = 0;
  };

  void keep(const Frame& frame, ObjectId object) {
    kept_.add(object);
    memory_.mark(frame.index, object);
  }

  void ask_invisible(const Frame& frame, DrawSink& out) {
    kept_.draw(out);
    answers_.clear();
    for (const ListedObject* listed : invisible_) {
      answers_.push_back(device_->query({&listed->asked, 1}));
    }
    device_->flush();
    ++batches_;
    for (std::size_t i = 0; i < invisible_.size(); ++i) {
      if (device_->samples(answers_[i]) > threshold_px_) {
        keep(frame, invisible_[i]->object);
      } else {
        ++occluded_;
      }
    }
    invisible_.clear();
  }

  /// Asks about objects that are kept already.
  void ask_visible(DrawSink& out) {
    kept_.draw(out);
    for (const ListedObject* listed : visible_) {
      asked_.push_back({device_->query({&listed->asked, 1}), listed->object});
    }
    device_->flush();
    ++batches_;
    visible_.clear();
  }

  std::size_t batch_;
  std::uint64_t threshold_px_;
  CullerInfo info_;
  RenderDevice* device_ = nullptr;
  ObjectList list_;
  KeptObjects kept_;
  VisibilityMemory memory_;
  std::vector<const ListedObject*> invisible_;  // the I-queue
  std::vector<const ListedObject*> visible_;    // the V-queue
  std::vector<Asked> asked_;                    // of the V-queue, not yet read
  std::vector<QueryId> answers_;                // of an I-batch
  std::uint64_t batches_ = 0;
  std::uint64_t occluded_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry occlusion_batched() {
  return {describe(),
          [](const ParameterValues& values) { return std::make_unique<Batched>(values); }};
}

}  // namespace cullers
}  // namespace vislab
