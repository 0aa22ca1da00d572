#include "common/culler/chain.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "common/culler/cell_walker.h"

namespace vislab {
namespace {

/// Puts the triangle ranges back on the objects that a stage of object granularity keeps.
class RangeRestorer : public DrawSink {
 public:
  void prepare(std::size_t object_count) { slot_of_.assign(object_count, 0); }

  /// Groups ranges by object. Returns the objects in the order in which they first appear.
  std::span<const ObjectId> group(std::span<const std::span<const TriangleRange>> runs) {
    // Two passes: count the ranges of each object, then place them behind each other.
    objects_.clear();
    starts_.clear();
    for (const std::span<const TriangleRange> run : runs) {
      for (const TriangleRange& range : run) {
        std::uint32_t& slot = slot_of_[range.object];
        if (slot == 0) {
          objects_.push_back(range.object);
          starts_.push_back(0);
          slot = static_cast<std::uint32_t>(objects_.size());
        }
        ++starts_[slot - 1];
      }
    }
    std::uint32_t total = 0;
    for (std::uint32_t& start : starts_) total += std::exchange(start, total);
    starts_.push_back(total);
    grouped_.resize(total);
    fill_.assign(starts_.begin(), starts_.end());
    for (const std::span<const TriangleRange> run : runs) {
      for (const TriangleRange& range : run) {
        grouped_[fill_[slot_of_[range.object] - 1]++] = range;
      }
    }
    return objects_;
  }
  void set_downstream(DrawSink& downstream) { downstream_ = &downstream; }
  /// Forgets the objects of the last group(): O(objects in it).
  void clear() {
    for (const ObjectId object : objects_) slot_of_[object] = 0;
  }

  void everything() override {
    throw std::logic_error("a culler emitted everything, but was offered a part");
  }
  void objects(std::span<const ObjectId> ids) override {
    // Neighbours in the order of the grouping become one span.
    std::size_t i = 0;
    while (i < ids.size()) {
      const std::uint32_t first = slot(ids[i]);
      std::uint32_t last = first;
      for (++i; i < ids.size() && slot(ids[i]) == last + 1; ++i) ++last;
      const std::uint32_t begin = starts_[first];
      downstream_->ranges({grouped_.data() + begin, starts_[last + 1] - begin});
    }
  }
  void ranges(std::span<const TriangleRange>) override {
    throw std::logic_error("a culler of object granularity emitted triangle ranges");
  }
  void flush() override { downstream_->flush(); }

  std::size_t bytes() const { return slot_of_.capacity() * sizeof(std::uint32_t); }

 private:
  std::uint32_t slot(ObjectId object) const {
    const std::uint32_t slot = slot_of_[object];
    if (slot == 0) throw std::logic_error("a culler emitted an object that it was not offered");
    return slot - 1;
  }

  std::vector<std::uint32_t> slot_of_;  // by object: position in objects_ plus 1; 0 = not offered
  std::vector<ObjectId> objects_;
  std::vector<std::uint32_t> starts_, fill_;
  std::vector<TriangleRange> grouped_;
  DrawSink* downstream_ = nullptr;
};

/// What lies before a stage: collects what is emitted towards it, and offers all at once in a form
/// that the stage understands. The first stage has one too, because a chain of triangle granularity
/// may begin with a stage of object granularity.
class Link : public DrawSink {
 public:
  explicit Link(ICuller& next) : next_(&next) {}

  void prepare(const Scene& scene) {
    scene_ = &scene;
    if (next_->info().granularity == Granularity::object) restorer_.prepare(scene.object_count());
  }
  void start(const Frame& frame, DrawSink& downstream, Link* downstream_link) {
    frame_ = &frame;
    downstream_ = &downstream;
    downstream_link_ = downstream_link;
    restorer_.set_downstream(downstream);
    forget();
  }

  void everything() override { everything_ = true; }
  void objects(std::span<const ObjectId> ids) override {
    if (ids.empty()) return;
    objects_.push_back(ids);
    order_.push_back(Form::objects);
  }
  void ranges(std::span<const TriangleRange> ranges) override {
    if (ranges.empty()) return;
    ranges_.push_back(ranges);
    order_.push_back(Form::ranges);
  }
  void flush() override {
    offer();
    downstream_->flush();
  }

  /// Collects what the whole chain is offered.
  void take(const Candidates& candidates) {
    switch (candidates.form()) {
      case Form::everything:
        everything();
        break;
      case Form::objects:
        for (const std::span<const ObjectId> run : candidates.object_runs()) objects(run);
        break;
      case Form::ranges:
        for (const std::span<const TriangleRange> run : candidates.range_runs()) ranges(run);
        break;
    }
  }

  /// Offers what was collected to the next stage, and so on down the chain.
  void offer() {
    if (everything_) {
      next_->cull(*frame_, Candidates::everything(), *downstream_);
    } else if (!ranges_.empty()) {
      if (!objects_.empty()) objects_to_ranges();
      offer_ranges();
    } else if (!objects_.empty()) {
      next_->cull(*frame_, Candidates::of(std::span<const std::span<const ObjectId>>(objects_)),
                  *downstream_);
    } else {
      return;
    }
    forget();
    if (downstream_link_ != nullptr) downstream_link_->offer();
  }

