#include "experiments/contract/contract.h"

#include <optional>

#include "common/judge/image_judge.h"
#include "common/judge/region_truth.h"
#include "common/render/osmesa_device.h"
#include "common/scene/error.h"
#include "experiments/contract/contract_sink.h"
#include "experiments/contract/declaration.h"
#include "experiments/contract/offer.h"
#include "experiments/contract/scenario.h"

namespace vislab {
namespace {

/// The rules and the first breach of each.
class Findings {
 public:
  enum Rule { info, parameters, needs, emission, repeats, guarantee, allocation };

  Findings()
      : results_{{"its info is complete", true, ""},
                 {"it refuses wrong parameters", true, ""},
                 {"it says what it needs", true, ""},
                 {"it emits only what it is offered, each triangle once", true, ""},
                 {"its answers come again as declared", true, ""},
                 {"its guarantee holds on every small scene", true, ""},
                 {"it allocates nothing on the second pass", true, ""}} {}

  /// Nothing happens for an empty message.
  void report(Rule rule, const std::string& where, const std::string& message) {
    if (message.empty() || !results_[rule].passed) return;
    results_[rule].passed = false;
    results_[rule].message = where.empty() ? message : where + ": " + message;
  }
  std::vector<ContractResult> results() && { return std::move(results_); }

 private:
  std::vector<ContractResult> results_;
};

/// A culler at work in a scenario.
class Subject {
 public:
  Subject(const Registry& registry, const std::string& spec, const Scenario& scenario,
          RenderDevice* device, int threads)
      : scenario_(&scenario), device_(device), culler_(registry.make(spec)) {
    BuildContext context;
    context.cullers = &registry;
    if (culler_->info().needs_truth) context.truth = &scenario.truth();
    context.device = device;
    context.threads = threads;
    culler_->build(scenario.scene(), context);
  }

  const CullerInfo& info() const { return culler_->info(); }
  Counters counters() const { return culler_->counters(); }

  void reset() {
    culler_->reset(1);
    at_.reset();
  }

  void go_to(std::size_t index) {
    const Frame frame = scenario_->frame(index);
    const Changes changes =
        at_ ? scenario_->changes(*at_, index) : scenario_->changes_from_start(index);
    at_ = index;
    if (device_ != nullptr) device_->begin_frame(frame);
    const AllocationCounter counter;
    culler_->update(frame, changes);
    allocations_ += counter.count();
  }

  /// What it keeps of the offers, which are batches of one frame. `fault` says what it did wrong.
  VisibleSet ask(const std::vector<OfferKind>& batches, std::string& fault) {
    const Frame frame = scenario_->frame(*at_);
    if (device_ != nullptr) device_->begin_frame(frame);
    VisibleSet all;
    for (const OfferKind kind : batches) {
      const Offer offer(kind, scenario_->scene(), frame);
      const VisibleSet kept = ask(offer, frame, fault);
      if (!without(kept, offer.set()).runs().empty() && fault.empty()) {
        fault = "it emitted a triangle that it was not offered";
      }
      if (!fault.empty()) {
        fault += " (offered " + std::string(to_string(kind)) + ")";
        break;
      }
      all = united(all, kept);
    }
    return all;
  }

  /// The set of a cell; none if the culler has none.
  std::optional<std::vector<ObjectId>> set_of(CellId cell) {
    return region_set(*culler_, cell, scenario_->scene());
  }

  /// Objects whose backs the device left out on the culler's behalf, of the last ask.
  std::span<const ObjectId> one_sided() const {
    return device_ == nullptr ? std::span<const ObjectId>{} : device_->one_sided();
  }

  std::uint64_t allocations() const { return allocations_; }
  void forget_allocations() { allocations_ = 0; }

 private:
  VisibleSet ask(const Offer& offer, const Frame& frame, std::string& fault) {
    sink_.start(scenario_->scene(), frame, offer.candidates(), device_);
    {
      const AllocationCounter counter;
      culler_->cull(frame, offer.candidates(), sink_);
      allocations_ += counter.count();
    }
    std::vector<VisibleSet::Run> runs;
    for (const TriangleRange& range : sink_.finish()) {
      runs.push_back({scenario_->scene().first_triangle(range.object) + range.first, range.count});
    }
    fault = sink_.fault();
    try {
      return VisibleSet(std::move(runs));
    } catch (const std::logic_error& error) {
      if (fault.empty()) fault = error.what();
      return {};
    }
  }

