#include "common/render/query_timeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "common/render/canvas.h"

namespace vislab {
namespace {

constexpr Color paper = {255, 255, 255};
constexpr Color lane_color = {238, 240, 243};
constexpr Color black = {0, 0, 0};
constexpr double margin = 16.0;
constexpr double lane_left = 110.0;
constexpr double lane_width = 980.0;
constexpr double picture_width = lane_left + lane_width + 3.0 * margin;
constexpr double title_height = 40.0;
constexpr double heading_height = 48.0;
constexpr double lane_height = 34.0, lane_gap = 8.0, tick_height = 8.0;
constexpr double axis_height = 26.0;
constexpr double row_height =
    heading_height + tick_height + 2.0 * lane_height + lane_gap + axis_height + margin;
constexpr double foot_height = 28.0;
constexpr double legend_height = 34.0;

/// Blue, orange, black, green and purple of Okabe and Ito (2008).
struct Look {
  GpuCommandKind kind;
  Color color;
  const char* name;
};
constexpr std::array<Look, 5> looks = {
    {{GpuCommandKind::draw, {0, 114, 178}, "draws"},
     {GpuCommandKind::query, {230, 159, 0}, "queries"},
     {GpuCommandKind::flush, {60, 60, 60}, "handing over"},
     {GpuCommandKind::poll, {0, 158, 115}, "asking if answers are there"},
     {GpuCommandKind::wait, {204, 121, 167}, "waiting"}}};

Color color_of(GpuCommandKind kind) {
  const auto* const found = std::ranges::find(looks, kind, &Look::kind);
  return found->color;
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), value < 10.0 ? "%.2f" : "%.1f", value);
  return text.data();
}

std::string percent(double part, double whole) {
  return whole > 0.0 ? std::to_string(std::lround(100.0 * part / whole)) + " %" : "0 %";
}

/// 1, 2 or 5 times a power of ten, so that at most eight steps lie in `span`.
double step_for(double span) {
  const double least = span / 8.0;
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * decade >= least) return step * decade;
  }
  return 10.0 * decade;
}

/// Ticks as short as their step allows: "0.25", "2".
std::string tick_text(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

class Timeline {
 public:
  explicit Timeline(Canvas& canvas) : canvas_(canvas) {}

  void row(const TimelineRow& row, double top) {
    const TimelineFigures figures = figures_of(row.commands);
    span_us_ = std::max(figures.frame_us, 1e-3);
    canvas_.text(margin, top + 17.0, picture_width - 2.0 * margin, 15.0, true, row.name);
    canvas_.text(margin, top + 37.0, picture_width - 2.0 * margin, 14.0, false, note(figures));
    const double host = top + heading_height + tick_height;
    const double device = host + lane_height + lane_gap;
    canvas_.text(margin, host + 22.0, lane_left - 2.0 * margin, 14.0, false, "processor");
    canvas_.text(margin, device + 22.0, lane_left - 2.0 * margin, 14.0, false, "device");
    canvas_.fill(lane_left, host, lane_width, lane_height, lane_color);
    canvas_.fill(lane_left, device, lane_width, lane_height, lane_color);
    for (const GpuCommand& command : row.commands) {
      bar(command.host, command.kind, host);
      if (command.kind == GpuCommandKind::poll || command.kind == GpuCommandKind::wait) continue;
      bar(command.device, command.kind, device);
    }
    for (const GpuCommand& command : row.commands) {
      if (!command.changes_state) continue;
      canvas_.fill(at(command.host.begin_us) - 0.5, host - tick_height, 1.0, tick_height - 2.0,
                   black);
    }
    axis(device + lane_height + 2.0);
  }

  void legend(double top) {
    double left = lane_left;
    for (const Look& look : looks) {
      canvas_.fill(left, top, 22.0, 14.0, look.color);
      const std::string name = look.name;
      canvas_.text(left + 28.0, top + 12.0, 220.0, 14.0, false, name);
      left += 52.0 + 7.6 * static_cast<double>(name.size());
    }
    for (const double x : {0.0, 5.0, 10.0}) canvas_.fill(left + x, top + 2.0, 1.0, 10.0, black);
    canvas_.text(left + 18.0, top + 12.0, 240.0, 14.0, false, "change between drawing and asking");
  }

 private:
  static std::string note(const TimelineFigures& figures) {
    return number(1e-3 * figures.frame_us) + " ms: the processor waits " +
           percent(figures.waits_us, figures.frame_us) + " of it, the device works " +
           percent(figures.device_us, figures.frame_us) +
           "; draws: " + std::to_string(figures.draws) +
           ", queries: " + std::to_string(figures.queries) +
           " (boxes: " + std::to_string(figures.boxes) +
           "), state changes: " + std::to_string(figures.state_changes);
  }
  void axis(double top) {
    const double step = step_for(1e-3 * span_us_);
    canvas_.fill(lane_left, top, lane_width, 1.0, black);
    for (int i = 0; step * i <= 1e-3 * span_us_ * 1.0001; ++i) {
      const double x = at(1e3 * step * i);
      const std::string tick = tick_text(step * i, step) + (i == 0 ? " ms" : "");
      canvas_.fill(x - 0.5, top, 1.0, 6.0, black);
      canvas_.text(x - (i == 0 ? 4.0 : 8.0), top + 20.0, 60.0, 13.0, false, tick);
    }
  }
  double at(double time_us) const { return lane_left + lane_width * time_us / span_us_; }
  void bar(const GpuInterval& interval, GpuCommandKind kind, double top) {
    if (interval.end_us <= interval.begin_us) return;
    const double left = at(interval.begin_us);
    canvas_.fill(left, top, at(interval.end_us) - left, lane_height, color_of(kind));
  }

  Canvas& canvas_;
  double span_us_ = 1.0;  // of the row
};

}  // namespace

TimelineFigures figures_of(const std::vector<GpuCommand>& commands) {
  TimelineFigures figures;
  for (const GpuCommand& command : commands) {
    figures.frame_us = std::max({figures.frame_us, command.host.end_us, command.device.end_us});
    const bool is_wait =
        command.kind == GpuCommandKind::poll || command.kind == GpuCommandKind::wait;
    if (is_wait) {
      figures.waits_us += command.host.end_us - command.host.begin_us;
    } else {
      figures.device_us += command.device.end_us - command.device.begin_us;
    }
    if (command.kind == GpuCommandKind::draw) figures.draws += command.count;
    if (command.kind == GpuCommandKind::query) {
      ++figures.queries;
      figures.boxes += command.count;
    }
    if (command.changes_state) ++figures.state_changes;
  }
  return figures;
}

Image render_query_timeline(const TimelineInput& input) {
  if (input.rows.empty()) throw std::logic_error("render_query_timeline: a row is needed");
  const double bottom = title_height + row_height * static_cast<double>(input.rows.size());
  Canvas canvas(static_cast<int>(picture_width),
                static_cast<int>(bottom + foot_height + legend_height), paper);
  canvas.text(margin, 28.0, picture_width - 2.0 * margin, 19.0, true, input.title);
  Timeline timeline(canvas);
  for (std::size_t i = 0; i < input.rows.size(); ++i) {
    timeline.row(input.rows[i], title_height + row_height * static_cast<double>(i));
  }
  canvas.text(lane_left, bottom + 8.0, lane_width, 14.0, false,
              "ms since the frame began, each method to its own scale");
  timeline.legend(bottom + foot_height);
  return canvas.image();
}

}  // namespace vislab