  std::size_t bytes() const { return restorer_.bytes(); }

 private:
  using Form = Candidates::Form;

  void forget() {
    everything_ = false;
    objects_.clear();
    ranges_.clear();
    order_.clear();
  }

  /// Objects and ranges in one batch become ranges, in the order of emission.
  void objects_to_ranges() {
    merged_.clear();
    auto objects = objects_.begin();
    auto ranges = ranges_.begin();
    for (const Form form : order_) {
      if (form == Form::objects) {
        for (const ObjectId id : *objects) merged_.push_back({id, 0, scene_->triangle_count(id)});
        ++objects;
      } else {
        merged_.insert(merged_.end(), ranges->begin(), ranges->end());
        ++ranges;
      }
    }
    ranges_.clear();
    ranges_.push_back(merged_);
  }

  void offer_ranges() {
    const std::span<const std::span<const TriangleRange>> runs(ranges_);
    if (next_->info().granularity != Granularity::object) {
      next_->cull(*frame_, Candidates::of(runs), *downstream_);
      return;
    }
    const std::span<const ObjectId> objects = restorer_.group(runs);
    next_->cull(*frame_, Candidates::of(std::span<const std::span<const ObjectId>>(&objects, 1)),
                restorer_);
    restorer_.clear();
  }

  ICuller* next_;
  const Scene* scene_ = nullptr;
  const Frame* frame_ = nullptr;
  DrawSink* downstream_ = nullptr;
  Link* downstream_link_ = nullptr;
  bool everything_ = false;
  std::vector<std::span<const ObjectId>> objects_;
  std::vector<std::span<const TriangleRange>> ranges_;
  std::vector<Form> order_;  // of the entries of objects_ and ranges_
  std::vector<TriangleRange> merged_;
  RangeRestorer restorer_;
};

class Chain : public ICuller, public CellWalker {
 public:
  explicit Chain(std::vector<std::unique_ptr<ICuller>> stages) : stages_(std::move(stages)) {
    if (stages_.size() < 2) throw std::logic_error("a chain has at least two stages");
    for (const auto& stage : stages_) links_.emplace_back(*stage);
    describe();
  }

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    for (const auto& stage : stages_) stage->build(scene, context);
    for (Link& link : links_) link.prepare(scene);
  }

  void reset(std::uint64_t seed) override {
    for (const auto& stage : stages_) stage->reset(seed);
  }

  void update(const Frame& frame, const Changes& changes) override {
    for (const auto& stage : stages_) stage->update(frame, changes);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    for (std::size_t i = 0; i < links_.size(); ++i) {
      Link* const next = i + 1 < links_.size() ? &links_[i + 1] : nullptr;
      links_[i].start(frame, next != nullptr ? static_cast<DrawSink&>(*next) : out, next);
    }
    links_.front().take(candidates);
    links_.front().offer();
  }

  std::size_t bytes() const override {
    std::size_t sum = 0;
    for (const auto& stage : stages_) sum += stage->bytes();
    for (const Link& link : links_) sum += link.bytes();
    return sum;
  }

  Counters counters() const override {
    Counters all;
    for (const auto& stage : stages_) {
      for (const auto& [name, count] : stage->counters()) {
        const auto known = std::ranges::find(all, name, &Counters::value_type::first);
        if (known == all.end()) {
          all.emplace_back(name, count);
        } else {
          known->second += count;
        }
      }
    }
    return all;
  }

  /// Of the first stage that knows.
  bool append_reached_cells(std::vector<CellId>& cells) const override {
    return std::ranges::any_of(stages_, [&](const std::unique_ptr<ICuller>& stage) {
      const auto* const walker = dynamic_cast<const CellWalker*>(stage.get());
      return walker != nullptr && walker->append_reached_cells(cells);
    });
  }

 private:
  void describe() {
    info_.family = "chain";
    for (const auto& stage : stages_) {
      const CullerInfo& part = stage->info();
      const bool first = info_.name.empty();
      info_.name += (first ? "" : " > ") + part.name;
      info_.summary += (first ? "" : " Then: ") + part.summary;
      info_.guarantee = std::max(info_.guarantee, part.guarantee);
      info_.repeatability = std::max(info_.repeatability, part.repeatability);
      info_.granularity = std::max(info_.granularity, part.granularity);
      // Stages of several kinds together are held to everything that is hidden.
      info_.culls = first || info_.culls == part.culls ? part.culls : Culls::hidden;
      if (first || part.space == Space::image) info_.space = part.space;
      info_.stage = std::max(info_.stage, part.stage);
      info_.needs_device |= part.needs_device;
      info_.needs_truth |= part.needs_truth;
      info_.cost += (first ? "" : " + ") + part.cost;
      info_.limits += (first ? "" : " ") + part.limits;
      info_.sources.insert(info_.sources.end(), part.sources.begin(), part.sources.end());
    }
  }

  std::vector<std::unique_ptr<ICuller>> stages_;
  std::vector<Link> links_;  // one before each stage
  CullerInfo info_;
};

}  // namespace

std::unique_ptr<ICuller> make_chain(std::vector<std::unique_ptr<ICuller>> stages) {
  return std::make_unique<Chain>(std::move(stages));
}

}  // namespace vislab
