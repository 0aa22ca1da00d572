// occlusion.chcpp: CHC++, coherent hierarchical culling with its queries collected, shared,
// tightened and spread over frames.
//
// Idea: what was visible in the last frame is drawn at once, near first. Nodes that were hidden
//   wait in a queue and are asked about in one go when the walk has nothing else to do, or when
//   `batch` of them wait: by then most of what hides them is drawn, and the device changes from
//   drawing to asking once. Nodes hidden for long share queries (multiquery.h). What was
//   visible is asked about again only every `interval` frames, at first after a random part of
//   that, so that not all of it is asked about in one frame; these questions are put behind the
//   others, so that the device has something to do while the walk waits (`lazy`). Boxes of
//   units are unions of small ones (tight_bounds.h), since what is falsely visible is drawn,
//   which costs most of all.
// Guarantee: image_exact (threshold_px = 0): in every frame each object in the view is drawn,
//   or lies in a box that was found without a sample behind what was drawn in this frame.
//   Answers of earlier frames are guesses. A node that comes near the near plane is opened or
//   drawn unasked.
// Cost: O(visible nodes + hidden nodes beside them) a frame; queries: 1 ÷ interval of the
//   visible units and some groups of hidden nodes. The frame waits for an answer about as often
//   as hidden nodes become visible one below the other.
// Limits: an object whose boxes show although it does not is drawn. In a frame after a cut
//   nothing is known: many rounds of questions, near first. Answers are read in the order of
//   asking and never polled, so that they do not depend on time.
//   With threshold_px > 0 a node is left out as a whole: the larger units are, the more pixels they
//   show, so the less is lost by the same threshold. Sharing queries loses nothing more, since a
//   group that shows little has no member that shows more.
// Beyond the sources, because it was measured, each with a switch:
//   - A hidden node whose box showed though all below it was hidden is opened unasked until its
//     next test, where the paper asks about it in every frame (`open_unasked`).
//   - Of many units that appear together, as after a cut, the nearer half is drawn and the rest
//     asked about again: they may hide each other (`reask`).
//   - What nothing is known of is not asked about if hardly any answer of the frame was
//     "hidden" (`skip_vain`); and where that lasts, the method sleeps (`sleep`, sleep_pattern.h).
//   - What is drawn is handed over now and then, so that the device rasterises while the walk
//     goes on (`hand_over_triangles`).
// Sources: Mattausch, Bittner, Wimmer 2008, CHC++: Coherent Hierarchical Culling Revisited;
//   Zachmann, Computer-Graphik 2, SS 2012, slides 64-75.

#include <algorithm>

#include "algorithms/occlusion/box_queries.h"
#include "algorithms/occlusion/chcpp_info.h"
#include "algorithms/occlusion/hidden_queue.h"
#include "algorithms/occlusion/node_boxes.h"
#include "algorithms/occlusion/node_memory.h"
#include "algorithms/occlusion/node_walk.h"
#include "algorithms/occlusion/sleep_pattern.h"
#include "common/culler/registry.h"
#include "common/geometry/random.h"

namespace vislab {
namespace {

using occlusion_culling::HiddenQueue;
using occlusion_culling::MultiqueryCost;
using occlusion_culling::MultiqueryModel;
using occlusion_culling::NodeBoxes;
using occlusion_culling::NodeMemory;
using occlusion_culling::NodeWalk;
using occlusion_culling::Persistence;
using occlusion_culling::SleepPattern;
using occlusion_culling::TightBounds;

/// By what nodes share queries; nothing if they do not.
std::optional<MultiqueryModel> sharing(const ParameterValues& values) {
  if (!values.boolean("multiqueries")) return std::nullopt;
  return MultiqueryModel{
      values.choice("cost_model") == "paper" ? MultiqueryCost::paper : MultiqueryCost::slides,
      values.real("box_cost")};
}

class Chcpp : public ICuller {
 public:
  explicit Chcpp(const ParameterValues& values)
      : info_(occlusion_culling::chcpp_info()),
        walk_(static_cast<std::uint32_t>(values.integer("leaf_triangles"))),
        hidden_(sharing(values), values.choice("persistence") == "formula"
                                     ? Persistence::Kind::formula
                                     : Persistence::Kind::measured),
        batch_(static_cast<std::size_t>(values.integer("batch"))),
        lazy_(values.boolean("lazy")),
        interval_(static_cast<std::uint32_t>(values.integer("interval"))),
        random_(values.choice("retest") == "random"),
        threshold_px_(static_cast<std::uint64_t>(values.integer("threshold_px"))),
        may_sleep_(values.boolean("sleep")),
        reask_(values.boolean("reask")),
        open_unasked_(values.boolean("open_unasked")),
        skip_vain_(values.boolean("skip_vain")),
        hand_over_triangles_(static_cast<std::uint64_t>(values.integer("hand_over_triangles"))) {
    if (values.boolean("tight_bounds")) {
      tight_ = {values.real("sigma"), static_cast<std::uint32_t>(values.integer("max_boxes")),
                values.choice("division") == "finest"};
    }
    if (threshold_px_ > 0) info_.guarantee = Guarantee::approximate;
  }

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    device_ = &occlusion_culling::required_device(info_.name, context);
    walk_.build(scene);
    boxes_of_.build(scene, tight_);
    reset(0);
  }

