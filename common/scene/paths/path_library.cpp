// Path descriptions: TOML files that name a kind of way and its parameters (data/paths).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "common/scene/error.h"
#include "common/scene/file_bytes.h"
#include "common/scene/library.h"
#include "common/scene/paths/recorded.h"
#include "common/scene/paths/tracks.h"
#include "common/scene/quake_world.h"
#include "common/scene/settings.h"

namespace vislab {
namespace {

constexpr int default_frames = 60;
constexpr int default_places = 4;

/// A way with what a camera needs beside it.
struct Plan {
  Track track;
  int frames = default_frames;
  double fov_deg = 60.0;
  std::optional<double> near_m, far_m;  // fitted to the scene if absent
};

/// The scene's box, or one of 1 m radius around a scene that is a single point: ways and lenses are
/// fitted to it.
Aabb framed(const Scene& scene) {
  const Aabb& box = scene.bounds();
  if (glm::length(box.half_size()) >= 0.5 * min_scene_extent_m) return box;
  const glm::vec3 center(box.center());
  const glm::vec3 reach(static_cast<float>(std::numbers::inv_sqrt3));
  return {center - reach, center + reach};
}

/// Points of a description: in the world, or, if `relative` is set, from the centre of the scene's
/// box in units of the radius of its circumscribed sphere.
class Points {
 public:
  Points(const Settings& settings, const Scene& scene) : settings_(settings) {
    if (settings.flag("relative", false)) {
      const Aabb box = framed(scene);
      center_ = box.center();
      unit_ = glm::length(box.half_size());
    }
  }
  std::vector<glm::dvec3> list(const std::string& key, std::size_t at_least) const {
    std::vector<glm::dvec3> points = settings_.points(key);
    if (points.size() < at_least) {
      throw InputError(settings_.where() + ": `" + key + "` needs at least " +
                       std::to_string(at_least) + " points");
    }
    for (glm::dvec3& p : points) p = center_ + p * unit_;
    return points;
  }
  glm::dvec3 one(const std::string& key) const { return center_ + settings_.point(key) * unit_; }

