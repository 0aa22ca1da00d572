#include "experiments/calibration/device_fit.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "experiments/calibration/fit_works.h"

namespace vislab {
namespace {

constexpr int turns = 12;
constexpr int endless_pipeline = 1'000'000'000;

/// Milliseconds until the work was submitted, and until it was done.
struct WorkTime {
  double submitted_ms = std::numeric_limits<double>::infinity();
  double done_ms = std::numeric_limits<double>::infinity();
};

/// The least of some turns, in each of which every work is done once.
std::vector<WorkTime> measure(const FitWorks& works) {
  using Clock = std::chrono::steady_clock;
  OsMesaDevice device;
  device.load(works.scene());
  std::vector<WorkTime> times(works.works().size());
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto start = Clock::now();
      const auto since = [&] {
        return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
      };
      double submitted_ms = 0.0;
      run_work(device, works.frame(), works.works()[i], [&] { submitted_ms = since(); });
      const double done_ms = since();
      if (turn == 0) continue;  // buffers grow, shaders are translated
      times[i].submitted_ms = std::min(times[i].submitted_ms, submitted_ms);
      times[i].done_ms = std::min(times[i].done_ms, done_ms);
    }
  }
  return times;
}

std::vector<WorkTime> modelled(const FitWorks& works, const GpuModel& model) {
  ModelledGpu device(model);
  device.load(works.scene());
  std::vector<WorkTime> times;
  for (const FitWorks::Work& work : works.works()) {
    WorkTime& time = times.emplace_back();
    run_work(device, works.frame(), work, [&] { time.submitted_ms = *device.clock_ms(); });
    time.done_ms = *device.clock_ms();
  }
  return times;
}

GpuModel empty_model() {
  GpuModel model;
  for (const GpuDial& dial : gpu_dials()) dial.set(model, dial.least);
  model.pipeline_depth = endless_pipeline;
  return model;
}

bool is_fitted(const GpuDial& dial) {
  return std::holds_alternative<double GpuModel::*>(dial.member) && dial.name != "poll_us";
}

double poll_us(const FitWorks& works) {
  constexpr int polls = 1000;
  OsMesaDevice device;
  device.load(works.scene());
  device.begin_frame(works.frame());
  const Aabb box({-1.0, -1.0, -9.0}, {1.0, 1.0, -8.0});
  const QueryId query = device.query(std::span(&box, 1));
  device.samples(query);
  double least = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < turns; ++turn) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < polls; ++i) device.ready(query);
    const std::chrono::duration<double, std::micro> all = std::chrono::steady_clock::now() - start;
    least = std::min(least, all.count() / polls);
  }
  return std::max(least, gpu_dial("poll_us").least);
}

}  // namespace

std::vector<double> nonnegative_least_squares(std::span<const std::vector<double>> weights) {
  constexpr int sweeps = 20'000;
  constexpr double pull = 1e-9;
  const std::size_t unknowns = weights.empty() ? 0 : weights.front().size();
  std::vector<double> scale(unknowns, 0.0);
  for (const std::vector<double>& row : weights) {
    for (std::size_t k = 0; k < unknowns; ++k) scale[k] += row[k] * row[k];
  }
  std::vector<double> x(unknowns, 0.0);
  std::vector<double> rest(weights.size(), 1.0);  // what of each row is not explained yet
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t k = 0; k < unknowns; ++k) {
      if (scale[k] == 0.0) continue;
      double slope = 0.0;
      for (std::size_t i = 0; i < rest.size(); ++i) slope += weights[i][k] * rest[i];
      const double next = std::max(0.0, (x[k] * scale[k] + slope) / (scale[k] * (1.0 + pull)));
      for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= weights[i][k] * (next - x[k]);
      x[k] = next;
    }
  }
  return x;
}

DeviceFit fit_device(int drawing_threads) {
  const FitWorks works;
  const std::vector<WorkTime> times = measure(works);
  GpuModel base = empty_model();
  const double poll = poll_us(works);
  base.serial = drawing_threads == 0;

  // A row for the time of each work, and one for its host's part.
  std::vector<std::vector<double>> rows(2 * times.size());
  for (const GpuDial& dial : gpu_dials()) {
    if (!is_fitted(dial)) continue;
    GpuModel one = base;
    dial.set(one, 1.0);
    const std::vector<WorkTime> per_unit = modelled(works, one);
    for (std::size_t i = 0; i < times.size(); ++i) {
      rows[2 * i].push_back(per_unit[i].done_ms / times[i].done_ms);
      rows[2 * i + 1].push_back(per_unit[i].submitted_ms / times[i].submitted_ms);
    }
  }
  const std::vector<double> values = nonnegative_least_squares(rows);
  DeviceFit fit{base, {}};
  std::size_t next = 0;
  for (const GpuDial& dial : gpu_dials()) {
    if (is_fitted(dial)) dial.set(fit.model, values[next++]);
  }
  fit.model.poll_us = poll;
  const std::vector<WorkTime> fitted = modelled(works, fit.model);
  for (std::size_t i = 0; i < times.size(); ++i) {
    fit.works.push_back({works.works()[i].name, times[i].done_ms, fitted[i].done_ms});
  }
  return fit;
}

}  // namespace vislab
