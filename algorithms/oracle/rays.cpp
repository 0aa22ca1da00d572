// oracle.rays: keeps what other rays than the truth's find visible. The truth itself on trial.
//
// Idea: an oracle that is told not the truth but what rays of other number, place or tracer tell,
//   so that what depends on these can be judged like a method: too few rays lose what is small,
//   rays through vertices slip through closed walls, an edge belongs to two triangles.
// Guarantee: approximate; the error is the subject.
// Cost: about 0.3 microseconds a ray, paid once for each frame of a path, in update().
// Limits: cannot be had outside of the lab; knows only the path for which truth was prepared. Its
//   times say nothing.
// Source: Embree's issues 181, 188 and 423; Wonka et al. 2006, "Guided visibility sampling", on
//   undersampling.
#include "common/culler/ray_probe.h"
#include "common/culler/registry.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "oracle.rays";
  info.family = "oracle";
  info.summary =
      "Keeps what rays find visible that are fewer, aimed elsewhere or traced otherwise than those "
      "of the truth: how far the truth depends on its rays.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.needs_truth = true;
  const auto build = ParameterSpec::Stage::build;
  info.parameters = {
      ParameterSpec::choice("level", "object", {"object", "triangle"}, build,
                            "keeps the objects or only the triangles that a ray meets"),
      ParameterSpec::choice("aim", "jittered", {"jittered", "lattice"}, build,
                            "spreads rays at random over every pixel, or puts one at the same "
                            "place of every square of pixels"),
      ParameterSpec::integer("samples", 16, 1, 4096, "rays/pixel", build,
                             "aim=jittered: fewer rays lose more of what is small"),
      ParameterSpec::integer("every_px", 1, 1, 4096, "pixels", build,
                             "aim=lattice: one ray for a square of this edge; a larger one loses "
                             "what lies between rays"),
      ParameterSpec::real("offset_x_px", 0.5, 0.0, 4096.0, "pixels", build,
                          "aim=lattice: of the ray from the left border of its square, at most "
                          "every_px; where edges or vertices lie on rays, these may slip through"),
      ParameterSpec::real("offset_y_px", 0.5, 0.0, 4096.0, "pixels", build,
                          "aim=lattice: the same from the lower border"),
      ParameterSpec::choice("nearest", "first", {"first", "all"}, build,
                            "of several triangles at the least depth, as on an edge, the tracer "
                            "names one, or all are kept"),
      ParameterSpec::boolean("robust", true, build,
                             "the tracer's watertight test of triangles; off, rays slip through "
                             "edges"),
      ParameterSpec::choice("instructions", "truth", {"truth", "sse2", "avx", "avx2"}, build,
                            "the instruction set that the tracer runs on: another rounds hits at "
                            "edges otherwise")};
  info.cost = "O(1) beside what is kept, once the frame's rays are traced: rays · log(triangles)";
  info.limits =
      "Loses what lies between its rays, and keeps what is seen through the tracer's leaks; knows "
      "only the path whose truth was prepared.";
  info.sources = {"Embree issues 181, 188, 423",
                  "Wonka et al. 2006, Guided visibility sampling (abstract)"};
  return info;
}

class RayOracle : public ICuller {
 public:
  explicit RayOracle(const ParameterValues& values) : level_(values.choice("level")) {
    info_ = describe();
    if (level_ == "triangle") info_.granularity = Granularity::triangle;
    sampling_.aim =
        values.choice("aim") == "lattice" ? RaySampling::Aim::lattice : RaySampling::Aim::jittered;
    sampling_.samples = static_cast<int>(values.integer("samples"));
    sampling_.every_px = static_cast<int>(values.integer("every_px"));
    sampling_.offset_x_px = values.real("offset_x_px");
    sampling_.offset_y_px = values.real("offset_y_px");
    sampling_.every_nearest = values.choice("nearest") == "all";
    sampling_.robust = values.boolean("robust");
    const std::string& instructions = values.choice("instructions");
    sampling_.instruction_set = instructions == "truth" ? "" : instructions;
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    const auto* truth = dynamic_cast<const ProbingTruth*>(context.truth);
    if (truth == nullptr || context.cullers == nullptr) {
      throw InputError(
          "oracle.rays: there is no truth that casts rays; it needs a run that prepares truth");
    }
    probe_ = truth->probe(sampling_);
    BuildContext told = context;
    told.truth = probe_.get();
    oracle_ = context.cullers->make("oracle[level=" + level_ + "]");
    oracle_->build(scene, told);
  }

  void reset(std::uint64_t seed) override { oracle_->reset(seed); }

  void update(const Frame& frame, const Changes& changes) override {
    const RayFindings& found = probe_->look(frame);
    sum_.rays += found.rays;
    sum_.hits += found.hits;
    sum_.triangles += found.triangles;
    sum_.seen_once += found.seen_once;
    sum_.ties += found.ties;
    sum_.other += found.other;
    // Good and Turing: the share of the hits that would fall on triangles not yet seen.
    if (found.hits > 0) unseen_ppm_ += found.seen_once * 1'000'000 / found.hits;
    oracle_->update(frame, changes);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    oracle_->cull(frame, candidates, out);
  }

  std::size_t bytes() const override { return oracle_ ? oracle_->bytes() : 0; }

  Counters counters() const override {
    return {{"rays", sum_.rays},
            {"ray_hits", sum_.hits},
            {"seen", sum_.triangles},
            {"seen_once", sum_.seen_once},
            {"unseen_ppm", unseen_ppm_},
            {"ties", sum_.ties},
            {"named_otherwise", sum_.other}};
  }

 private:
  CullerInfo info_;
  std::string level_;
  RaySampling sampling_;
  std::unique_ptr<RayProbe> probe_;
  std::unique_ptr<ICuller> oracle_;  // is told what the probe finds
  RayFindings sum_;                  // over all frames
  std::uint64_t unseen_ppm_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry oracle_rays() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            return std::make_unique<RayOracle>(values);
          }};
}

}  // namespace cullers
}  // namespace vislab