  void reset(std::uint64_t seed) override {
    walk_.reset();
    memory_.reset(walk_.hierarchy().node_count());
    hidden_.reset();
    chance_ = Random(seed);
    sleep_ = {};
  }

  void update(const Frame& frame, const Changes& changes) override {
    walk_.update(frame, changes);
    memory_.forget(walk_.hierarchy().changed());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    frame_ = &frame;
    const bool first_call = memory_.start(frame, walk_.hierarchy());
    // Without any memory nothing is known to be visible; what is nearest is.
    blind_ = !memory_.was_visited(SpatialStructure::root);
    const bool asleep = may_sleep_ && sleep_.asleep(frame.index);
    frames_slept_ += asleep && first_call ? 1 : 0;
    walk_.start(frame, candidates, asleep ? NodeWalk::Order::any : NodeWalk::Order::near_first);
    hidden_.start();
    due_.clear();
    boxes_.clear();
    retests_.clear();
    answer_count_ = 0;
    found_hidden_ = 0;
    drawn_work_ = 0;
    hidden_work_ = 0;
    waiting_triangles_ = 0;
    units_new_ = 0;
    most_retests_ = std::max<std::size_t>(batch_, units_drawn_now_ / interval_);
    units_drawn_now_ = 0;
    NodeWalk::Visit visit;
    if (asleep) {
      while (walk_.next(visit)) take_unasked(visit);
      sleep_.note_slept(units_new_ > 0 && units_new_ * new_part >= units_drawn_now_);
      units_drawn_ += units_drawn_now_;
      walk_.hand_over(out);
      return;
    }
    for (;;) {
      while (walk_.next(visit)) {
        decide(visit, out);
        if (hidden_.waiting() < batch_) continue;
        read_answers(out);
        ask(out);
      }
      if (!hidden_.under_way() && hidden_.waiting() == 0) break;
      if (!hidden_.under_way()) ask(out);
      read_answers(out);
    }
    finish_retests(out);
    walk_.hand_over(out);
    sleep_.note_tried(hidden_work_ * hidden_part < drawn_work_);
  }

  std::size_t bytes() const override {
    return walk_.bytes() + boxes_of_.bytes() + memory_.bytes() + hidden_.bytes() +
           (due_.capacity() + found_.capacity()) * sizeof(Entry) +
           answers_.capacity() * sizeof(HiddenQueue::Answer) +
           retests_.capacity() * sizeof(Retest) + boxes_.capacity() * sizeof(Aabb);
  }

  Counters counters() const override {
    return {{"queries", hidden_.queries() + retests_asked_},
            {"multiqueries", hidden_.shared_queries()},
            {"requeries", hidden_.requeries()},
            {"reasked", reasked_},
            {"retests", retests_asked_},
            {"opened_unasked", opened_unasked_},
            {"skipped_as_vain", skipped_as_vain_},
            {"frames_slept", frames_slept_},
            {"nodes_visited", walk_.nodes_visited()},
            {"units_drawn", units_drawn_},
            {"units_found_visible", units_found_visible_}};
  }

 private:
  using Entry = HiddenQueue::Entry;                 // its boxes lie in boxes_
  static constexpr std::uint64_t hidden_part = 20;  // less than one in so many is hardly any
  static constexpr std::uint64_t new_part = 8;      // one in so many is much
  static constexpr std::size_t many_found = 4;
  static constexpr std::uint64_t query_triangles = 100;  // cost as much as a query
  /// A question about a unit that is drawn.
  struct Retest {
    QueryId query;
    QueryHierarchy::NodeIndex node = 0;
  };

