#include "experiments/bench/occlusion/tour.h"

#include "algorithms/all_cullers.h"
#include "common/judge/truth.h"
#include "common/scene/library.h"

namespace vislab {
namespace {

DataFolders data_folders() {
  const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  return {data, data / "cache"};
}

}  // namespace

Tour::Tour(const std::string& scene, const std::string& path)
    : scene_(load_scene(scene, data_folders()).scene),
      path_(load_path(path, scene_, size, 0, data_folders())),
      state_(scene_),
      judge_(scene_) {
  register_all_cullers(registry_);
  device_.load(scene_);
  TruthSettings settings;
  settings.jitter_per_pixel = 4;
  RayCaster caster(scene_, settings);
  truth_ = std::make_unique<PathTruth>(trace_path(path_, size, settings, caster, nullptr));
}

PathRun Tour::walk(const std::string& spec) {
  std::unique_ptr<ICuller>& culler = cullers_[spec];
  if (culler == nullptr) {
    culler = registry_.make(spec);
    BuildContext context;
    context.cullers = &registry_;
    context.truth = truth_.get();
    context.device = &device_;
    culler->build(scene_, context);
  }
  return run_path(*culler, scene_, path_, size, 1, state_, &device_);
}

bool Tour::right(const PathRun& run) {
  bool right = true;
  for_each_frame(path_, state_, size, [&](std::size_t index, const Frame& frame, const Changes&) {
    judge_.start(frame, truth_->frame(index));
    right = right && judge_.judge(frame, run.sets[index]).image_px == 0;
  });
  return right;
}

}  // namespace vislab
