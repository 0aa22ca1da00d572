// occlusion.chc: coherent hierarchical culling: while the device finds answers, the walk goes
// on with what was visible in the last frame.
//
// Idea: a walk over a hierarchy, near first. Inner nodes that were visible in the last frame
//   are opened unasked. Units that were visible are asked about and drawn at once, without
//   waiting. Nodes that were hidden are asked about, and wait in a queue; when an answer is
//   there, what shows is drawn or opened, what does not is hidden. A visible unit makes all
//   above it visible (pull up); a node below which all is hidden is asked about as a whole in
//   the next frame (pull down of what is hidden). The walk waits only if there is nothing else
//   to do.
// Guarantee: image_exact (threshold_px = 0): each object in the view is drawn, or lies in a box
//   that was found without a sample behind what was drawn in this frame. A node that comes near
//   the near plane is opened or drawn unasked.
// Cost: a query for every visible unit and for every hidden node beside them, each with a
//   change from drawing to asking and back.
// Limits: where most is visible, it asks about everything for nothing. What answers arrive in
//   time depends on the device: only the image is the same.
// Sources: Bittner, Wimmer, Piringer, Purgathofer 2004, Coherent Hierarchical Culling;
//   Zachmann, Computer-Graphik 2, SS 2012, slides 61-63.

#include <vector>

#include "algorithms/occlusion/box_queries.h"
#include "algorithms/occlusion/node_boxes.h"
#include "algorithms/occlusion/node_memory.h"
#include "algorithms/occlusion/node_walk.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using occlusion_culling::NodeBoxes;
using occlusion_culling::NodeMemory;
using occlusion_culling::NodeWalk;

CullerInfo describe() {
  CullerInfo info;
  info.name = "occlusion.chc";
  info.family = "occlusion";
  info.summary =
      "Walks a hierarchy front to back, asks about every unit and every hidden node, and goes on "
      "with what was visible in the last frame while answers are on their way.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::timing;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.needs_device = true;
  info.parameters = {
      ParameterSpec::integer("leaf_triangles", 1000, 1, 100'000'000, "triangles",
                             ParameterSpec::Stage::build,
                             "nodes with so many triangles, a draw counting as 20, are asked about "
                             "and drawn as a whole"),
      ParameterSpec::integer(
          "threshold_px", 0, 0, 1'000'000, "pixels", ParameterSpec::Stage::query,
          "nodes whose boxes show no more pixels than this are left out; above 0 "
          "small things vanish from the image")};
  info.cost = "a query for every visible unit and every hidden node beside these";
  info.limits =
      "Asks about everything that is visible in every frame, one by one, which costs more than it "
      "saves where little is hidden. With threshold_px > 0 it is approximate.";
  info.sources = {"Bittner, Wimmer, Piringer, Purgathofer 2004, Coherent Hierarchical Culling",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 61-63"};
  return info;
}

class Chc : public ICuller {
 public:
  explicit Chc(const ParameterValues& values)
      : info_(describe()),
        walk_(static_cast<std::uint32_t>(values.integer("leaf_triangles"))),
        threshold_px_(static_cast<std::uint64_t>(values.integer("threshold_px"))) {
    if (threshold_px_ > 0) info_.guarantee = Guarantee::approximate;
  }

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    device_ = &occlusion_culling::required_device(info_.name, context);
    walk_.build(scene);
    boxes_of_.build(scene, {});
    reset(0);
  }

  void reset(std::uint64_t) override {
    walk_.reset();
    memory_.reset(walk_.hierarchy().node_count());
  }

  void update(const Frame& frame, const Changes& changes) override {
    walk_.update(frame, changes);
    memory_.forget(walk_.hierarchy().changed());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    frame_ = &frame;
    memory_.start(frame, walk_.hierarchy());
    walk_.start(frame, candidates);
    asked_.clear();
    next_answer_ = 0;
    flushed_ = 0;
    unflushed_ = 0;

    NodeWalk::Visit visit;
    for (;;) {
      const bool walks = walk_.next(visit);
      if (walks) decide(visit, out);
      if (next_answer_ == asked_.size()) {
        if (!walks) break;
        continue;
      }
      // Waits only if there is nothing to walk.
      if (!walks || unflushed_ >= flush_after) flush();
      if (!walks) read_answer();
      while (next_answer_ < flushed_ && device_->ready(asked_[next_answer_].query)) read_answer();
    }
    walk_.hand_over(out);
  }

  std::size_t bytes() const override {
    return walk_.bytes() + memory_.bytes() + asked_.capacity() * sizeof(Asked) +
           boxes_.capacity() * sizeof(Aabb);
  }

  Counters counters() const override {
    return {{"queries", queries_}, {"nodes_visited", walk_.nodes_visited()}};
  }

 private:
  struct Asked {
    QueryId query;
    NodeWalk::Visit visit;
    bool drawn = false;
  };
  /// Without a flush no answer ever comes; each costs more than a query.
  static constexpr std::size_t flush_after = 8;

  void decide(const NodeWalk::Visit& visit, DrawSink& out) {
    const bool unit = walk_.hierarchy().is_unit(visit.node);
    const bool was_visible = memory_.was_visible(visit.node);
    memory_[visit.node].visited = memory_.now();
    if (was_visible && !unit) {
      walk_.open(visit);
    } else if (ask(visit, was_visible, out)) {
      if (was_visible) walk_.draw(visit);
    } else {
      take_as_visible(visit, false);
    }
  }

  /// False if nothing may be concluded from an answer.
  bool ask(const NodeWalk::Visit& visit, bool drawn, DrawSink& out) {
    boxes_.clear();
    if (boxes_of_.append(*frame_, walk_.hierarchy(), visit.node, boxes_) == 0) return false;
    if (walk_.hand_over(out)) out.flush();
    asked_.push_back({device_->query(boxes_), visit, drawn});
    ++queries_;
    ++unflushed_;
    return true;
  }

  void flush() {
    if (unflushed_ == 0) return;
    device_->flush();
    unflushed_ = 0;
    flushed_ = asked_.size();
  }

  void read_answer() {
    const Asked asked = asked_[next_answer_++];
    if (device_->samples(asked.query) > threshold_px_) {
      take_as_visible(asked.visit, asked.drawn);
    } else {
      memory_.note_hidden(asked.visit.node);
    }
  }

  void take_as_visible(const NodeWalk::Visit& visit, bool drawn) {
    if (!walk_.hierarchy().is_unit(visit.node)) {
      walk_.open(visit);
      return;
    }
    memory_.note_visible(walk_.hierarchy(), visit.node);
    if (!drawn) walk_.draw(visit);
  }

  CullerInfo info_;
  NodeWalk walk_;
  NodeBoxes boxes_of_;
  NodeMemory memory_;
  std::uint64_t threshold_px_;
  RenderDevice* device_ = nullptr;

  // Of a call of cull().
  const Frame* frame_ = nullptr;
  std::vector<Asked> asked_;     // the query queue
  std::size_t next_answer_ = 0;  // in asked_
  std::size_t flushed_ = 0;      // of asked_
  std::size_t unflushed_ = 0;    // the rest
  std::vector<Aabb> boxes_;

  std::uint64_t queries_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry occlusion_chc() {
  return {describe(), [](const ParameterValues& values) { return std::make_unique<Chc>(values); }};
}

}  // namespace cullers
}  // namespace vislab