  void decide(const NodeWalk::Visit& visit, DrawSink& out) {
    NodeMemory::Node& known = memory_[visit.node];
    const bool unit = walk_.hierarchy().is_unit(visit.node);
    if (!memory_.was_visited(visit.node)) known.hidden_since = 0;
    if (memory_.was_visible(visit.node)) {
      if (unit) {
        draw_visible(visit, out);
      } else {
        walk_.open(visit);
      }
    } else if (open_unasked_ && !unit && memory_.was_visited(visit.node) &&
               memory_.now() < known.test_at) {
      // Its box shows, though what is below it was hidden.
      walk_.open(visit);
      ++opened_unasked_;
    } else if (memory_.hidden_frames(visit.node) == 0 && in_vain(visit.node)) {
      take_as_visible(visit, out);
      ++skipped_as_vain_;
    } else if ((blind_ && walk_.kept_count() == 0) || !wait_hidden(visit)) {
      take_as_visible(visit, out);
    }
    known.visited = memory_.now();
  }

  /// While asleep: everything in the view is drawn.
  void take_unasked(const NodeWalk::Visit& visit) {
    NodeMemory::Node& known = memory_[visit.node];
    known.visited = memory_.now();
    if (!walk_.hierarchy().is_unit(visit.node)) {
      walk_.open(visit);
      return;
    }
    if (!memory_.was_visible(visit.node)) {
      known.test_at = memory_.now() + first_interval();
      ++units_new_;
    }
    memory_.note_visible(walk_.hierarchy(), visit.node);
    ++units_drawn_now_;
    walk_.draw(visit);
  }

  /// A unit that was visible is drawn; if its time has come it is asked about for the next frame.
  void draw_visible(const NodeWalk::Visit& visit, DrawSink& out) {
    NodeMemory::Node& known = memory_[visit.node];
    Entry entry = {visit};
    const bool due = known.test_at <= memory_.now() &&
                     due_.size() + retests_.size() < most_retests_ && find_boxes(entry);
    if (due) {
      known.test_at = memory_.now() + interval_;
      due_.push_back(entry);
      if (!lazy_) ask_due(out);
    } else {
      memory_.note_visible(walk_.hierarchy(), visit.node);
    }
    draw(visit, out);
  }

  /// What was not visible before is, or nothing can be found out about it.
  void take_as_visible(const NodeWalk::Visit& visit, DrawSink& out) {
    NodeMemory::Node& known = memory_[visit.node];
    known.hidden_since = 0;
    known.test_at = memory_.now() + first_interval();
    if (!walk_.hierarchy().is_unit(visit.node)) {
      walk_.open(visit);
      return;
    }
    memory_.note_visible(walk_.hierarchy(), visit.node);
    draw(visit, out);
  }

  std::uint32_t first_interval() {
    return random_ ? 1 + static_cast<std::uint32_t>(chance_.below(interval_)) : interval_;
  }

  /// What is drawn is handed over now and then, so that the device has something to do meanwhile.
  void draw(const NodeWalk::Visit& visit, DrawSink& out) {
    ++units_drawn_;
    ++units_drawn_now_;
    drawn_work_ += walk_.hierarchy().work(visit.node);
    waiting_triangles_ += walk_.draw(visit);
    if (hand_over_triangles_ == 0 || waiting_triangles_ < hand_over_triangles_) return;
    waiting_triangles_ = 0;
    walk_.hand_over(out);
    out.flush();
    device_->flush();
  }

  bool find_boxes(Entry& entry) {
    entry.first_box = static_cast<std::uint32_t>(boxes_.size());
    entry.box_count = boxes_of_.append(*frame_, walk_.hierarchy(), entry.visit.node, boxes_);
    return entry.box_count > 0;
  }

  /// Puts a node into the queue of hidden ones. False if it cannot be asked about.
  bool wait_hidden(const NodeWalk::Visit& visit) {
    Entry entry = {visit};
    if (!find_boxes(entry)) return false;
    entry.hidden_frames = memory_.hidden_frames(visit.node);
    hidden_.add(entry);
    return true;
  }

  /// Asks about all hidden nodes that wait, behind everything kept so far, and about visible units
  /// whose time has come behind these.
  void ask(DrawSink& out) {
    if (walk_.hand_over(out)) out.flush();
    hidden_.ask(*device_, walk_.hierarchy(), boxes_);
    device_->flush();
    if (!due_.empty()) ask_due(out);
  }

  /// Asks about visible units again. Their answers are read when all is drawn.
  void ask_due(DrawSink& out) {
    if (walk_.hand_over(out)) out.flush();
    for (const Entry& entry : due_) {
      const QueryId query =
          device_->query(std::span(boxes_).subspan(entry.first_box, entry.box_count));
      retests_.push_back({query, entry.visit.node});
      ++retests_asked_;
    }
    due_.clear();
    device_->flush();
  }

