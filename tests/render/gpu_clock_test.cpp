#include "common/render/gpu_clock.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "common/scene/error.h"

namespace vislab {
namespace {

using Kind = GpuCommandKind;
using Work = GpuClock::Work;

/// Everything is free but what a test sets; polls take 1 µs.
GpuModel free_model() {
  GpuModel model;
  model.poll_us = 1.0;
  model.pipeline_depth = 1000;
  return model;
}

void draw(GpuClock& clock, std::uint32_t objects, const Work& work = {}) {
  clock.draw(std::vector<Work>(objects, work));
}

TEST(GpuClock, EachDialOfTheHostCostsWhatItSays) {
  GpuModel model = free_model();
  model.draw_us = 10.0;
  model.host_triangle_ns = 100.0;
  model.state_change_us = 3.0;
  model.query_us = 5.0;
  model.box_us = 0.5;
  model.flush_us = 7.0;
  GpuClock clock(model);
  clock.begin_frame();
  draw(clock, 2, {20, 0});
  EXPECT_DOUBLE_EQ(clock.host_us(), 2.0 * (10.0 + 2.0));
  clock.query(4, 0);
  EXPECT_DOUBLE_EQ(clock.host_us(), 24.0 + 3.0 + 5.0 + 2.0);
  clock.query(0, 0);
  EXPECT_DOUBLE_EQ(clock.host_us(), 34.0 + 5.0) << "no change of state between two queries";
  clock.flush();
  EXPECT_DOUBLE_EQ(clock.host_us(), 39.0 + 7.0);
  clock.flush();
  EXPECT_DOUBLE_EQ(clock.host_us(), 46.0) << "nothing to hand over";
  draw(clock, 1);
  EXPECT_DOUBLE_EQ(clock.host_us(), 46.0 + 3.0 + 10.0);
  draw(clock, 0);
  EXPECT_DOUBLE_EQ(clock.host_us(), 59.0);
  EXPECT_TRUE(clock.poll(0));
  EXPECT_DOUBLE_EQ(clock.host_us(), 60.0);
}

TEST(GpuClock, EachDialOfTheDeviceCostsWhatItSays) {
  GpuModel model = free_model();
  model.device_draw_us = 2.0;
  model.triangle_ns = 10.0;
  model.pixel_ns = 1.0;
  model.device_query_us = 4.0;
  model.device_state_change_us = 6.0;
  model.device_batch_us = 8.0;
  GpuClock clock(model);
  clock.begin_frame();
  draw(clock, 2, {100, 3000});
  clock.query(5, 500);
  EXPECT_DOUBLE_EQ(clock.device_us(), 0.0) << "nothing was handed over";
  clock.finish();
  const double draws = 2.0 * (2.0 + 1.0 + 3.0);
  const double query = 6.0 + 4.0 + 0.6 + 0.5;
  EXPECT_DOUBLE_EQ(clock.device_us(), 8.0 + draws + query);
  EXPECT_DOUBLE_EQ(clock.host_us(), clock.device_us());
}

TEST(GpuClock, DialsOfASoftwareRendererCostWhatTheySay) {
  GpuModel model = free_model();
  model.frame_us = 30.0;
  model.host_shown_triangle_ns = 50.0;
  model.shown_triangle_ns = 20.0;
  model.outline_ns = 3.0;
  GpuClock clock(model);
  clock.begin_frame();
  EXPECT_DOUBLE_EQ(clock.host_us(), 30.0);
  draw(clock, 1, {1000, 0, 0});
  EXPECT_DOUBLE_EQ(clock.host_us(), 30.0) << "nothing of it is seen";
  draw(clock, 1, {1000, 1, 400});
  EXPECT_DOUBLE_EQ(clock.host_us(), 30.0 + 50.0);
  clock.query(1, 10, 200);
  clock.finish();
  EXPECT_DOUBLE_EQ(clock.device_us(), 80.0 + 20.0 + 1.2 + 0.6);
}

TEST(GpuClock, ACommandWaitsForItsHandOverAndForThoseBeforeIt) {
  GpuModel model = free_model();
  model.draw_us = 10.0;
  model.device_draw_us = 4.0;
  model.pipeline_depth = 1;
  GpuClock fast_device(model);
  fast_device.begin_frame();
  draw(fast_device, 3);
  EXPECT_DOUBLE_EQ(fast_device.device_us(), 34.0) << "starved: each begins when it is issued";
  model.device_draw_us = 25.0;
  GpuClock slow_device(model);
  slow_device.begin_frame();
  draw(slow_device, 3);
  EXPECT_DOUBLE_EQ(slow_device.device_us(), 10.0 + 3.0 * 25.0);
  EXPECT_DOUBLE_EQ(slow_device.host_us(), 30.0);
  slow_device.finish();
  EXPECT_DOUBLE_EQ(slow_device.host_us(), 85.0);
}

TEST(GpuClock, CommandsGatherUntilThePipelineIsFull) {
  GpuModel model = free_model();
  model.draw_us = 10.0;
  model.device_draw_us = 4.0;
  model.pipeline_depth = 3;
  GpuClock clock(model);
  clock.begin_frame();
  draw(clock, 2);
  EXPECT_DOUBLE_EQ(clock.device_us(), 0.0);
  draw(clock, 2);
  EXPECT_DOUBLE_EQ(clock.device_us(), 30.0 + 3.0 * 4.0);
  // The second call is two entries of the log: one on each side of the hand-over.
  ASSERT_EQ(clock.log().size(), 4U);
  EXPECT_EQ(clock.log()[2].kind, Kind::flush);
  EXPECT_EQ(clock.log()[2].count, 3U);
  EXPECT_EQ(clock.log()[1].device, (GpuInterval{38.0, 42.0}));
  EXPECT_EQ(clock.log()[3].count, 1U);
  EXPECT_EQ(clock.log()[3].host, (GpuInterval{30.0, 40.0}));
}

TEST(GpuClock, AnAnswerComesLatencyAfterItsQueryIsDone) {
  GpuModel model = free_model();
  model.query_us = 2.0;
  model.device_query_us = 10.0;
  model.latency_us = 5.5;
  GpuClock clock(model);
  clock.begin_frame();
  const std::uint32_t first = clock.query(1, 0);
  EXPECT_FALSE(clock.poll(first)) << "never there before it is handed over";
  clock.flush();  // at 3
  int polls = 0;
  while (!clock.poll(first)) ++polls;
  EXPECT_EQ(polls, 15);
  EXPECT_DOUBLE_EQ(clock.host_us(), 19.0) << "the first poll that ends after 3 + 10 + 5.5";
  const std::uint32_t second = clock.query(1, 0);
  clock.wait(second);  // handed over at 21
  EXPECT_DOUBLE_EQ(clock.host_us(), 21.0 + 10.0 + 5.5);
  clock.wait(first);
  EXPECT_DOUBLE_EQ(clock.host_us(), 36.5) << "what is there is not waited for";
}

TEST(GpuClock, WaitingForAnAnswerThatIsUnderWayHandsNothingOver) {
  GpuModel model = free_model();
  model.device_query_us = 10.0;
  model.device_draw_us = 100.0;
  GpuClock clock(model);
  clock.begin_frame();
  const std::uint32_t query = clock.query(1, 0);
  clock.flush();
  draw(clock, 1);
  clock.wait(query);
  EXPECT_DOUBLE_EQ(clock.host_us(), 10.0);
  EXPECT_DOUBLE_EQ(clock.device_us(), 10.0);
  clock.finish();
  EXPECT_DOUBLE_EQ(clock.host_us(), 110.0);
}

TEST(GpuClock, ASerialDeviceWorksOnTheHostsTime) {
  GpuModel model = free_model();
  model.draw_us = 10.0;
  model.device_draw_us = 25.0;
  model.pipeline_depth = 1;
  model.serial = true;
  GpuClock clock(model);
  clock.begin_frame();
  draw(clock, 3);
  EXPECT_DOUBLE_EQ(clock.host_us(), 3.0 * 35.0);
  const std::uint32_t query = clock.query(1, 0);
  EXPECT_TRUE(clock.poll(query));
}

TEST(GpuClock, LogsWhatPassedInTheHostsOrderWithoutOverlap) {
  GpuModel model = gpu_preset("gpu").model;
  model.pipeline_depth = 4;
  GpuClock clock(model);
  clock.begin_frame();
  draw(clock, 6, {12, 300});
  const std::uint32_t query = clock.query(3, 900);
  clock.flush();
  for (int i = 0; i < 3; ++i) clock.poll(query);
  clock.wait(query);
  draw(clock, 1, {7, 20});
  clock.finish();
  const std::vector<Kind> kinds{Kind::draw, Kind::flush, Kind::draw, Kind::query, Kind::flush,
                                Kind::poll, Kind::wait,  Kind::draw, Kind::flush, Kind::wait};
  ASSERT_EQ(clock.log().size(), kinds.size());
  double host = 0.0, device = 0.0;
  std::uint32_t changes = 0;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const GpuCommand& command = clock.log()[i];
    EXPECT_EQ(command.kind, kinds[i]) << i;
    EXPECT_EQ(command.host.begin_us, host) << i << ": nothing passes between calls";
    host = command.host.end_us;
    changes += command.changes_state ? 1 : 0;
    if (command.kind != Kind::draw && command.kind != Kind::query) continue;
    EXPECT_GE(command.device.begin_us, device) << i;
    device = command.device.end_us;
  }
  EXPECT_EQ(host, clock.host_us());
  EXPECT_EQ(changes, 2U);
  EXPECT_EQ(clock.log()[3].triangles, 36U);
  EXPECT_EQ(clock.log()[3].samples, 900U);
  EXPECT_EQ(clock.log()[5].count, 3U);
  EXPECT_EQ(clock.log()[6].query, query);
  clock.begin_frame();
  EXPECT_TRUE(clock.log().empty());
  EXPECT_EQ(clock.host_us(), 0.0);
}

TEST(GpuModel, DialsHaveNamesRangesAndMeanings) {
  GpuModel model;
  std::set<std::string_view> names;
  for (const GpuDial& dial : gpu_dials()) {
    EXPECT_TRUE(names.insert(dial.name).second);
    EXPECT_TRUE(dial.meaning.ends_with(".")) << dial.name;
    dial.set(model, dial.greatest);
    EXPECT_EQ(dial.value(model), dial.greatest) << dial.name;
    EXPECT_THROW(dial.set(model, std::nan("")), InputError) << dial.name;
    EXPECT_THROW(dial.set(model, dial.least - 1e-4), InputError) << dial.name;
    EXPECT_THROW(dial.set(model, 2.0 * dial.greatest + 1.0), InputError) << dial.name;
  }
  EXPECT_TRUE(model.serial);
  EXPECT_THROW(gpu_dial("pipeline_depth").set(model, 2.5), InputError);
  EXPECT_THROW(gpu_dial("pixels"), InputError);
  EXPECT_THROW(gpu_preset("voodoo"), InputError);
  GpuModel without_polls;
  without_polls.poll_us = 0.0;
  EXPECT_THROW(GpuClock{without_polls}, InputError) << "a loop that polls would never end";
}

TEST(GpuModel, PresetsAreWithinTheirRangesAndTextReadsBack) {
  for (const GpuPreset& preset : gpu_presets()) EXPECT_NO_THROW(check(preset.model));
  const std::string text = to_text(gpu_preset("gpu").model);
  EXPECT_NE(text.find("draw_us=10, "), std::string::npos) << text;
  EXPECT_NE(text.find("triangle_ns=3.3, "), std::string::npos) << text;
}

}  // namespace
}  // namespace vislab
