// Does the modelled device that is fitted to OSMesa say what OSMesa takes? Frames of scenes that
// were not in the fit, drawn by several methods: predicted beside measured.
//
// Predicted is the clock of modelled[preset=osmesa], and the method's own time (update_us +
// cull_us), which no device models; both of walks on the modelled device. Measured is frame_ms on
// OSMesa.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "algorithms/all_cullers.h"
#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "common/scene/library.h"
#include "experiments/analysis/statistics.h"
#include "experiments/bench/occlusion/cases.h"
#include "experiments/calibration/device_fit.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

constexpr Viewport size{512, 512};
constexpr int frames = 16;
constexpr int rounds = 5;

constexpr const char* scenes[] = {"city", "plant", "oa_dm2", "apartment"};
constexpr const char* methods[] = {"none",
                                   "frustum.bvh",
                                   "frustum.bvh > occlusion.stop_and_wait",
                                   "frustum.bvh > occlusion.batched",
                                   "frustum.bvh > occlusion.chc_flat",
                                   "occlusion.chc",
                                   "occlusion.chcpp"};

/// One method on one scene.
struct Predicted {
  SampleGrid measured_ms, predicted_ms;

  double measured_median_ms() const { return median_of_frames(measured_ms).value; }
  double predicted_median_ms() const { return median_of_frames(predicted_ms).value; }
  double ratio() const { return predicted_median_ms() / measured_median_ms(); }
  /// |predicted - measured| ÷ measured, in %, of each frame's median over the walks.
  std::vector<double> errors_of_frames() const {
    std::vector<double> errors;
    for (std::size_t f = 0; f < measured_ms.front().size(); ++f) {
      errors.push_back(error(median_of_walks(predicted_ms, f) / median_of_walks(measured_ms, f)));
    }
    return errors;
  }

  static double error(double ratio) { return 100.0 * std::abs(ratio - 1.0); }

 private:
  static double median_of_walks(const SampleGrid& grid, std::size_t frame) {
    std::vector<double> samples;
    for (const RoundSamples& walk : grid) samples.push_back(walk[frame]);
    return median(std::move(samples));
  }
};

/// How many threads Mesa draws with beside the calling one, if nothing else is said.
int drawing_threads() {
  if (const char* const told = std::getenv("LP_NUM_THREADS")) return std::atoi(told);
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  return cores > 1 ? cores : 0;
}

const GpuModel& fitted_model() {
  static const GpuModel model = fit_device(drawing_threads()).model;
  return model;
}

const Registry& registry() {
  static const Registry all = [] {
    Registry made;
    register_all_cullers(made);
    return made;
  }();
  return all;
}

/// A method with a device of its own for it.
class Walker {
 public:
  Walker(const char* method, const Scene& scene, TimedDevice& device)
      : culler_(registry().make(method)), scene_(scene), device_(device) {
    BuildContext context;
    context.cullers = &registry();
    context.device = &device;
    culler_->build(scene, context);
  }
  Round walk(const Path& path, SceneState& state) {
    return run_path(*culler_, scene_, path, size, 1, state, &device_).round;
  }

 private:
  std::unique_ptr<ICuller> culler_;
  const Scene& scene_;
  TimedDevice& device_;
};

std::vector<Predicted> predict_scene(const char* name) {
  const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  const LoadedScene loaded = load_scene(name, {data, data / "cache"});
  const Scene& scene = loaded.scene;
  const Path path = load_path(loaded.default_path, scene, size, frames, {data, data / "cache"});
  SceneState state(scene);
  OsMesaDevice osmesa;
  ModelledGpu gpu(fitted_model());
  osmesa.load(scene);
  gpu.load(scene);
  TimedDevice real(osmesa), modelled(gpu);
  std::vector<Predicted> all(std::size(methods));
  std::vector<std::unique_ptr<Walker>> walkers;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Walker walker(methods[i], scene, modelled);
    walker.walk(path, state);
    for (int walk = 0; walk < rounds; ++walk) {
      const Round round = walker.walk(path, state);
      RoundSamples& frame_ms = all[i].predicted_ms.emplace_back();
      for (std::size_t f = 0; f < round.frame_ms.size(); ++f) {
        frame_ms.push_back(round.frame_ms[f] + 1e-3 * (round.update_us[f] + round.cull_us[f]));
      }
    }
    walkers.push_back(std::make_unique<Walker>(methods[i], scene, real));
    walkers.back()->walk(path, state);
  }
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].measured_ms.push_back(walkers[i]->walk(path, state).frame_ms);
    }
  }
  return all;
}

