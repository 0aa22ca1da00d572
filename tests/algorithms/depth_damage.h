// Runs a culler through a short play and holds what it kept to truth and to the device's image.
// Test-only.
#pragma once

#include <vector>

#include "common/judge/image_judge.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {

/// A scene and what happens in it.
struct Play {
  struct Step {
    Camera camera;
    Changes changes;
  };
  Scene scene;
  std::vector<Step> steps;
};

/// What a culler did in all steps together.
struct Damage {
  std::uint64_t false_px = 0;  // undisputed pixel centres that lost what is seen there
  std::uint64_t image_px = 0;  // undisputed pixels of the device's image that changed
  std::uint64_t kept = 0, visible = 0, offered = 0;  // objects
};

/// `image`: whether the device's image is compared too, which takes most of the time.
inline Damage damage(const std::string& spec, const Play& play, const Viewport& viewport,
                     bool image = false) {
  CullerRun run(spec, play.scene);
  TruthSettings settings;
  settings.jitter_per_pixel = 1;
  RayCaster caster(play.scene, settings);
  std::optional<ImageJudge> judge;
  if (image) judge.emplace(play.scene);
  RecordingSink sink;
  Damage sum;
  std::uint64_t index = 0;
  for (const Play::Step& step : play.steps) {
    run.update(step.camera, step.changes);
    Frame frame = run.frame(step.camera, viewport);
    frame.index = index++;
    sink.start(play.scene, frame);
    run.culler().cull(frame, Candidates::everything(), sink);
    const FrameTruth truth = caster.trace(frame);
    const Verdict verdict = judge_set(frame, truth, sink.set(), Granularity::object, caster);
    sum.false_px += verdict.false_px;
    sum.kept += verdict.kept_objects;
    sum.visible += verdict.visible_objects;
    sum.offered += verdict.scene_objects;
    if (image) {
      judge->start(frame, truth);
      sum.image_px += judge->judge(frame, sink.set()).image_px;
    }
  }
  return sum;
}

}  // namespace vislab
