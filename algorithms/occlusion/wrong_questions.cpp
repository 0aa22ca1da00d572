#include "algorithms/occlusion/wrong_questions.h"

#include <vector>

#include "algorithms/occlusion/late_answers.h"
#include "algorithms/occlusion/object_list.h"
#include "common/render/query_bounds.h"

namespace vislab::occlusion_culling {
namespace {

/// Front to back, a question and its answer for each object in the view. Right as it stands.
class AskEach : public ICuller {
 public:
  explicit AskEach(CullerInfo info) : info_(std::move(info)) {}
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    device_ = &required_device(info_.name, context);
    list_.reserve(scene.object_count());
    kept_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    list_.fill(frame, candidates);
    for (const ListedObject& listed : list_.objects()) {
      Aabb asked = listed.asked;
      const bool may_ask = askable(frame, listed, asked);
      if (may_ask) kept_.draw(out);
      if (!may_ask || shows(answer(asked))) {
        kept_.add(listed.object);
      } else {
        ++occluded_;
      }
    }
    kept_.emit(out);
  }

  std::size_t bytes() const override { return list_.bytes() + kept_.bytes(); }
  Counters counters() const override {
    return {{"occluded", occluded_}, {"outside", list_.outside()}};
  }

 protected:
  /// May the object be asked about, and by which box?
  virtual bool askable(const Frame&, const ListedObject& listed, Aabb&) const {
    return listed.askable;
  }
  virtual bool shows(std::uint64_t samples) const { return samples > 0; }
  /// The samples of a box against what is drawn.
  virtual std::uint64_t answer(const Aabb& asked) {
    const QueryId query = device().query({&asked, 1});
    device().flush();
    return device().samples(query);
  }
  RenderDevice& device() { return *device_; }

 private:
  CullerInfo info_;
  RenderDevice* device_ = nullptr;
  ObjectList list_;
  KeptObjects kept_;
  std::uint64_t occluded_ = 0;
};

class NearBoxAsked : public AskEach {
 public:
  using AskEach::AskEach;

 protected:
  bool askable(const Frame& frame, const ListedObject& listed, Aabb& asked) const override {
    const Aabb& box = frame.objects.bounds[listed.object];
    asked = enlarged_for_query(frame.camera, frame.viewport, box);
    return box.valid();
  }
};

class UnenlargedBoxes : public AskEach {
 public:
  using AskEach::AskEach;

 protected:
  bool askable(const Frame& frame, const ListedObject& listed, Aabb& asked) const override {
    asked = frame.objects.bounds[listed.object];
    return listed.askable;
  }
};

class AtLeastThreshold : public AskEach {
 public:
  using AskEach::AskEach;

 protected:
  bool shows(std::uint64_t samples) const override {
    constexpr std::uint64_t threshold = 0;
    return samples >= threshold;
  }
};

class StaleAnswers : public AskEach {
 public:
  using AskEach::AskEach;

  void build(const Scene& scene, const BuildContext& context) override {
    AskEach::build(scene, context);
    answers_.reserve(scene.object_count());
    last_answers_.reserve(scene.object_count());
  }
  void reset(std::uint64_t) override {
    answers_.clear();
    last_answers_.clear();
  }
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    if (frame.index != frame_) {
      frame_ = frame.index;
      std::swap(answers_, last_answers_);
      answers_.clear();
    }
    AskEach::cull(frame, candidates, out);
  }
  std::size_t bytes() const override {
    return AskEach::bytes() +
           (answers_.capacity() + last_answers_.capacity()) * sizeof(std::uint64_t);
  }

 protected:
  std::uint64_t answer(const Aabb& asked) override {
    const std::size_t number = answers_.size();
    answers_.push_back(AskEach::answer(asked));
    return number < last_answers_.size() ? last_answers_[number] : answers_.back();
  }

 private:
  std::uint64_t frame_ = 0;
  std::vector<std::uint64_t> answers_, last_answers_;  // by number of the question in its frame
};

class RecycledHandles : public LateAnswers {
 public:
  explicit RecycledHandles(CullerInfo info) : LateAnswers(std::move(info), 1) {}

  void build(const Scene& scene, const BuildContext& context) override {
    LateAnswers::build(scene, context);
    slots_.resize(scene.object_count());
    free_.reserve(scene.object_count());
    reset(0);
  }
  void reset(std::uint64_t seed) override {
    LateAnswers::reset(seed);
    free_.clear();
    for (std::size_t i = 0; i < slots_.size(); ++i) slots_[i] = i;
  }
  void update(const Frame&, const Changes& changes) override {
    for (const ObjectId object : changes.hidden) free_.push_back(slots_[object]);
    for (const ObjectId object : changes.shown) {
      slots_[object] = free_.back();
      free_.pop_back();
    }
  }
  std::size_t bytes() const override {
    return LateAnswers::bytes() + (slots_.capacity() + free_.capacity()) * sizeof(std::size_t);
  }

 protected:
  std::size_t place_of(ObjectId object) const override { return slots_[object]; }

 private:
  std::vector<std::size_t> slots_;  // by object, those that are shown
  std::vector<std::size_t> free_;   // of objects that are gone
};

class NeverPops : public ICuller {
 public:
  explicit NeverPops(CullerInfo info) : info_(std::move(info)) {}
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    device_ = &required_device(info_.name, context);
    list_.reserve(scene.object_count());
    kept_.reserve(1);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    list_.fill(frame, candidates);
    if (list_.objects().empty()) return;
    const ListedObject& front = list_.objects().front();
    bool drawn = !front.askable;
    if (drawn) kept_.add(front.object);
    for (std::size_t step = 0; step < list_.objects().size(); ++step) {
      if (!front.askable) continue;
      kept_.draw(out);
      const QueryId query = device_->query({&front.asked, 1});
      device_->flush();
      if (device_->samples(query) > 0 && !drawn) {
        kept_.add(front.object);
        drawn = true;
      }
    }
    ++step_limits_;
    kept_.emit(out);
  }

  std::size_t bytes() const override { return list_.bytes() + kept_.bytes(); }
  Counters counters() const override {
    return {{"step_limits", step_limits_}, {"outside", list_.outside()}};
  }

 private:
  CullerInfo info_;
  RenderDevice* device_ = nullptr;
  ObjectList list_;
  KeptObjects kept_;
  std::uint64_t step_limits_ = 0;
};

}  // namespace

std::unique_ptr<ICuller> make_near_box_asked(CullerInfo info) {
  return std::make_unique<NearBoxAsked>(std::move(info));
}
std::unique_ptr<ICuller> make_unenlarged_boxes(CullerInfo info) {
  return std::make_unique<UnenlargedBoxes>(std::move(info));
}
std::unique_ptr<ICuller> make_at_least_threshold(CullerInfo info) {
  return std::make_unique<AtLeastThreshold>(std::move(info));
}
std::unique_ptr<ICuller> make_stale_answers(CullerInfo info) {
  return std::make_unique<StaleAnswers>(std::move(info));
}
std::unique_ptr<ICuller> make_recycled_handles(CullerInfo info) {
  return std::make_unique<RecycledHandles>(std::move(info));
}
std::unique_ptr<ICuller> make_never_pops(CullerInfo info) {
  return std::make_unique<NeverPops>(std::move(info));
}

}  // namespace vislab::occlusion_culling
