// frustum.bvh over objects that stand still: against the plain loop over all boxes, against itself
// in other shapes, and how its time grows with the world.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "algorithms/all_cullers.h"
#include "algorithms/frustum/flat_boxes.h"
#include "common/geometry/random.h"
#include "common/spatial/wide_bvh.h"
#include "experiments/analysis/statistics.h"
#include "experiments/bench/frustum/cases.h"
#include "experiments/bench/frustum/culler_side.h"
#include "experiments/bench/frustum/workload.h"

namespace vislab {
namespace {

using frustum_culling::FlatBoxes;

/// All views, one after the other, in one call.
class ViewsContest : public Contest {
 public:
  explicit ViewsContest(std::shared_ptr<const FrustumWorkload> workload)
      : workload_(std::move(workload)) {}

  void ours() override {
    for (std::size_t view = 0; view < workload_->view_count(); ++view) run_ours(view);
  }
  void theirs() override {
    for (std::size_t view = 0; view < workload_->view_count(); ++view) run_theirs(view);
  }
  bool equal() override {
    for (std::size_t view = 0; view < workload_->view_count(); ++view) {
      run_ours(view);
      run_theirs(view);
      for (const std::vector<ObjectId>& answer : {our_answer(), their_answer()}) {
        if (!workload_->is_right(view, bits_of(answer, workload_->boxes().size()), 0.0)) {
          return false;
        }
      }
    }
    return true;
  }
  /// Millions of boxes.
  double work() const override {
    return static_cast<double>(workload_->boxes().size() * workload_->view_count()) * 1e-6;
  }

 protected:
  virtual void run_ours(std::size_t view) = 0;
  virtual void run_theirs(std::size_t view) = 0;
  /// Ids of the last run. Not timed.
  virtual std::vector<ObjectId> our_answer() const = 0;
  virtual std::vector<ObjectId> their_answer() const = 0;

  std::shared_ptr<const FrustumWorkload> workload_;
};

/// The hierarchy's spans, or their ids in one list, against the plain loop's bits, or its ids.
class SpansContest : public ViewsContest {
 public:
  SpansContest(std::shared_ptr<const FrustumWorkload> workload, bool ids)
      : ViewsContest(std::move(workload)), wants_ids_(ids), flat_(FlatBoxes::Order::ids) {
    bvh_.build(workload_->boxes(), WideBvh::Order::median);
    flat_.build(workload_->boxes());
    our_ids_.resize(workload_->boxes().size());
    their_ids_.resize(workload_->boxes().size());
  }

 protected:
  void run_ours(std::size_t view) override {
    bvh_.query(frustum(view), workload_->boxes(), {}, selection_);
    if (!wants_ids_) return;
    ObjectId* end = our_ids_.data();
    for (const std::span<const ObjectId> run : selection_.runs) {
      end = std::copy(run.begin(), run.end(), end);
    }
    our_count_ = static_cast<std::size_t>(end - our_ids_.data());
  }
  void run_theirs(std::size_t view) override {
    bits_ = flat_.cull(frustum(view), workload_->boxes());
    if (wants_ids_) {
      their_count_ = frustum_culling::select_ids(bits_, flat_.objects_by_slot(), their_ids_.data());
    }
  }
  std::vector<ObjectId> our_answer() const override {
    if (wants_ids_) return {our_ids_.data(), our_ids_.data() + our_count_};
    return joined(selection_.runs);
  }
  std::vector<ObjectId> their_answer() const override {
    std::vector<ObjectId> ids(workload_->boxes().size());
    ids.resize(frustum_culling::select_ids(bits_, flat_.objects_by_slot(), ids.data()));
    return ids;
  }

 private:
  Frustum frustum(std::size_t view) const { return frustum_of(workload_->frame(view).camera); }

  bool wants_ids_;
  WideBvh bvh_;
  WideSelection selection_;
  FlatBoxes flat_;
  std::span<const std::uint64_t> bits_;
  std::vector<ObjectId> our_ids_, their_ids_;
  std::size_t our_count_ = 0;
  std::size_t their_count_ = 0;
};

/// Two cullers of the registry.
class CullersContest : public ViewsContest {
 public:
  CullersContest(std::shared_ptr<const FrustumWorkload> workload, const std::string& ours,
                 const std::string& theirs)
      : ViewsContest(std::move(workload)),
        ours_(ours, workload_->scene()),
        theirs_(theirs, workload_->scene()) {}

 protected:
  void run_ours(std::size_t view) override { ours_.cull(workload_->frame(view)); }
  void run_theirs(std::size_t view) override { theirs_.cull(workload_->frame(view)); }
  std::vector<ObjectId> our_answer() const override { return joined(ours_.runs()); }
  std::vector<ObjectId> their_answer() const override { return joined(theirs_.runs()); }

 private:
  CullerSide ours_, theirs_;
};

/// Boxes in a world that grows with their number: the density stays, and so does what is in view.
struct GrowingWorld {
  static constexpr double boxes_per_m3 = 1e-3;
  static constexpr double far_m = 100.0;  // within the smallest world
  static constexpr std::size_t view_count = 16;

