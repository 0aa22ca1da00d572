#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "common/render/modelled_gpu.h"
#include "common/scene/generators/generators.h"
#include "experiments/calibration/device_fit.h"
#include "experiments/devices/device_spec.h"
#include "experiments/run/timed_device.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

TEST(DeviceSpec, TextsThatMeanTheSameDeviceAreKeptUnderOneText) {
  EXPECT_EQ(parse_device("osmesa").text, "osmesa");
  EXPECT_EQ(parse_device(" osmesa[synchronous=false] ").text, "osmesa");
  EXPECT_EQ(parse_device("osmesa[synchronous=true]").text, "osmesa[synchronous=true]");
  EXPECT_EQ(parse_device("none").text, "none");
  const std::string text = "modelled[preset=gpu,draw_us=1.5,latency_us=500]";
  EXPECT_EQ(parse_device("modelled[latency_us=5e2, draw_us=1.50]").text, text);
  EXPECT_EQ(parse_device(text).text, text);
}

TEST(DeviceSpec, DialsThatThePresetHasAnywayAreLeftOutUnlessTheyAreFitted) {
  const GpuModel& gpu = gpu_preset("gpu").model;
  const std::string same = "latency_us=" + std::to_string(gpu.latency_us);
  EXPECT_EQ(parse_device("modelled[" + same + "]").text, "modelled[preset=gpu]");
  EXPECT_EQ(parse_device("modelled[preset=osmesa,latency_us=5]").text,
            "modelled[preset=osmesa,latency_us=5]")
      << "what is named is not fitted";
}

TEST(DeviceSpec, NamedDialsReplaceThoseOfThePreset) {
  const DeviceSpec spec = parse_device("modelled[preset=modern,pipeline_depth=7,serial=true]");
  GpuModel expected = gpu_preset("modern").model;
  expected.pipeline_depth = 7;
  expected.serial = true;
  EXPECT_EQ(spec.model(gpu_preset("modern").model), expected);
  EXPECT_FALSE(spec.is_fitted());
  EXPECT_EQ(spec.drawing_threads(2), 2);
}

TEST(DeviceSpec, ASerialFitAndSynchronousDrawingNeedNoThreads) {
  EXPECT_TRUE(parse_device("modelled[preset=osmesa]").is_fitted());
  EXPECT_EQ(parse_device("modelled[preset=osmesa]").drawing_threads(2), 2);
  EXPECT_EQ(parse_device("modelled[preset=osmesa,serial=true]").drawing_threads(2), 0);
  EXPECT_EQ(parse_device("osmesa[synchronous=true]").drawing_threads(2), 0);
}

TEST(DeviceSpec, ErrorsNameWhatIsAllowed) {
  const auto expect = [](const std::string& text, const std::vector<std::string>& words) {
    const std::string message = input_error([&] { parse_device(text); });
    for (const std::string& word : words) EXPECT_TRUE(says(message, word)) << text;
  };
  expect("vulkan", {"vulkan", "osmesa", "none", "modelled"});
  expect("modelled[preset=voodoo]", {"voodoo", "gpu", "modern", "osmesa"});
  expect("modelled[latency=1]", {"latency", "latency_us", "preset"});
  expect("modelled[latency_us=-1]", {"latency_us", "0"});
  expect("modelled[pipeline_depth=2.5]", {"pipeline_depth"});
  expect("modelled[latency_us=1", {"modelled[preset=gpu"});
  expect("osmesa > none", {"a device is written"});
  expect("none[synchronous=true]", {"none", "no parameters"});
  expect("osmesa[latency_us=1]", {"latency_us", "synchronous"});
}

TEST(DeviceSpec, EveryListedDeviceCanBeMade) {
  for (const auto& [name, meaning] : list_devices()) {
    const DeviceSpec spec = parse_device(name);
    EXPECT_EQ(spec.text, name);
    EXPECT_FALSE(meaning.empty());
    EXPECT_EQ(make_device(spec, GpuModel()) == nullptr, name == "none");
  }
}

