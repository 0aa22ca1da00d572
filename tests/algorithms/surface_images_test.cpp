#include <gtest/gtest.h>

#include <map>

#include "common/judge/surface_judge.h"
#include "common/scene/error.h"
#include "common/scene/generators/surfaces.h"
#include "experiments/contract/scenario.h"
#include "run_culler.h"

namespace vislab {
namespace {

/// A method at work in a scenario.
class Painted {
 public:
  Painted(const std::string& spec, const Scenario& scenario)
      : scenario_(&scenario), run_(spec, scenario.scene()) {}

  /// Of a frame; the image stays until the next.
  SurfaceVerdict judge(std::size_t index) {
    const Frame frame = scenario_->frame(index);
    sink_.start(scenario_->scene(), frame);
    run_.culler().cull(frame, Candidates::everything(), sink_);
    return judge_surface(frame, scenario_->scene(), scenario_->truth().frame(index), image());
  }
  /// Sum over all frames.
  SurfaceVerdict judge_all() {
    SurfaceVerdict sum;
    for (std::size_t i = 0; i < scenario_->frame_count(); ++i) {
      const SurfaceVerdict one = judge(i);
      sum.surface_px += one.surface_px;
      sum.disputed_surface_px += one.disputed_surface_px;
    }
    return sum;
  }
  std::span<const TriangleId> image() { return run_.culler().surface_image(); }
  std::uint64_t counter(std::string_view name) const { return run_.counter(name); }
  const RecordingSink& sink() const { return sink_; }

 private:
  const Scenario* scenario_;
  CullerRun run_;
  RecordingSink sink_;
};

const std::vector<std::string>& exact_methods() {
  static const std::vector<std::string> specs = {"surface.zbuffer",
                                                 "surface.zbuffer[convention=reversed]",
                                                 "surface.zbuffer[bits=float,convention=reversed]",
                                                 "surface.bsp",
                                                 "surface.bsp[order=front_to_back]",
                                                 "surface.bsp[splitter=first]"};
  return specs;
}

TEST(SurfaceImages, OfExactMethodsAreTruthsOnEverySmallScene) {
  for (SmallScene& small : small_scenes()) {
    const Scenario scenario(std::move(small));
    for (const std::string& spec : exact_methods()) {
      Painted painted(spec, scenario);
      for (std::size_t i = 0; i < scenario.frame_count(); ++i) {
        const SurfaceVerdict verdict = painted.judge(i);
        EXPECT_EQ(verdict.surface_px, 0U) << spec << ", " << scenario.name() << ", frame " << i
                                          << ", disputed " << verdict.disputed_surface_px;
      }
    }
    for (const std::string spec :
         {"surface.zbuffer[bits=16]", "surface.zbuffer[bits=24]", "surface.zbuffer[bits=float]",
          "surface.span_buffer", "surface.span_buffer[compare_at=left_end]"}) {
      Painted painted(spec, scenario);
      const SurfaceVerdict verdict = painted.judge_all();
      std::cout << scenario.name() << ": " << spec << " " << verdict.surface_px << " wrong, "
                << verdict.disputed_surface_px << " disputed\n";
    }
  }
}

}  // namespace
}  // namespace vislab
