// Ways of a camera through a scene, as poses over time; a path samples them (library.h, load_path).
#pragma once

#include <functional>
#include <vector>

#include "common/geometry/camera.h"
#include "common/scene/scene.h"

namespace vislab {

/// Poses over u from 0 to 1. The end of a loop is its beginning.
struct Track {
  std::function<Pose(double)> pose;
  bool loop = false;

  /// `frames` > 0 poses, equally spaced: a loop leaves its end out, any other way includes it.
  std::vector<Pose> sampled(int frames) const;
  /// The times u of those poses.
  std::vector<double> times(int frames) const;
};

/// `heading` is about the y axis: 0 looks along +x, a quarter turn along -z. `pitch` looks up.
Pose heading_pose(const glm::dvec3& eye, double heading_rad, double pitch_rad);

struct OrbitParameters {
  double distance = 1.5;  // from the centre, in radii of the box's circumscribed sphere
  double swing = 0.4;     // how far the distance goes up and down, in radii, twice in the orbit
  double elevation_deg = 25.0;  // highest and lowest
  double turns = 1.0;           // round the scene; whole, for the way to close
};

/// Round the scene, looking to points beside its centre, so that the scene fills the image and
/// parts of it leave the image at times. The eye stays outside of the scene's box, which needs
/// distance - swing > 1.
Track orbit_track(const Aabb& bounds, const OrbitParameters& parameters);

/// On the spot, about the vertical, looking up by a pitch.
Track turn_track(const glm::dvec3& eye, double degrees, double pitch_rad);

/// A pose turned about its view: its up goes to its left.
Pose rolled(const Pose& pose, double angle_rad);

/// A pose turned about its up: it looks to what was on its right.
Pose turned_right(const Pose& pose, double angle_rad);

/// Along straight lines through two points or more, looking where it goes and turning at the
/// corners; beside that it turns round `turns` times on the whole way.
Track walk_track(const std::vector<glm::dvec3>& points, double turns);

/// Along straight lines at a constant speed, looking to `target` all the time; it must lie off
/// them.
Track gazing_track(const std::vector<glm::dvec3>& points, const glm::dvec3& target);

/// Another way, which is no loop, with `stops` halts of equal length that together take half the
/// time.
Track stop_and_go_track(const Track& way, int stops);

/// The beginning of another way, as far as `share` of its time, taken in all of the time: as slow.
Track beginning_track(const Track& way, double share);

/// From eye to eye without a way between, each looking at its target; equally long everywhere. As
/// many targets as eyes, each different from its eye.
Track cut_track(const std::vector<glm::dvec3>& eyes, const std::vector<glm::dvec3>& targets);

/// One after the other.
Track list_track(std::vector<Pose> poses);

/// Between places that players of a Quake III world reach: at each, the camera looks about, a third
/// of a turn to the more open side, and goes to the nearest other place in reach: not farther than
/// 15 m, in a free straight line (walls keep half a metre off). If there is none, it appears at the
/// nearest. `places` at most, from the first in the file on. Needs scene.quake with a place.
Track quake_track(const Scene& scene, int places);

/// Through a Quake III world on foot: between places that players reach, which lie far from each
/// other, on the shortest ways through the openings between its leaves that a walker's body fits
/// through, along straight lines where those are free. At each place the camera looks about, a
/// third of a turn. `places` at most, from the first in the file on; those that cannot be reached
/// without opening a door are left out. Needs scene.quake with a place.
Track quake_tour_track(const Scene& scene, int places);

/// Through the portals from cell to cell, by the first portal that does not lead back, until the
/// first cell is reached again; `eye_height_m` above the portals' lower edges. Needs a portal out
/// of cell 0.
Track portal_track(const Scene& scene, double eye_height_m);

/// Through doors and openings in floors, not through windows, from cell 0 into as many as `rooms`
/// cells, depth first: what is reached through a cell's first portal is seen before its next one.
/// It keeps to straight lines from 0.6 m behind a door to 0.6 m before the next, which are free in
/// convex rooms; `eye_height_m` above the doors' lower edges. Without a pose if no door leads out
/// of cell 0.
Track room_tour_track(const Scene& scene, int rooms, double eye_height_m);

/// The building stone of walks: where the camera is and looks at a time. Between two waypoints all
/// is interpolated linearly; at a jump the camera appears at once.
struct Waypoint {
  double time = 0.0;
  glm::dvec3 eye{0.0};
  double heading_rad = 0.0;
  double pitch_rad = 0.0;
  bool jump = false;
};

/// Collects waypoints of a walker with a constant speed on its way and in its turns.
class Walker {
 public:
  Walker(const glm::dvec3& eye, double heading_rad);

  void turn_by(double radians);
  /// Turns towards a point, the shorter way round, then goes there.
  void go_to(const glm::dvec3& point);
  /// Appears at a point and looks along `heading_rad`.
  void appear_at(const glm::dvec3& point, double heading_rad);
  const glm::dvec3& eye() const { return way_.back().eye; }
  double heading_rad() const { return way_.back().heading_rad; }
  Track track() const;

 private:
  void wait(double time, const glm::dvec3& eye, double heading_rad, double pitch_rad);

  std::vector<Waypoint> way_;
};

}  // namespace vislab