/// A box before the camera, drawn and asked about on a modelled device.
class CountedDevice : public ::testing::Test {
 protected:
  CountedDevice() {
    scene_.meshes = {box_mesh({1.0, 1.0, 1.0}, 1, 1.0)};
    scene_.objects = {{0, glm::dmat4x3(1.0), none_id}};
    scene_.finish();
    state_ = std::make_unique<SceneState>(scene_);
    frame_.viewport = {32, 32};
    frame_.camera = {look_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}),
                     perspective_lens(1.0, 1.0, 0.1, 10.0)};
    frame_.objects = state_->view();
    device_.load(scene_);
    device_.begin_frame(frame_);
  }
  void draw() { device_.draw(std::span(&object_, 1)); }
  QueryId ask(std::size_t boxes) {
    return device_.query(std::vector<Aabb>(boxes, scene_.bounds()));
  }

  Scene scene_;
  std::unique_ptr<SceneState> state_;
  Frame frame_;
  ObjectId object_ = 0;
  ModelledGpu gpu_{gpu_preset("gpu").model};
  TimedDevice device_{gpu_};
};

TEST_F(CountedDevice, CountsQueriesBoxesAndChangesFromDrawingToAskingAndBack) {
  draw();
  draw();
  ask(1);
  ask(3);
  draw();
  device_.draw(std::span<const ObjectId>());
  ask(1);
  device_.flush();
  device_.finish();
  const DeviceCounts& counts = device_.counts();
  EXPECT_EQ(counts.queries, 3U);
  EXPECT_EQ(counts.query_boxes, 5U);
  EXPECT_EQ(counts.state_changes, 3U);
  EXPECT_EQ(counts.flushes, 1U);
  EXPECT_EQ(device_.clock_ms(), gpu_.clock_ms());
  device_.begin_frame(frame_);
  EXPECT_EQ(device_.counts().queries, 0U);
  ask(1);
  EXPECT_EQ(device_.counts().state_changes, 1U) << "a frame begins with drawing";
}

TEST_F(CountedDevice, AWaitIsAnAnswerThatIsFetchedWithoutKnowingThatItIsThere) {
  const QueryId first = ask(1);
  const QueryId second = ask(1);
  device_.samples(first);
  device_.samples(first);
  EXPECT_EQ(device_.counts().waits, 1U);
  device_.flush();
  while (!device_.ready(second)) {
  }
  device_.samples(second);
  EXPECT_EQ(device_.counts().waits, 1U);
}

TEST(LeastSquares, FindsTheDialsThatMadeTheTimes) {
  // Weights are relative: each row times the dials is 1.
  const std::vector<double> dials{2.0, 0.0, 5.0};
  std::vector<std::vector<double>> rows{
      {1.0, 1.0, 0.0}, {1.0, 0.0, 3.0}, {0.0, 4.0, 1.0}, {2.0, 2.0, 2.0}};
  for (std::vector<double>& row : rows) {
    const double time = row[0] * dials[0] + row[1] * dials[1] + row[2] * dials[2];
    for (double& weight : row) weight /= time;
  }
  const std::vector<double> found = nonnegative_least_squares(rows);
  ASSERT_EQ(found.size(), dials.size());
  for (std::size_t i = 0; i < dials.size(); ++i) EXPECT_NEAR(found[i], dials[i], 1e-6);
}

TEST(LeastSquares, GivesNothingBelowZero) {
  // 2 x + y = 1 and x + 4 y = -1 in effect: the second row wants less than nothing.
  const std::vector<std::vector<double>> rows{{2.0, 1.0}, {-1.0, -4.0}};
  for (const double value : nonnegative_least_squares(rows)) EXPECT_GE(value, 0.0);
}

TEST(DeviceFit, GivesAModelThatCanBeMadeAndTellsSmallWorkFromLarge) {
  const DeviceFit fit = fit_device(2);
  check(fit.model);
  EXPECT_FALSE(fit.model.serial);
  ASSERT_FALSE(fit.works.empty());
  const auto modelled_ms = [&](const std::string& name) {
    const auto work = std::ranges::find(fit.works, name, &FittedWork::name);
    return work == fit.works.end() ? -1.0 : work->modelled_ms;
  };
  EXPECT_GT(modelled_ms("small boxes"), modelled_ms("a third of the small boxes"));
  EXPECT_GT(modelled_ms("a sphere"), modelled_ms("an unseen sphere"));
}

}  // namespace
}  // namespace vislab
