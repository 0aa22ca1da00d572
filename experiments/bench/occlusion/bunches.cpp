// How many queries a second a device answers, by how many are asked together: the lecture's plot
// (Zachmann, Computer-Graphik 2, SS 2012, slide 56).
//
// A city is drawn once. Then boxes are asked about in bunches: something small is drawn, so that
// the device changes its state as it does between drawing and asking; the bunch is asked and handed
// over; its answers are read. On OSMesa each size of bunch is timed against single questions; on
// modelled devices it is their clock that counts.
#include <array>
#include <cmath>

#include "common/geometry/frustum.h"
#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "common/render/query_bounds.h"
#include "common/scene/generators/generators.h"
#include "experiments/bench/occlusion/cases.h"

namespace vislab {
namespace {

constexpr std::size_t question_count = 320;  // a multiple of all sizes
constexpr std::array<std::size_t, 10> sizes{1, 2, 4, 8, 16, 20, 32, 40, 64, 80};

class Interview {
 public:
  Interview() : scene_(made_scene()), state_(scene_) {
    frame_.camera = {look_at({0.0, 1.7, 60.0}, {0.0, 4.0, 0.0}),
                     perspective_lens(1.0, 1.0, 0.3, 3000.0)};
    frame_.viewport = {512, 512};
    frame_.objects = state_.view();
    const Frustum frustum = frustum_of(frame_.camera);
    for (std::size_t i = 0; boxes_.size() < question_count; ++i) {
      const Aabb& box = frame_.objects.bounds[i % scene_.object_count()];
      const Aabb asked = enlarged_for_query(frame_.camera, frame_.viewport, box);
      bool inside = !touches_near_region(frame_.camera, asked);
      for (const Plane& plane : frustum.span()) inside = inside && !surely_outside(plane, box);
      if (inside) boxes_.push_back(asked);
    }
  }

  const Scene& scene() const { return scene_; }

  void draw_city(RenderDevice& device) const {
    device.begin_frame(frame_);
    device.draw(frame_.objects.shown);
    device.finish();
  }

  /// The answers to all questions, `size` at a time. After draw_city.
  std::vector<std::uint64_t> ask(RenderDevice& device, std::size_t size) const {
    std::vector<std::uint64_t> answers;
    std::vector<QueryId> bunch;
    for (std::size_t first = 0; first < boxes_.size(); first += size) {
      device.draw(frame_.objects.shown.first(1));
      bunch.clear();
      for (std::size_t i = first; i < first + size; ++i) {
        bunch.push_back(device.query({&boxes_[i], 1}));
      }
      device.flush();
      for (const QueryId query : bunch) answers.push_back(device.samples(query));
    }
    return answers;
  }

 private:
  static Scene made_scene() {
    CityParameters parameters;
    parameters.blocks_x = parameters.blocks_z = 12;
    parameters.street_boxes = 400;
    Scene scene = make_city(parameters);
    scene.finish();
    return scene;
  }

  Scene scene_;
  SceneState state_;
  Frame frame_;
  std::vector<Aabb> boxes_;
};

/// Bunches against single questions on OSMesa.
class BunchContest : public Contest {
 public:
  explicit BunchContest(std::size_t size) : size_(size) { device_.load(interview_.scene()); }
  void ours() override { ours_ = timed(size_); }
  void theirs() override { theirs_ = timed(1); }
  bool equal() override { return ours_ == theirs_; }
  double work() const override { return static_cast<double>(question_count); }

 private:
  /// Only the first call of a side draws the city: what is asked about later is the same.
  std::vector<std::uint64_t> timed(std::size_t size) {
    if (!drawn_) interview_.draw_city(device_);
    drawn_ = true;
    return interview_.ask(device_, size);
  }

  Interview interview_;
  OsMesaDevice device_;
  std::size_t size_;
  bool drawn_ = false;
  std::vector<std::uint64_t> ours_, theirs_;
};

/// Questions a second by the modelled device's clock, and whether the answers are the same as one
/// by one.
Measurement modelled_rate(const GpuPreset& preset, std::size_t size) {
  const Interview interview;
  ModelledGpu device(preset.model);
  device.load(interview.scene());
  interview.draw_city(device);
  const std::vector<std::uint64_t> singles = interview.ask(device, 1);
  interview.draw_city(device);
  const double start_ms = *device.clock_ms();
  const std::vector<std::uint64_t> answers = interview.ask(device, size);
  const double elapsed_ms = *device.clock_ms() - start_ms;
  return {1e3 * static_cast<double>(question_count) / elapsed_ms, answers == singles};
}

}  // namespace

void add_bunch_cases(std::vector<BenchCase>& cases) {
  for (const std::size_t size : sizes) {
    cases.push_back({"queries", "osmesa, batch=" + std::to_string(size), "queries/s", "one by one",
                     [size] { return std::make_unique<BunchContest>(size); }});
  }
  for (const GpuPreset& preset : gpu_presets()) {
    for (const std::size_t size : sizes) {
      cases.push_back(
          {"queries",
           "modelled[preset=" + std::string(preset.name) + "], batch=" + std::to_string(size),
           "queries/s",
           "",
           {},
           [preset, size] { return modelled_rate(preset, size); }});
    }
  }
}

}  // namespace vislab