/// By method. Takes seconds the first time that a scene is asked for.
const std::vector<Predicted>& prediction(std::size_t scene) {
  static std::vector<Predicted> all[std::size(scenes)];
  if (all[scene].empty()) all[scene] = predict_scene(scenes[scene]);
  return all[scene];
}

/// Of the medians over paths: the median over all methods and scenes, in %.
Measurement error_of_paths() {
  std::vector<double> errors;
  for (std::size_t scene = 0; scene < std::size(scenes); ++scene) {
    for (const Predicted& entry : prediction(scene)) {
      errors.push_back(Predicted::error(entry.ratio()));
    }
  }
  return {median(std::move(errors)), true};
}

/// Of single frames: the median over those of all scenes, of some of the methods, in %.
Measurement error_of_frames(std::size_t first_method, std::size_t end_method) {
  std::vector<double> errors;
  for (std::size_t scene = 0; scene < std::size(scenes); ++scene) {
    for (std::size_t method = first_method; method < end_method; ++method) {
      const std::vector<double> some = prediction(scene)[method].errors_of_frames();
      errors.insert(errors.end(), some.begin(), some.end());
    }
  }
  return {median(std::move(errors)), true};
}

/// Of the pairs of methods on a scene whose measured times differ beyond their interval: the share
/// whose predicted times differ in the same way, in %.
Measurement ranked_rightly() {
  std::size_t decided = 0, right = 0;
  for (std::size_t scene = 0; scene < std::size(scenes); ++scene) {
    const std::vector<Predicted>& all = prediction(scene);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Estimate ratio = paired_ratio(all[i].measured_ms, all[j].measured_ms);
        if (ratio.low <= 1.0 && ratio.high >= 1.0) continue;
        ++decided;
        const bool less = all[i].predicted_median_ms() < all[j].predicted_median_ms();
        right += (ratio.value < 1.0) == less ? 1 : 0;
      }
    }
  }
  return {100.0 * static_cast<double>(right) / static_cast<double>(decided), decided > 0};
}

}  // namespace

void add_prediction_cases(std::vector<BenchCase>& cases) {
  const std::string bench = "modelled[preset=osmesa]";
  for (std::size_t scene = 0; scene < std::size(scenes); ++scene) {
    for (std::size_t method = 0; method < std::size(methods); ++method) {
      cases.push_back({bench,
                       std::string(scenes[scene]) + ", " + methods[method] + ": predicted",
                       "of measured frame_ms",
                       "",
                       {},
                       [scene, method] {
                         return Measurement{prediction(scene)[method].ratio(), true};
                       }});
    }
  }
  // A row a method, so that the worst can be named.
  for (std::size_t method = 0; method < std::size(methods); ++method) {
    cases.push_back({bench,
                     std::string("all scenes, ") + methods[method] + ": median error of frames",
                     "%",
                     "",
                     {},
                     [method] { return error_of_frames(method, method + 1); }});
  }
  cases.push_back({bench,
                   "all scenes and methods: median error of frames",
                   "%",
                   "",
                   {},
                   [] { return error_of_frames(0, std::size(methods)); },
                   Bar::at_most(20.0)});
  cases.push_back({bench,
                   "all scenes and methods: median error of medians over paths",
                   "%",
                   "",
                   {},
                   error_of_paths,
                   Bar::at_most(20.0)});
  cases.push_back({bench,
                   "all scenes: decided pairs of methods ranked rightly",
                   "%",
                   "",
                   {},
                   ranked_rightly,
                   Bar::at_least(90.0)});
}

}  // namespace vislab
