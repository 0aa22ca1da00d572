// What it costs to be exact: the time to decide about 100,000 objects, against the printed
// estimate from the same spheres.
#include "common/scene/generators/swarm.h"
#include "experiments/bench/detail/cases.h"
#include "experiments/bench/detail/workload.h"

namespace vislab {
namespace {

constexpr Viewport viewport{512, 512};

class AreaContest : public Contest {
 public:
  AreaContest(const std::string& ours, const std::string& theirs)
      : scene_(swarm()), state_(scene_), ours_(ours, scene_), theirs_(theirs, scene_) {}

  void ours() override { ours_.cull(frame()); }
  void theirs() override { theirs_.cull(frame()); }
  /// They measure differently and need not agree; both must have had something to decide.
  bool equal() override { return decided(ours_) && decided(theirs_); }
  double work() const override { return static_cast<double>(scene_.object_count()) * 1e-6; }

 private:
  bool decided(const DetailSide& side) const {
    return !side.kept().empty() && side.kept().size() < scene_.object_count();
  }
  static Scene swarm() {
    SwarmParameters parameters;
    parameters.count = 100'000;
    Scene scene = make_swarm(parameters);
    scene.finish();
    return scene;
  }
  Frame frame() const {
    const Camera camera{look_at({0.0, 0.0, 20.0}, {0.0, 0.0, 0.0}),
                        perspective_lens(1.0, 1.0, 0.1, 100.0)};
    return {0, camera, viewport, state_.view(), 0.0};
  }

  Scene scene_;
  SceneState state_;
  DetailSide ours_, theirs_;
};

}  // namespace

void add_time_cases(std::vector<BenchCase>& cases) {
  // The printed area of an object in the middle of this swarm is half a pixel.
  const std::string printed = "detail.wrong[error=printed_formula,threshold_px=0.5]";
  for (const std::string area : {"sphere", "box"}) {
    const std::string culler = "detail.screen_size[threshold_px=0.5,area=" + area + "]";
    cases.push_back({culler, "100,000 objects, half of them at the threshold", "Mobject/s", printed,
                     [=] { return std::make_unique<AreaContest>(culler, printed); }});
  }
}

}  // namespace vislab
