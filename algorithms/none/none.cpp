// none: keeps everything. The lower anchor of every chart: what culling costs when there is none.
//
// Idea: every candidate is passed on as it came.
// Guarantee: conservative, trivially.
// Cost: O(1) for the whole scene, O(runs) for a part of it; no id is touched.
// Limits: saves nothing.
// Source: the trivial potentially visible set, PVS = A (Zachmann, Computer-Graphik 2, slides 3-5).

#include "common/culler/registry.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "none";
  info.family = "none";
  info.summary = "Keeps every candidate: the lower anchor of every chart.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.cost = "O(1) for the whole scene, O(runs of candidates) for a part of it";
  info.limits = "Saves nothing.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 3-5 (the trivial PVS)"};
  return info;
}

class None : public ICuller {
 public:
  const CullerInfo& info() const override { return info_; }
  void build(const Scene&, const BuildContext&) override {}

  void cull(const Frame&, const Candidates& candidates, DrawSink& out) override {
    if (candidates.form() == Candidates::Form::everything) {
      out.everything();
    } else {
      for (const std::span<const ObjectId> run : candidates.object_runs()) out.objects(run);
    }
  }

 private:
  CullerInfo info_ = describe();
};

}  // namespace

namespace cullers {

CullerEntry none() {
  return {describe(), [](const ParameterValues&) { return std::make_unique<None>(); }};
}

}  // namespace cullers
}  // namespace vislab
