#include "experiments/analysis/persistence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "algorithms/occlusion/persistence.h"
#include "common/geometry/frustum.h"

namespace vislab {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

bool may_be_in_view(const Frustum& frustum, const Aabb& box) {
  return std::ranges::none_of(frustum.span(),
                              [&](const Plane& plane) { return surely_outside(plane, box); });
}

double turn_deg(const Pose& a, const Pose& b) {
  // The angle of the rotation that takes one pose's axes to the other's.
  const double trace = glm::dot(a.right, b.right) + glm::dot(a.up, b.up) + glm::dot(a.back, b.back);
  return std::acos(std::clamp((trace - 1.0) / 2.0, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// Level (at most 1) and drop (at least 0) of least squares for a given time. Returns the weighted
/// squares.
double fit_at(const std::vector<StillHidden>& after, double time, PersistenceFit& fit) {
  double w = 0.0, wx = 0.0, wy = 0.0, wxx = 0.0, wxy = 0.0, wyy = 0.0;
  for (std::size_t t = 1; t < after.size(); ++t) {
    if (after[t].cases == 0) continue;
    const auto weight = static_cast<double>(after[t].cases);
    const double x = std::exp(-static_cast<double>(t) / time);
    const double y = after[t].share().value;
    w += weight;
    wx += weight * x;
    wy += weight * y;
    wxx += weight * x * x;
    wxy += weight * x * y;
    wyy += weight * y * y;
  }
  const double spread = w * wxx - wx * wx;
  double slope = spread > 0.0 ? (w * wxy - wx * wy) / spread : 0.0;
  slope = std::min(slope, 0.0);
  double level = (wy - slope * wx) / w;
  if (level > 1.0) {
    level = 1.0;
    slope = wxx > 0.0 ? std::min((wxy - wx) / wxx, 0.0) : 0.0;
  }
  fit = {level, 0.0 - slope, time};  // not -0
  return wyy + level * level * w + slope * slope * wxx - 2.0 * level * wy - 2.0 * slope * wxy +
         2.0 * level * slope * wx;
}

nlohmann::ordered_json to_json(const std::vector<StillHidden>& after) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (std::size_t t = 0; t < after.size(); ++t) {
    if (after[t].cases == 0) continue;
    const Estimate share = after[t].share();
    rows.push_back(
        {{"frames", t},
         {"cases", after[t].cases},
         {"still_hidden", after[t].hidden},
         {"share", share.value},
         {"low", share.low},
         {"high", share.high},
         {"formula", occlusion_culling::Persistence::formula(static_cast<std::uint32_t>(t))}});
  }
  return rows;
}

}  // namespace

Estimate StillHidden::share() const {
  if (cases == 0) return Estimate::none();
  constexpr double z = 1.959964;  // 95 %
  const auto n = static_cast<double>(cases);
  const double p = static_cast<double>(hidden) / n;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double reach = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {p, std::max(middle - reach, 0.0), std::min(middle + reach, 1.0)};
}

double PersistenceFit::operator()(double t) const { return level - drop * std::exp(-t / time); }

PersistenceFit PersistenceCounts::fit() const {
  std::size_t known = 0;
  for (std::size_t t = 1; t < after.size(); ++t) known += after[t].cases > 0 ? 1 : 0;
  if (known < 3) return {nothing, nothing, nothing};
  PersistenceFit best;
  double least = std::numeric_limits<double>::infinity();
  for (double time = 0.5; time <= 16.0; time *= 1.05) {
    PersistenceFit fit;
    const double squares = fit_at(after, time, fit);
    if (squares < least) {
      least = squares;
      best = fit;
    }
  }
  return best;
}

PersistenceCounter::PersistenceCounter(std::size_t object_count)
    : past_(object_count), now_(object_count), after_(last_time + 1), after_seen_(last_time + 1) {}

void PersistenceCounter::add(const Frame& frame, std::span<const ObjectId> visible) {
  if (have_camera_) {
    turns_deg_.push_back(turn_deg(camera_.pose, frame.camera.pose));
    steps_m_.push_back(glm::length(frame.camera.pose.eye - camera_.pose.eye));
  }
  camera_ = frame.camera;
  have_camera_ = true;

  const Frustum frustum = frustum_of(frame.camera);
  std::ranges::fill(now_, 0);
  for (const ObjectId object : frame.objects.shown) {
    if (may_be_in_view(frustum, frame.objects.bounds[object])) now_[object] = 1;
  }
  for (const ObjectId object : visible) now_[object] = 2;
  for (std::size_t object = 0; object < past_.size(); ++object) {
    Past& past = past_[object];
    if (now_[object] == 0) {
      past = {};
      continue;
    }
    const bool hidden = now_[object] == 1;
    ++in_view_;
    if (hidden) ++hidden_;
    if (past.in_view) {
      const std::size_t time = std::min<std::size_t>(past.hidden, last_time);
      for (auto* after : {&after_, past.seen_before ? &after_seen_ : nullptr}) {
        if (after == nullptr) continue;
        ++(*after)[time].cases;
        if (hidden) ++(*after)[time].hidden;
      }
    }
    past.in_view = true;
    past.hidden = hidden ? past.hidden + 1 : 0;
    if (!hidden) past.seen_before = true;
  }
}

PersistenceCounts PersistenceCounter::counts() const {
  PersistenceCounts counts;
  counts.after = after_;
  counts.after_seen = after_seen_;
  counts.turn_deg = median(turns_deg_);
  counts.step_m = median(steps_m_);
  counts.hidden_share =
      in_view_ > 0 ? static_cast<double>(hidden_) / static_cast<double>(in_view_) : nothing;
  StillHidden all;
  for (std::size_t t = 1; t < after_.size(); ++t) {
    all.cases += after_[t].cases;
    all.hidden += after_[t].hidden;
  }
  counts.appearing_share = 1.0 - all.share().value;
  return counts;
}

std::string to_json(const std::vector<PersistenceRow>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PersistenceRow& row : rows) {
    const PersistenceCounts& counts = row.counts;
    const PersistenceFit fit = counts.fit();
    list.push_back({{"scene", row.scene},
                    {"path", row.path},
                    {"width_px", row.viewport.width},
                    {"height_px", row.viewport.height},
                    {"frames", row.frames},
                    {"turn_deg", counts.turn_deg},
                    {"step_m", counts.step_m},
                    {"hidden_share", counts.hidden_share},
                    {"appearing_share", counts.appearing_share},
                    {"fit", {{"level", fit.level}, {"drop", fit.drop}, {"time", fit.time}}},
                    {"after", to_json(counts.after)},
                    {"after_seen", to_json(counts.after_seen)}});
  }
  return list.dump(1) + "\n";
}

}  // namespace vislab