 private:
  const Settings& settings_;
  glm::dvec3 center_{0.0};
  double unit_ = 1.0;
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
Track read_walk(const Settings& settings, const Points& points) {
  const std::vector<glm::dvec3> way = points.list("points", 2);
  if (!settings.has("target")) return walk_track(way, settings.number("turns", -100.0, 100.0, 0.0));
  return gazing_track(way, points.one("target"));
}

Track read_cut(const Settings& settings, const Points& points) {
  const std::vector<glm::dvec3> eyes = points.list("eyes", 1);
  const std::vector<glm::dvec3> targets = points.list("targets", 1);
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

Track checked_quake_track(const Scene& scene, int places, const std::string& where) {
  if (!scene.quake || scene.quake->places.empty()) {
    throw InputError(where + ": a way between places needs a Quake III world with places where " +
                     "players start or find something");
  }
  return quake_track(scene, places);
}

Track checked_portal_track(const Scene& scene, double eye_height_m, const std::string& where) {
  const bool leads_out = std::any_of(scene.portals.begin(), scene.portals.end(),
                                     [](const Portal& portal) { return portal.from == 0; });
  if (!leads_out) throw InputError(where + ": a way through portals needs a scene with portals");
  return portal_track(scene, eye_height_m);
}

/// `frames` is set to a recorded path's own number and otherwise left as it is.
Track read_track(const Settings& settings, const Scene& scene, const std::filesystem::path& folder,
                 int& frames) {
  const Points points(settings, scene);
  const std::string kind = settings.text("kind");
  if (kind == "orbit") return read_orbit(settings, scene);
  if (kind == "turn") {
    return turn_track(points.one("eye"), settings.number("degrees", -3600.0, 3600.0, 360.0));
  }
  if (kind == "walk") return read_walk(settings, points);
  if (kind == "stop_and_go") {
    const auto stops = static_cast<int>(settings.whole("stops", 1, 1000));
    return stop_and_go_track(read_walk(settings, points), stops);
  }
  if (kind == "cut") return read_cut(settings, points);
  if (kind == "recorded") {
    std::vector<Pose> poses = read_recorded_poses(folder / settings.text("file"));
    frames = static_cast<int>(poses.size());
    return list_track(std::move(poses));
  }
  if (kind == "places") {
    const auto places = static_cast<int>(settings.whole("places", 1, 1000, default_places));
    return checked_quake_track(scene, places, settings.where());
  }
  if (kind == "portals") {
    const double height = settings.number("eye_height_m", 0.0, 100.0, 1.6);
    return checked_portal_track(scene, height, settings.where());
  }
  throw InputError(
      settings.where() + ": " +
      unknown_name("kind of path", kind,
                   {"cut", "orbit", "places", "portals", "recorded", "stop_and_go", "turn", "walk"})
          .what());
}

Plan read_plan(const std::filesystem::path& file, const Scene& scene) {
  const Settings settings = Settings::from_file(file);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Plan plan;
  settings.text("description", "");
  plan.fov_deg = settings.number("fov_deg", 1.0, 179.0, plan.fov_deg);
  if (settings.has("near_m")) plan.near_m = settings.number("near_m", 1e-9, infinity);
  if (settings.has("far_m")) plan.far_m = settings.number("far_m", 1e-9, infinity);
  plan.track = read_track(settings, scene, file.parent_path(), plan.frames);
  plan.frames = static_cast<int>(settings.whole("frames", 1, 1'000'000, plan.frames));
  settings.done();
  return plan;
}

Plan fitted_plan(const Scene& scene) {
  Plan plan;
  plan.track = scene.quake && !scene.quake->places.empty()
                   ? quake_track(scene, default_places)
                   : orbit_track(framed(scene), OrbitParameters());
  return plan;
}

/// One lens for all poses. The far plane is behind everything; the near plane is at half the
/// smallest distance from the scene's box, which the image's corners cannot see past, or, for eyes
/// inside, at a thousandth of the far distance: nearer, a depth buffer of 32 bits no longer tells
/// apart what rays do.
Lens fitted_lens(const Plan& plan, const std::vector<Pose>& poses, const Aabb& bounds,
                 double aspect) {
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = 0.0;
  for (const Pose& pose : poses) {
    nearest = std::min(nearest, std::sqrt(distance_squared(bounds, pose.eye)));
    farthest =
        std::max(farthest, glm::length(glm::abs(pose.eye - bounds.center()) + bounds.half_size()));
  }
  const double far_m = plan.far_m.value_or(1.01 * farthest);
  const double fitted_near = std::max(0.5 * nearest, 1e-3 * far_m);
  const double near_m = plan.near_m.value_or(std::min(fitted_near, 0.5 * far_m));
  if (!(near_m < far_m)) {
    throw InputError("the near plane at " + std::to_string(near_m) +
                     " m must be nearer than the far plane at " + std::to_string(far_m) + " m");
  }
  return perspective_lens(plan.fov_deg * std::numbers::pi / 180.0, aspect, near_m, far_m);
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
  Plan plan;
  Path path;
  if (name_or_file.empty()) {
    plan = fitted_plan(scene);
    path.name = "fitted";
  } else {
    const std::filesystem::path file = located(name_or_file, folders);
    require_file(file);
    path.name = file.stem().string();
    if (lower_extension(file) == "json") {
      const std::vector<Pose> poses = read_recorded_poses(file);
      plan.frames = static_cast<int>(poses.size());
      plan.track = list_track(poses);
    } else {
      plan = read_plan(file, scene);
    }
  }
  if (frames > 0) plan.frames = frames;
  const std::vector<Pose> poses = plan.track.sampled(plan.frames);
  const Lens lens = fitted_lens(plan, poses, framed(scene), viewport.aspect());
  for (const Pose& pose : poses) path.frames.push_back({{pose, lens}, {}});
  return path;
}

}  // namespace vislab