  explicit GrowingWorld(std::size_t count) {
    const double reach = 0.5 * std::cbrt(static_cast<double>(count) / boxes_per_m3);
    Random random(count);
    const auto vector = [&](double low, double high) {
      const double x = random.uniform(low, high);
      const double y = random.uniform(low, high);
      return glm::vec3(x, y, random.uniform(low, high));
    };
    for (std::size_t i = 0; i < count; ++i) {
      const glm::vec3 center = vector(-reach, reach);
      const glm::vec3 half = vector(0.2, 2.0);
      boxes.push_back({center - half, center + half});
    }
    bvh.build(boxes, WideBvh::Order::median);
    for (std::size_t i = 0; i < view_count; ++i) {
      const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / view_count;
      const glm::dvec3 target(std::cos(turn), 0.5 * std::sin(3.0 * turn), std::sin(turn));
      frusta.push_back(
          frustum_of({look_at({0.0, 0.0, 0.0}, target),
                      perspective_lens(std::numbers::pi / 3.0, 16.0 / 9.0, 0.3, far_m)}));
    }
  }

  double seconds(int repetitions) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < repetitions; ++i) {
      for (const Frustum& frustum : frusta) bvh.query(frustum, boxes, {}, selection);
    }
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    return elapsed.count() / repetitions;
  }

  bool is_right() {
    for (const Frustum& frustum : frusta) {
      bvh.query(frustum, boxes, {}, selection);
      std::vector<ObjectId> expected;
      for (ObjectId object = 0; object < boxes.size(); ++object) {
        const bool outside = std::ranges::any_of(frustum.span(), [&](const Plane& plane) {
          return surely_outside(plane, boxes[object]);
        });
        if (!outside) expected.push_back(object);
      }
      std::vector<ObjectId> answer = joined(selection.runs);
      std::ranges::sort(answer);
      if (answer != expected) return false;
    }
    return true;
  }

  std::vector<Aabb> boxes;
  std::vector<Frustum> frusta;
  WideBvh bvh;
  WideSelection selection;
};

/// The slope of log time over log number, by least squares through the medians of rounds in which
/// all sizes take turns.
Measurement growth_exponent() {
  constexpr int rounds = 15;
  constexpr int repetitions = 8;
  std::vector<std::unique_ptr<GrowingWorld>> worlds;
  for (const std::size_t count : {10'000, 31'623, 100'000, 316'228, 1'000'000}) {
    worlds.push_back(std::make_unique<GrowingWorld>(count));
  }
  Measurement result;
  result.equal = std::ranges::all_of(worlds, [](const auto& world) { return world->is_right(); });
  std::vector<std::vector<double>> times(worlds.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < worlds.size(); ++i) {
      times[i].push_back(worlds[i]->seconds(repetitions));
    }
  }
  double x_sum = 0.0, y_sum = 0.0, xx_sum = 0.0, xy_sum = 0.0;
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    const double x = std::log(static_cast<double>(worlds[i]->boxes.size()));
    const double y = std::log(median(times[i]));
    x_sum += x;
    y_sum += y;
    xx_sum += x * x;
    xy_sum += x * y;
  }
  const auto n = static_cast<double>(worlds.size());
  result.value = (n * xy_sum - x_sum * y_sum) / (n * xx_sum - x_sum * x_sum);
  return result;
}

}  // namespace

void add_bvh_cases(std::vector<BenchCase>& cases) {
  Registry registry;
  register_all_cullers(registry);
  // Cases of one size share their boxes as long as one of them is at hand.
  const auto shared = std::make_shared<std::map<std::size_t, std::weak_ptr<FrustumWorkload>>>();
  const auto workload = [shared](std::size_t count) {
    std::shared_ptr<FrustumWorkload> made = (*shared)[count].lock();
    if (!made) {
      made = std::make_shared<FrustumWorkload>(count);
      (*shared)[count] = made;
    }
    return made;
  };
  for (const std::size_t count : {10'000, 100'000, 1'000'000}) {
    const std::string boxes = std::to_string(count) + " boxes, ";
    for (const bool ids : {false, true}) {
      cases.push_back({"frustum.bvh", boxes + (ids ? "ids" : "spans"), "Mbox/s",
                       "frustum.flat[early_out=off]",
                       [=] { return std::make_unique<SpansContest>(workload(count), ids); }});
    }
    const auto add = [&](const std::string& ours, const std::string& theirs) {
      cases.push_back({ours, boxes + "culler", "Mbox/s", theirs, [=] {
                         return std::make_unique<CullersContest>(workload(count), ours, theirs);
                       }});
    };
    add("frustum.bvh", "frustum.flat[early_out=off]");
    add("frustum.bvh", "frustum.flat");
    if (registry.entries().contains("peer.bullet")) add("frustum.bvh", "peer.bullet");
    add("frustum.bvh[masking=false]", "frustum.bvh");
    add("frustum.bvh[layout=binary]", "frustum.bvh");
    for (const char* build : {"top_down", "bottom_up", "incremental"}) {
      // Inserting a million objects one after another takes a minute.
      if (count == 1'000'000 && std::string(build) == "incremental") continue;
      add(std::string("frustum.bvh[build=") + build + "]", "frustum.bvh");
    }
  }
  cases.push_back({"frustum.bvh", "growth at constant density, 10000 to 1000000 boxes", "exponent",
                   "", nullptr, growth_exponent});
}

}  // namespace vislab