  /// Reads what was asked about hidden nodes: what is visible is drawn or opened.
  void read_answers(DrawSink& out) {
    found_.clear();
    hidden_.read(*device_, threshold_px_, answers_);
    for (const auto& [entry, visible] : answers_) {
      // That a node shows says nothing of what is in it.
      const bool unit = walk_.hierarchy().is_unit(entry.visit.node);
      if (unit || !visible) ++answer_count_;
      if (!visible) {
        memory_.note_hidden(entry.visit.node);
        ++found_hidden_;
        hidden_work_ += walk_.hierarchy().work(entry.visit.node);
      } else if (unit) {
        found_.push_back(entry);
      } else {
        take_as_visible(entry.visit, out);
      }
    }
    draw_found(out);
  }

  /// Many units that were found visible together may hide each other: after a cut, that is, since
  /// else few appear at once. The nearer half is drawn and the rest asked about again, as long as
  /// that is likely to find some of them hidden.
  void draw_found(DrawSink& out) {
    std::size_t drawn = found_.size();
    if (reask_ && found_.size() >= many_found) {
      drawn = (found_.size() + 1) / 2;
      std::ranges::sort(found_, {}, [&](const Entry& entry) {
        return std::pair(walk_.nearness(entry.visit.node), entry.visit.node);
      });
    }
    for (std::size_t i = 0; i < found_.size(); ++i) {
      if (i < drawn || in_vain(found_[i].visit.node)) {
        ++units_found_visible_;
        take_as_visible(found_[i].visit, out);
        continue;
      }
      hidden_.add_again(found_[i]);
      ++reasked_;
    }
  }

  /// Of a node of which nothing is known: would a question cost more than it saves, if as many are
  /// hidden as have been found so far in this frame?
  bool in_vain(QueryHierarchy::NodeIndex node) const {
    if (!skip_vain_) return false;
    const std::uint64_t work = walk_.hierarchy().work(node);
    const std::uint64_t least =
        walk_.hierarchy().is_unit(node) ? query_triangles : walk_.hierarchy().leaf_triangles();
    return (found_hidden_ + 1) * work < (answer_count_ + 2) * least;
  }

  /// Asks about the visible units that are left, and reads what became of all.
  void finish_retests(DrawSink& out) {
    if (!due_.empty()) ask_due(out);
    for (const Retest& retest : retests_) {
      if (device_->samples(retest.query) > threshold_px_) {
        memory_.note_visible(walk_.hierarchy(), retest.node);
      } else {
        memory_.note_hidden(retest.node);
        hidden_work_ += walk_.hierarchy().work(retest.node);
      }
    }
  }

  CullerInfo info_;
  NodeWalk walk_;
  NodeBoxes boxes_of_;
  NodeMemory memory_;
  HiddenQueue hidden_;  // the I-queue
  std::size_t batch_;
  bool lazy_;
  std::uint32_t interval_;
  bool random_;
  std::optional<TightBounds::Limits> tight_;
  std::uint64_t threshold_px_;
  bool may_sleep_;
  bool reask_;
  bool open_unasked_;
  bool skip_vain_;
  std::uint64_t hand_over_triangles_;
  RenderDevice* device_ = nullptr;
  Random chance_{0};
  SleepPattern sleep_;

  // Of a call of cull().
  const Frame* frame_ = nullptr;
  bool blind_ = false;
  std::vector<Aabb> boxes_;
  std::vector<Entry> due_;    // the V-queue
  std::vector<Entry> found_;  // units that show
  std::vector<Retest> retests_;
  std::vector<HiddenQueue::Answer> answers_;
  std::uint64_t drawn_work_ = 0, hidden_work_ = 0;
  std::uint64_t units_new_ = 0;  // while asleep
  std::uint64_t units_drawn_now_ = 0;
  // Of a frame: as many as keep to the interval, or a batch, so that a burst of new units is spread
  // over frames.
  std::size_t most_retests_ = 0;
  std::uint64_t waiting_triangles_ = 0;  // drawn, but not handed over
  std::uint64_t answer_count_ = 0;       // about hidden nodes
  std::uint64_t found_hidden_ = 0;       // of these

  std::uint64_t reasked_ = 0;
  std::uint64_t retests_asked_ = 0;
  std::uint64_t opened_unasked_ = 0;
  std::uint64_t skipped_as_vain_ = 0;
  std::uint64_t frames_slept_ = 0;
  std::uint64_t units_drawn_ = 0;
  std::uint64_t units_found_visible_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry occlusion_chcpp() {
  return {occlusion_culling::chcpp_info(),
          [](const ParameterValues& values) { return std::make_unique<Chcpp>(values); }};
}

}  // namespace cullers
}  // namespace vislab