  const Scenario* scenario_;
  RenderDevice* device_;
  std::unique_ptr<ICuller> culler_;
  std::optional<std::size_t> at_;
  ContractSink sink_;
  std::uint64_t allocations_ = 0;
};

/// Says whether a set keeps a guarantee.
class GuaranteeJudge {
 public:
  GuaranteeJudge(Scenario& scenario, const CullerInfo& info)
      : scenario_(&scenario), guarantee_(info.guarantee), granularity_(info.granularity) {
    if (guarantee_ == Guarantee::image_exact) image_.emplace(scenario.scene());
  }

  /// How `kept`, chosen from `offered` and drawn without the backs of `one_sided` objects, breaks
  /// the guarantee; empty if it does not. What was not offered counts as kept: the culler cannot be
  /// blamed for it.
  std::string breach(std::size_t index, const VisibleSet& offered, const VisibleSet& kept,
                     std::span<const ObjectId> one_sided) {
    const Frame frame = scenario_->frame(index);
    const Offer all(OfferKind::everything, scenario_->scene(), frame);
    const VisibleSet drawn = united(kept, without(all.set(), offered));
    if (guarantee_ == Guarantee::conservative) return lost(frame, drawn);
    if (guarantee_ == Guarantee::image_exact) return changed(frame, drawn, one_sided);
    return {};
  }

  bool promises() const {
    return guarantee_ == Guarantee::conservative || guarantee_ == Guarantee::image_exact;
  }

  /// The first wrong pixel of an answer, as breach() takes it; `title` heads its picture.
  std::optional<Witness> witness(std::size_t index, const VisibleSet& offered,
                                 const VisibleSet& kept, std::span<const ObjectId> one_sided,
                                 const std::string& title) {
    const Frame frame = scenario_->frame(index);
    const Offer all(OfferKind::everything, scenario_->scene(), frame);
    const VisibleSet drawn = united(kept, without(all.set(), offered));
    if (!promises() && lost(frame, drawn).empty()) return std::nullopt;
    const SeenBy judge = guarantee_ == Guarantee::image_exact ? SeenBy::device : SeenBy::rays;
    return find_witness(*scenario_, index, drawn, one_sided, judge, title);
  }

 private:
  std::string lost(const Frame& frame, const VisibleSet& drawn) {
    const FrameTruth& truth = scenario_->truth().frame(frame.index);
    const Verdict verdict = judge_set(frame, truth, drawn, granularity_, scenario_->caster());
    if (verdict.false_px + verdict.false_jittered + verdict.false_objects +
            verdict.false_triangles ==
        0) {
      return {};
    }
    return "visible things are left out: " + std::to_string(verdict.false_objects) + " objects, " +
           std::to_string(verdict.false_triangles) + " triangles, " +
           std::to_string(verdict.false_px) + " pixel centres, " +
           std::to_string(verdict.false_jittered) + " of " + std::to_string(verdict.jittered) +
           " jittered samples";
  }

  std::string changed(const Frame& frame, const VisibleSet& drawn,
                      std::span<const ObjectId> one_sided) {
    if (started_ != frame.index) {
      image_->start(frame, scenario_->truth().frame(frame.index));
      started_ = frame.index;
    }
    const ImageVerdict verdict = image_->judge(frame, drawn, one_sided);
    if (verdict.image_px == 0) return {};
    return std::to_string(verdict.image_px) +
           " pixels of the image are not those of the full scene";
  }

  Scenario* scenario_;
  Guarantee guarantee_;
  Granularity granularity_;
  std::optional<ImageJudge> image_;
  std::optional<std::uint64_t> started_;
};

/// Walks a culler through a scenario in every way that the contract speaks of.
class Walks {
 public:
  Walks(const Registry& registry, const std::string& spec, Scenario& scenario, RenderDevice* device,
        Findings& findings, std::optional<Witness>* witness)
      : scenario_(&scenario),
        findings_(&findings),
        witness_(witness),
        title_(registry.short_name(spec)),
        subject_(registry, spec, scenario, device, 1),
        other_(registry, spec, scenario, device, 2),
        judge_(scenario, subject_.info()) {}

