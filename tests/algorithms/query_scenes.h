// Short plays for methods that ask a device: what they have in common, whatever the method.
// Test-only.
#pragma once

#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/query_play.h"

namespace vislab {

inline constexpr Viewport query_viewport{127, 95};

inline Camera looking(const glm::dvec3& eye, const glm::dvec3& target) {
  return {look_at(eye, target),
          perspective_lens(degrees(60.0), query_viewport.aspect(), 0.3, 3000.0)};
}

/// A scene in which only the camera moves: a frame for each.
inline Play finished(Scene scene, const std::vector<Camera>& cameras) {
  Play play;
  play.scene = std::move(scene);
  play.scene.finish();
  for (const Camera& camera : cameras) play.steps.push_back({camera, {}});
  return play;
}

inline Scene small_city() {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 6;
  parameters.roof_share = 0.5;
  parameters.street_boxes = 40;
  return make_city(parameters);
}

inline Scene small_plant() {
  PlantParameters parameters;
  parameters.bays_x = 4;
  parameters.bays_z = 2;
  parameters.segments = 4;
  return make_plant(parameters);
}

/// A step along a street of the small city, then cuts.
inline Play street() {
  return finished(
      small_city(),
      {looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0}), looking({0.0, 1.7, 43.0}, {0.0, 1.7, 0.0}),
       looking({0.0, 1.7, 0.0}, {20.0, 4.0, 0.0}), looking({0.0, 1.7, 0.0}, {-20.0, 4.0, 3.0}),
       looking({12.5, 1.7, 1.0}, {0.0, 8.0, -30.0})});
}

inline Play among_pipes() {
  return finished(small_plant(), {looking({-14.0, 1.7, 0.0}, {17.0, 1.7, 0.0}),
                                  looking({-12.0, 1.7, 0.0}, {17.0, 1.7, 1.0}),
                                  looking({17.0, 1.7, 11.0}, {-14.0, 1.7, 0.0}),
                                  looking({17.0, 1.7, 11.0}, {-14.0, 1.7, 0.0})});
}

/// A wall before targets moves aside and back; it and targets disappear and come back.
inline Play changing_objects() {
  MovingWallParameters parameters;
  parameters.targets = 300;
  const Camera camera = looking({0.0, 5.0, 12.0}, {0.0, 4.5, 0.0});
  Play play = finished(make_moving_wall(parameters), std::vector<Camera>(7, camera));
  const auto wall_at = [&](std::size_t step, const glm::dvec3& place) {
    play.steps[step].changes.moved = {0};
    play.steps[step].changes.transforms = {placed(place, {10.0, 6.0, 0.15})};
  };
  wall_at(2, {8.0, 6.0, 0.0});
  wall_at(3, {0.0, 6.0, 0.0});
  play.steps[4].changes.hidden = {0, 3, 4, 5};
  play.steps[5].changes.shown = {0, 4};
  play.steps[5].changes.hidden = {7, 8, 9, 10};
  play.steps[6].changes.shown = {3, 5, 7, 8};
  return play;
}

/// A hall around everything, a sphere whose box holds the eye though it does not, a wall, and
/// spheres behind it, from places in boxes and so near to faces that the near plane cuts them.
inline Play eye_in_boxes() {
  Scene scene;
  scene.meshes = {cube_mesh(), sphere_mesh(8)};
  scene.objects = {{0, placed({0.0, 0.0, 0.0}, glm::dvec3(60.0)), none_id},
                   {1, placed({0.0, 0.0, 0.0}, glm::dvec3(3.0)), none_id},
                   {0, placed({0.0, 0.0, -10.0}, {20.0, 20.0, 0.2}), none_id}};
  for (int i = 0; i < 20; ++i) {
    scene.objects.push_back({1, placed({1.5 * (i - 10), 0.3 * i, -20.0}), none_id});
  }
  return finished(
      std::move(scene),
      {looking({2.5, 2.5, 2.5}, {0.0, 0.0, -10.0}), looking({0.0, 0.0, -9.6}, {0.0, 0.0, -20.0}),
       looking({0.1, 0.0, -9.9}, {8.0, 0.0, -12.0}), looking({0.0, 0.0, 2.9}, {0.0, 0.0, -20.0})});
}

/// Thousands of small objects around the eye and before it.
inline Play thousands_of_boxes(double min_half_size_m = 1.0, double max_half_size_m = 4.0) {
  BoxFieldParameters parameters;
  parameters.count = 4000;
  parameters.extent_m = 60.0;
  parameters.min_half_size_m = min_half_size_m;
  parameters.max_half_size_m = max_half_size_m;
  return finished(make_box_field(parameters), {looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.2}),
                                               looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.3}),
                                               looking({70.0, 9.0, 0.0}, {0.0, 0.0, 0.0})});
}

inline std::uint64_t kept(const std::vector<QueryFrame>& frames) {
  std::uint64_t sum = 0;
  for (const QueryFrame& frame : frames) sum += frame.kept.size();
  return sum;
}

inline DeviceCounts counts(std::span<const QueryFrame> frames) {
  DeviceCounts sum;
  for (const QueryFrame& frame : frames) {
    sum.queries += frame.counts.queries;
    sum.query_boxes += frame.counts.query_boxes;
    sum.state_changes += frame.counts.state_changes;
    sum.flushes += frame.counts.flushes;
    sum.waits += frame.counts.waits;
  }
  return sum;
}

}  // namespace vislab
