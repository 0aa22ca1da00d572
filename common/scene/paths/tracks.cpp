#include "common/scene/paths/tracks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vislab {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;
constexpr double walking_m_s = 3.0;
constexpr double turning_rad_s = full_turn / 4.0;

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// The pose of a way at a time; `way` has a waypoint or more, in the order of time.
Pose pose_at(const std::vector<Waypoint>& way, double time) {
  const auto after = std::upper_bound(way.begin(), way.end(), time,
                                      [](double t, const Waypoint& w) { return t < w.time; });
  const Waypoint& to = after == way.end() ? way.back() : *after;
  const Waypoint& from = after == way.begin() ? way.front() : *(after - 1);
  const double span = to.time - from.time;
  const double share = span > 0.0 && !to.jump ? (time - from.time) / span : 0.0;
  const auto mix = [&](double a, double b) { return a + (b - a) * share; };
  return heading_pose(from.eye + (to.eye - from.eye) * share, mix(from.heading_rad, to.heading_rad),
                      mix(from.pitch_rad, to.pitch_rad));
}

}  // namespace

std::vector<double> Track::times(int frames) const {
  const int steps = loop ? frames : std::max(frames - 1, 1);
  std::vector<double> times;
  for (int i = 0; i < frames; ++i) times.push_back(static_cast<double>(i) / steps);
  return times;
}

std::vector<Pose> Track::sampled(int frames) const {
  std::vector<Pose> poses;
  for (const double u : times(frames)) poses.push_back(pose(u));
  return poses;
}

Pose heading_pose(const glm::dvec3& eye, double heading_rad, double pitch_rad) {
  const glm::dvec3 forward(std::cos(pitch_rad) * std::cos(heading_rad), std::sin(pitch_rad),
                           -std::cos(pitch_rad) * std::sin(heading_rad));
  return look_at(eye, eye + forward);
}

Track orbit_track(const Aabb& bounds, const OrbitParameters& parameters) {
  const glm::dvec3 center = bounds.center();
  const double radius = glm::length(bounds.half_size());
  const auto pose = [=](double u) {
    const double angle = full_turn * u;
    const double distance = radius * (parameters.distance + parameters.swing * std::cos(2 * angle));
    const double elevation = radians(parameters.elevation_deg) * std::sin(angle);
    const double azimuth = parameters.turns * angle;
    const glm::dvec3 outward(std::cos(elevation) * std::cos(azimuth), std::sin(elevation),
                             -std::cos(elevation) * std::sin(azimuth));
    const glm::dvec3 sideways(-std::sin(azimuth), 0.0, -std::cos(azimuth));
    const glm::dvec3 target = center + sideways * (0.4 * radius * std::sin(3 * angle));
    return look_at(center + outward * distance, target);
  };
  return {pose, true};
}

Track turn_track(const glm::dvec3& eye, double degrees, double pitch_rad) {
  const auto pose = [=](double u) { return heading_pose(eye, radians(degrees) * u, pitch_rad); };
  return {pose, std::abs(degrees) == 360.0};
}

Pose rolled(const Pose& pose, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return {pose.eye, pose.right * c + pose.up * s, pose.up * c - pose.right * s, pose.back};
}

Pose turned_right(const Pose& pose, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return {pose.eye, pose.right * c + pose.back * s, pose.up, pose.back * c - pose.right * s};
}

Track walk_track(const std::vector<glm::dvec3>& points, double turns) {
  const glm::dvec3 first = points[1] - points[0];
  Walker walker(points[0], std::atan2(-first.z, first.x));
  for (std::size_t i = 1; i < points.size(); ++i) walker.go_to(points[i]);
  const Track way = walker.track();
  const auto pose = [=](double u) {
    const Pose straight = way.pose(u);
    const double angle = full_turn * turns * u;
    const auto spun = [&](const glm::dvec3& v) {
      return glm::dvec3(v.x * std::cos(angle) + v.z * std::sin(angle), v.y,
                        v.z * std::cos(angle) - v.x * std::sin(angle));
    };
    return Pose{straight.eye, spun(straight.right), spun(straight.up), spun(straight.back)};
  };
  return {pose, false};
}

Track gazing_track(const std::vector<glm::dvec3>& points, const glm::dvec3& target) {
  std::vector<Waypoint> way{{0.0, points[0], 0.0, 0.0, false}};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double time = way.back().time + glm::distance(points[i - 1], points[i]);
    way.push_back({time, points[i], 0.0, 0.0, false});
  }
  const auto pose = [way, target](double u) {
    return look_at(pose_at(way, u * way.back().time).eye, target);
  };
  return {pose, false};
}

Track stop_and_go_track(const Track& way, int stops) {
  const auto pose = [=](double u) {
    // One round is half a stage of going, then half of standing.
    const double stage = u * stops;
    const double whole = std::min(std::floor(stage), stops - 1.0);
    return way.pose((whole + std::min(2.0 * (stage - whole), 1.0)) / stops);
  };
  return {pose, false};
}

Track beginning_track(const Track& way, double share) {
  return {[=](double u) { return way.pose(u * share); }, false};
}

Track cut_track(const std::vector<glm::dvec3>& eyes, const std::vector<glm::dvec3>& targets) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < eyes.size(); ++i) poses.push_back(look_at(eyes[i], targets[i]));
  return list_track(std::move(poses));
}

Track list_track(std::vector<Pose> poses) {
  const auto pose = [poses = std::move(poses)](double u) {
    // i / n * n may fall just short of i; a list sampled at its own length gives every pose once.
    const double position = std::floor(u * static_cast<double>(poses.size()) + 1e-9);
    return poses[std::min(static_cast<std::size_t>(position), poses.size() - 1)];
  };
  return {pose, true};
}

Walker::Walker(const glm::dvec3& eye, double heading_rad) {
  way_.push_back({0.0, eye, heading_rad, 0.0, false});
}

void Walker::wait(double time, const glm::dvec3& eye, double heading_rad, double pitch_rad) {
  way_.push_back({way_.back().time + time, eye, heading_rad, pitch_rad, false});
}

void Walker::turn_by(double radians_left) {
  const Waypoint last = way_.back();
  wait(std::abs(radians_left) / turning_rad_s, last.eye, last.heading_rad + radians_left,
       last.pitch_rad);
}

void Walker::go_to(const glm::dvec3& point) {
  const glm::dvec3 step = point - way_.back().eye;
  const double flat = std::hypot(step.x, step.z);
  if (flat > 0.0) {
    turn_by(std::remainder(std::atan2(-step.z, step.x) - way_.back().heading_rad, full_turn));
  }
  way_.back().pitch_rad = std::atan2(step.y, flat);
  const Waypoint last = way_.back();
  wait(glm::length(step) / walking_m_s, point, last.heading_rad, last.pitch_rad);
}

void Walker::appear_at(const glm::dvec3& point, double heading_rad) {
  way_.push_back({way_.back().time, point, heading_rad, 0.0, true});
}

Track Walker::track() const {
  return {[way = way_](double u) { return pose_at(way, u * way.back().time); }, false};
}

}  // namespace vislab