  void run() {
    using enum OfferKind;
    const Repeatability repeatability = subject_.info().repeatability;
    const std::vector<VisibleSet> first = there_and_again({everything});
    if (repeatability != Repeatability::timing) two_threads(first);
    if (repeatability == Repeatability::stateless) backwards(first);
    there_and_again({objects});
    there_and_again({even_objects, odd_objects});
    if (subject_.info().granularity == Granularity::triangle) there_and_again({ranges});
    sets_of_cells();
  }

 private:
  std::string where(std::size_t index) const {
    return "scene '" + scenario_->name() + "', frame " + std::to_string(index);
  }

  VisibleSet asked(Subject& subject, std::size_t index, const std::vector<OfferKind>& batches) {
    std::string fault;
    VisibleSet kept = subject.ask(batches, fault);
    findings_->report(Findings::emission, where(index), fault);
    return kept;
  }

  void compare(std::size_t index, const VisibleSet& expected, const VisibleSet& kept,
               const std::string& when) {
    if (expected == kept) return;
    findings_->report(Findings::repeats, where(index),
                      when + " it kept " + std::to_string(kept.triangle_count()) +
                          " triangles, not the " + std::to_string(expected.triangle_count()) +
                          " from before");
  }

  VisibleSet offered(std::size_t index, const std::vector<OfferKind>& batches) const {
    VisibleSet all;
    for (const OfferKind kind : batches) {
      all = united(all, Offer(kind, scenario_->scene(), scenario_->frame(index)).set());
    }
    return all;
  }

  /// The path twice, each time after a reset. Returns the sets of the first time.
  std::vector<VisibleSet> there_and_again(const std::vector<OfferKind>& batches) {
    std::vector<VisibleSet> sets;
    subject_.reset();
    for (std::size_t i = 0; i < scenario_->frame_count(); ++i) {
      subject_.go_to(i);
      sets.push_back(asked(subject_, i, batches));
      const VisibleSet offer = offered(i, batches);
      const std::string breach = judge_.breach(i, offer, sets.back(), subject_.one_sided());
      findings_->report(Findings::guarantee, where(i), breach);
      // Of what promises nothing, only answers to everything are looked at: one is enough.
      const bool of_interest =
          judge_.promises() ? !breach.empty() : batches.front() == OfferKind::everything;
      if (witness_ != nullptr && !witness_->has_value() && of_interest) {
        *witness_ = judge_.witness(i, offer, sets.back(), subject_.one_sided(), title_);
      }
    }
    subject_.reset();
    for (std::size_t i = 0; i < scenario_->frame_count(); ++i) {
      subject_.forget_allocations();
      subject_.go_to(i);
      const VisibleSet again = asked(subject_, i, batches);
      if (subject_.info().repeatability != Repeatability::timing) {
        compare(i, sets[i], again, "on the second pass");
      }
      if (subject_.allocations() > 0) {
        findings_->report(Findings::allocation, where(i),
                          std::to_string(subject_.allocations()) +
                              " allocations in update() and cull() (offered " +
                              std::string(to_string(batches.front())) + ")");
      }
    }
    return sets;
  }

  /// Another culler with two threads: the same sets, and twice over the path the same counters.
  void two_threads(const std::vector<VisibleSet>& expected) {
    for (int pass = 0; pass < 2; ++pass) {
      other_.reset();
      for (std::size_t i = 0; i < scenario_->frame_count(); ++i) {
        other_.go_to(i);
        compare(i, expected[i], asked(other_, i, {OfferKind::everything}), "with two threads");
      }
    }
    if (subject_.counters() != other_.counters()) {
      findings_->report(Findings::repeats, "scene '" + scenario_->name() + "'",
                        "the counters differ between one thread and two");
    }
  }

  /// From the last frame to the first, each asked twice, without a reset.
  void backwards(const std::vector<VisibleSet>& expected) {
    for (std::size_t i = scenario_->frame_count(); i-- > 0;) {
      subject_.go_to(i);
      compare(i, expected[i], asked(subject_, i, {OfferKind::everything}), "after other frames");
      compare(i, expected[i], asked(subject_, i, {OfferKind::everything}), "asked twice");
    }
  }

