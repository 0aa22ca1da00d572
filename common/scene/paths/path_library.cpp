// Path descriptions: TOML files that name a kind of way and its parameters (data/paths).
#include <algorithm>
#include <numbers>
#include <optional>

#include "common/scene/error.h"
#include "common/scene/file_bytes.h"
#include "common/scene/library.h"
#include "common/scene/paths/lens_fit.h"
#include "common/scene/paths/motion_settings.h"
#include "common/scene/paths/path_points.h"
#include "common/scene/paths/recorded.h"
#include "common/scene/paths/tracks.h"
#include "common/scene/quake_world.h"
#include "common/scene/settings.h"

namespace vislab {
namespace {

constexpr int default_frames = 60;
constexpr int default_places = 4;

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// A way with what a camera needs beside it, and what moves meanwhile.
struct Plan {
  Track track;
  int frames = default_frames;
  LensWishes lens;
  double off_axis_rad = 0.0;
  double roll_rad = 0.0;
  double eye_offset_m = 0.0;
  std::optional<Motion> motion;
};

Track read_orbit(const Settings& settings, const Scene& scene) {
  OrbitParameters orbit;
  orbit.swing = settings.number("swing", 0.0, 1000.0, orbit.swing);
  orbit.distance = settings.number("distance", 1.01 + orbit.swing, 1000.0, orbit.distance);
  orbit.elevation_deg = settings.number("elevation_deg", -89.0, 89.0, orbit.elevation_deg);
  orbit.turns = static_cast<double>(settings.whole("turns", -100, 100, 1));
  return orbit_track(framed(scene), orbit);
}

/// Looks to `target` if there is one, else where it goes.
Track read_walk(const Settings& settings, const PathPoints& points) {
  const std::vector<glm::dvec3> way = points.list(settings, "points", 2);
  if (!settings.has("target")) return walk_track(way, settings.number("turns", -100.0, 100.0, 0.0));
  return gazing_track(way, points.one(settings, "target"));
}

/// By `degrees` in all, or by `degrees_per_frame`, whatever the number of frames.
Track read_turn(const Settings& settings, const PathPoints& points, int frames) {
  const glm::dvec3 eye = points.one(settings, "eye");
  const double pitch_rad = radians(settings.number("pitch_deg", -90.0, 90.0, 0.0));
  if (!settings.has("degrees_per_frame")) {
    return turn_track(eye, settings.number("degrees", -3600.0, 3600.0, 360.0), pitch_rad);
  }
  if (settings.has("degrees")) {
    throw InputError(settings.where() + ": give `degrees` or `degrees_per_frame`, not both");
  }
  const double each_deg = settings.number("degrees_per_frame", -360.0, 360.0);
  Track track = turn_track(eye, each_deg * std::max(frames - 1, 1), pitch_rad);
  track.loop = false;
  return track;
}

Track read_cut(const Settings& settings, const PathPoints& points) {
  const std::vector<glm::dvec3> eyes = points.list(settings, "eyes", 1);
  const std::vector<glm::dvec3> targets = points.list(settings, "targets", 1);
  if (eyes.size() != targets.size()) {
    throw InputError(settings.where() + ": there must be as many targets as eyes");
  }
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    if (eyes[i] == targets[i]) {
      throw InputError(settings.where() + ": target " + std::to_string(i) + " is at its eye");
    }
  }
  return cut_track(eyes, targets);
}

void require_places(const Scene& scene, const std::string& where) {
  if (!scene.quake || scene.quake->places.empty()) {
    throw InputError(where + ": a way between places needs a Quake III world with places where " +
                     "players start or find something");
  }
}

Track checked_portal_track(const Scene& scene, double eye_height_m, const std::string& where) {
  const bool leads_out = std::any_of(scene.portals.begin(), scene.portals.end(),
                                     [](const Portal& portal) { return portal.from == 0; });
  if (!leads_out) throw InputError(where + ": a way through portals needs a scene with portals");
  return portal_track(scene, eye_height_m);
}

Track checked_room_tour(const Settings& settings, const Scene& scene) {
  const auto rooms = static_cast<int>(settings.whole("rooms", 2, 100'000, 12));
  Track track = room_tour_track(scene, rooms, settings.number("eye_height_m", 0.0, 100.0, 1.6));
  if (!track.pose) {
    throw InputError(settings.where() + ": a way through rooms needs a scene with a door out of " +
                     "its first cell");
  }
  return track;
}

/// The number of frames that is asked for, or the description's, or `own`.
int frames_of(const Settings& settings, int asked, int own) {
  const auto described = static_cast<int>(settings.whole("frames", 1, 1'000'000, own));
  return asked > 0 ? asked : described;
}

Track read_recorded(const std::filesystem::path& file, int& frames) {
  std::vector<Pose> poses = read_recorded_poses(file);
  frames = static_cast<int>(poses.size());
  return list_track(std::move(poses));
}

/// The way of a kind that is not recorded.
Track read_track(const Settings& settings, const PathPoints& points, const Scene& scene,
                 const std::string& kind, int frames) {
  if (kind == "orbit") return read_orbit(settings, scene);
  if (kind == "turn") return read_turn(settings, points, frames);
  if (kind == "walk") return read_walk(settings, points);
  if (kind == "stop_and_go") {
    const auto stops = static_cast<int>(settings.whole("stops", 1, 1000));
    return stop_and_go_track(read_walk(settings, points), stops);
  }
  if (kind == "cut") return read_cut(settings, points);
  if (kind == "places" || kind == "tour") {
    const auto places = static_cast<int>(settings.whole("places", 1, 1000, default_places));
    require_places(scene, settings.where());
    return kind == "tour" ? quake_tour_track(scene, places) : quake_track(scene, places);
  }
  if (kind == "portals") {
    const double height = settings.number("eye_height_m", 0.0, 100.0, 1.6);
    return checked_portal_track(scene, height, settings.where());
  }
  if (kind == "rooms") return checked_room_tour(settings, scene);
  throw InputError(settings.where() + ": " +
                   unknown_name("kind of path", kind,
                                {"cut", "orbit", "places", "portals", "recorded", "rooms",
                                 "stop_and_go", "tour", "turn", "walk"})
                       .what());
}

/// `frames` > 0 is the number that is asked for.
Plan read_plan(const std::filesystem::path& file, const Scene& scene, int frames) {
  const Settings settings = Settings::from_file(file);
  const PathPoints points(settings, scene);
  Plan plan;
  settings.text("description", "");
  plan.lens = read_lens_wishes(settings);
  plan.off_axis_rad = radians(settings.number("off_axis_deg", -90.0, 90.0, 0.0));
  plan.roll_rad = radians(settings.number("roll_deg", -180.0, 180.0, 0.0));
  plan.eye_offset_m = settings.number("eye_offset_m", -1e6, 1e6, 0.0);
  const std::string kind = settings.text("kind");
  if (kind == "recorded") {
    plan.track = read_recorded(file.parent_path() / settings.text("file"), plan.frames);
    plan.frames = frames_of(settings, frames, plan.frames);
  } else {
    plan.frames = frames_of(settings, frames, plan.frames);
    plan.track = read_track(settings, points, scene, kind, plan.frames);
    const double share = settings.number("part", 1e-6, 1.0, 1.0);
    if (share < 1.0) plan.track = beginning_track(plan.track, share);
  }
  if (settings.has("motion")) plan.motion = read_motion(settings.table("motion"), points, scene);
  settings.done();
  return plan;
}

Plan fitted_plan(const Scene& scene, int frames) {
  Plan plan;
  plan.track = scene.quake && !scene.quake->places.empty()
                   ? quake_track(scene, default_places)
                   : orbit_track(framed(scene), OrbitParameters());
  if (frames > 0) plan.frames = frames;
  return plan;
}

/// The way's poses, each turned aside, about its view, and put to its right as the plan says.
std::vector<Pose> poses_of(const Plan& plan) {
  std::vector<Pose> poses = plan.track.sampled(plan.frames);
  for (Pose& pose : poses) {
    if (plan.off_axis_rad != 0.0) pose = turned_right(pose, plan.off_axis_rad);
    if (plan.roll_rad != 0.0) pose = rolled(pose, plan.roll_rad);
    if (plan.eye_offset_m != 0.0) pose.eye += pose.right * plan.eye_offset_m;
  }
  return poses;
}

Path path_of(const Plan& plan, const Scene& scene, double aspect) {
  const std::vector<Pose> poses = poses_of(plan);
  std::vector<Changes> changes(poses.size());
  Aabb box = framed(scene);
  if (plan.motion) {
    changes = changes_of(*plan.motion, scene, plan.track.times(plan.frames));
    box.extend(reach_of(scene, changes));
  }
  const Lens lens = fitted_lens(plan.lens, poses, box, aspect);
  Path path;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    path.frames.push_back({{poses[i], lens}, std::move(changes[i])});
  }
  return path;
}

/// The description's file, or nothing for a default path.
std::filesystem::path located(const std::string& name_or_file, const DataFolders& folders) {
  if (name_or_file.find_first_of("/.") != std::string::npos) return name_or_file;
  const std::filesystem::path folder = folders.data / "paths";
  std::filesystem::path file = folder / (name_or_file + ".toml");
  if (std::filesystem::exists(file)) return file;
  std::vector<std::string> known;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") known.push_back(entry.path().stem().string());
  }
  std::sort(known.begin(), known.end());
  throw unknown_name("path or file", name_or_file, known);
}

}  // namespace

Path load_path(const std::string& name_or_file, const Scene& scene, const Viewport& viewport,
               int frames, const DataFolders& folders) {
  std::string name = "fitted";
  Plan plan;
  if (name_or_file.empty()) {
    plan = fitted_plan(scene, frames);
  } else {
    const std::filesystem::path file = located(name_or_file, folders);
    require_file(file);
    name = file.stem().string();
    if (lower_extension(file) == "json") {
      plan.track = read_recorded(file, plan.frames);
      if (frames > 0) plan.frames = frames;
    } else {
      plan = read_plan(file, scene, frames);
    }
  }
  Path path = path_of(plan, scene, viewport.aspect());
  path.name = name;
  return path;
}

}  // namespace vislab