  /// Of methods that have a set for each cell: the same when it is asked again and with two
  /// threads, and it holds what rays from all over the cell hit.
  void sets_of_cells() {
    const Scene& scene = scenario_->scene();
    if (scene.cells.empty()) return;
    subject_.reset();
    other_.reset();
    if (!subject_.set_of(0)) return;
    std::vector<std::vector<ObjectId>> sets;
    for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
      const auto set = subject_.set_of(cell);
      if (set != subject_.set_of(cell) || set != other_.set_of(cell)) {
        findings_->report(Findings::repeats, where_cell(cell),
                          "its set is another when it is asked again, or with two threads");
      }
      sets.push_back(set.value_or(std::vector<ObjectId>()));
    }
    const auto none_such = static_cast<CellId>(scene.cells.size());
    if (subject_.set_of(none_such)) {
      findings_->report(Findings::emission, where_cell(none_such),
                        "there is no such cell, but it gives a set for it");
    }
    if (subject_.info().guarantee != Guarantee::conservative) return;
    RegionJudge judge(scene, {});
    const RegionVerdict verdict =
        judge.judge(judge.trace(reachable_cells(scene)), [&](CellId cell) { return sets[cell]; });
    if (verdict.misses == 0) return;
    findings_->report(Findings::guarantee, where_cell(verdict.witnesses.front().cell),
                      std::to_string(verdict.misses) + " of " + std::to_string(verdict.rays) +
                          " rays from all over the cells hit what their sets lack");
  }

  std::string where_cell(CellId cell) const {
    return "scene '" + scenario_->name() + "', cell " + std::to_string(cell);
  }

  Scenario* scenario_;
  Findings* findings_;
  std::optional<Witness>* witness_;  // null: nobody asks
  std::string title_;
  Subject subject_;
  Subject other_;
  GuaranteeJudge judge_;
};

/// "" if building without what the culler declares to need throws InputError.
std::string unstated_need(const Registry& registry, const std::string& spec,
                          const Scenario& scenario, RenderDevice* device) {
  const CullerInfo info = registry.make(spec)->info();
  const auto refused = [&](const BuildContext& context) {
    try {
      registry.make(spec)->build(scenario.scene(), context);
    } catch (const InputError&) {
      return true;
    }
    return false;
  };
  BuildContext context;
  context.cullers = &registry;
  context.truth = info.needs_truth ? &scenario.truth() : nullptr;
  context.device = info.needs_device ? device : nullptr;
  if (refused(context)) return "it needs more than it declares";
  if (info.needs_truth) {
    context.truth = nullptr;
    if (!refused(context)) return "it declares to need truth, but does not refuse without";
    context.truth = &scenario.truth();
  }
  if (info.needs_device) {
    context.device = nullptr;
    if (!refused(context)) return "it declares to need a device, but does not refuse without";
  }
  return {};
}

}  // namespace

std::vector<ContractResult> check_contract(const Registry& registry, const std::string& spec,
                                           std::optional<Witness>* witness) {
  const bool needs_device = registry.make(spec)->info().needs_device;
  Findings findings;
  findings.report(Findings::info, "", incomplete_info(registry, spec));
  findings.report(Findings::parameters, "", accepted_nonsense(registry, spec));

  std::optional<OsMesaDevice> mesa;
  std::optional<UncountedDevice> device;
  if (needs_device) device.emplace(mesa.emplace());
  RenderDevice* const used = device ? &*device : nullptr;
  bool first = true;
  for (SmallScene& small : small_scenes()) {
    Scenario scenario(std::move(small));
    if (used != nullptr) used->load(scenario.scene());
    try {
      if (first)
        findings.report(Findings::needs, "", unstated_need(registry, spec, scenario, used));
      first = false;
      Walks(registry, spec, scenario, used, findings, witness).run();
    } catch (const std::exception& error) {
      findings.report(Findings::emission, "scene '" + scenario.name() + "'",
                      std::string("it threw: ") + error.what());
    }
  }
  return std::move(findings).results();
}

}  // namespace vislab
