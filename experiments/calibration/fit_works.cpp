#include "experiments/calibration/fit_works.h"

#include <numbers>
#include <utility>

#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

using Step = FitWorks::Step;
using Kind = FitWorks::Step::Kind;

constexpr std::uint32_t sphere_subdivisions = 32;
constexpr std::uint32_t boxes_a_side = 24;
constexpr std::uint32_t walls = 12;
/// Queries that are handed over together, as methods do. OSMesa's scenes take memory anew where
/// more than about twice as many wait, and a query costs twice as much.
constexpr std::uint32_t queries_at_once = 16;

// Meshes that are open are not tested for being solid, which takes long.

/// From -1 to 1, without its lower side, two triangles a side.
Mesh open_box() {
  Mesh mesh;
  mesh.name = "box";
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {(i & 1) != 0 ? 1.0F : -1.0F, (i & 2) != 0 ? 1.0F : -1.0F, (i & 4) != 0 ? 1.0F : -1.0F});
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {2, 6, 7},
                    {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

Mesh wall() {
  Mesh mesh;
  mesh.name = "wall";
  mesh.positions = {
      {-1.0F, -1.0F, 0.0F}, {1.0F, -1.0F, 0.0F}, {1.0F, 1.0F, 0.0F}, {-1.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

glm::dmat4x3 placed(double scale, const glm::dvec3& place) {
  glm::dmat4x3 transform(scale);
  transform[3] = place;
  return transform;
}

Aabb cube(const glm::dvec3& middle, double half_side) {
  return {middle - glm::dvec3(half_side), middle + glm::dvec3(half_side)};
}

// Objects: spheres, walls from near to far, then fields of boxes.
constexpr ObjectId near_sphere = 0, far_sphere = 1, unseen_sphere = 2, first_wall = 3;
constexpr ObjectId first_box = first_wall + walls;
constexpr std::uint32_t boxes_a_field = boxes_a_side * boxes_a_side;
enum Field : std::uint32_t { small_boxes, large_boxes, unseen_boxes };

std::vector<ObjectId> field(Field which, std::uint32_t count = boxes_a_field) {
  std::vector<ObjectId> objects;
  for (std::uint32_t i = 0; i < count; ++i) {
    objects.push_back(first_box + which * boxes_a_field + i);
  }
  return objects;
}

std::vector<ObjectId> wall_objects(bool near_first) {
  std::vector<ObjectId> objects;
  for (std::uint32_t i = 0; i < walls; ++i) {
    objects.push_back(first_wall + (near_first ? i : walls - 1 - i));
  }
  return objects;
}

/// Place i of a grid over the image, at a depth.
glm::dvec3 place_of(std::uint32_t i, double depth_m) {
  const double spacing = 1.4 * depth_m / boxes_a_side;
  return {spacing * (i % boxes_a_side + 0.5) - 0.7 * depth_m,
          spacing * (i / boxes_a_side % boxes_a_side + 0.5) - 0.7 * depth_m, -depth_m};
}

Step draw(std::vector<ObjectId> objects) { return {Kind::draw, std::move(objects), {}}; }

/// So many boxes, the first at place `first` of the grid.
Step ask(std::uint32_t first, std::uint32_t count, double depth_m, double half_side_m) {
  Step step{Kind::ask, {}, {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    step.boxes.push_back(cube(place_of(first + i, depth_m), half_side_m));
  }
  return step;
}

}  // namespace

FitWorks::FitWorks() {
  add_objects();
  state_ = std::make_unique<SceneState>(scene_);
  frame_.viewport = {512, 512};
  frame_.camera = {look_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}),
                   perspective_lens(75.0 * std::numbers::pi / 180.0, 1.0, 0.1, 200.0)};
  frame_.objects = state_->view();
  add_drawings();
  add_queries();
}

void FitWorks::add_objects() {
  BumpySphereParameters sphere;
  sphere.subdivisions = sphere_subdivisions;
  sphere.hole = 0.001;
  scene_.name = "fit";
  scene_.meshes = {bumpy_sphere_mesh(sphere), wall(), open_box()};
  scene_.objects = {{0, placed(1.0, {0.0, 0.0, -2.0}), none_id},
                    {0, placed(1.0, {0.0, 0.0, -20.0}), none_id},
                    {0, placed(1.0, {0.0, 0.0, 5.0}), none_id}};
  for (std::uint32_t i = 0; i < walls; ++i) {
    const double depth_m = 4.0 + i;
    scene_.objects.push_back({1, placed(depth_m, {0.0, 0.0, -depth_m}), none_id});
  }
  for (const auto& [depth_m, half_side_m] :
       {std::pair{10.0, 0.06}, std::pair{30.0, 0.8}, std::pair{-10.0, 0.06}}) {
    for (std::uint32_t i = 0; i < boxes_a_field; ++i) {
      scene_.objects.push_back({2, placed(half_side_m, place_of(i, depth_m)), none_id});
    }
  }
  scene_.finish();
}

void FitWorks::add_drawings() {
  works_.push_back({"nothing", {}});
  works_.push_back({"a sphere", {draw({near_sphere})}});
  works_.push_back({"a far sphere", {draw({far_sphere})}});
  works_.push_back({"an unseen sphere", {draw({unseen_sphere})}});
  works_.push_back({"three spheres", {draw({near_sphere, far_sphere, unseen_sphere})}});
  works_.push_back({"walls, near first", {draw(wall_objects(true))}});
  works_.push_back({"walls, far first", {draw(wall_objects(false))}});
  works_.push_back({"a third of the small boxes", {draw(field(small_boxes, boxes_a_field / 3))}});
  works_.push_back({"small boxes", {draw(field(small_boxes))}});
  works_.push_back({"large boxes", {draw(field(large_boxes))}});
  works_.push_back({"unseen boxes", {draw(field(unseen_boxes))}});
  works_.push_back(
      {"all boxes",
       {draw(field(large_boxes)), draw(field(small_boxes)), draw(field(unseen_boxes))}});
}

void FitWorks::add_queries() {
  const Step background = draw(wall_objects(false));
  const auto batches = [&](std::uint32_t queries, std::uint32_t boxes_each, double half_side_m,
                           std::uint32_t at_once = queries_at_once) {
    std::vector<Step> steps{background, {Kind::flush}};
    for (std::uint32_t i = 0; i < queries; ++i) {
      steps.push_back(ask(i * boxes_each, boxes_each, 9.0, half_side_m));
      if ((i + 1) % at_once == 0) {
        steps.insert(steps.end(), {{Kind::flush}, {Kind::read}});
      }
    }
    return steps;
  };
  works_.push_back({"64 small queries", batches(64, 1, 0.05)});
  works_.push_back({"256 small queries", batches(256, 1, 0.05)});
  works_.push_back({"64 small queries, each read", batches(64, 1, 0.05, 1)});
  works_.push_back({"256 small queries, each read", batches(256, 1, 0.05, 1)});
  works_.push_back({"64 queries of 8 boxes", batches(64, 8, 0.05)});
  works_.push_back({"16 large queries", batches(16, 1, 2.0)});

  std::vector<Step> turns{background, {Kind::flush}}, alone = turns;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const Step object = draw({first_box + i});
    const Step question = ask(i, 1, 9.0, 0.05);
    turns.insert(turns.end(), {object, question});
    if ((i + 1) % queries_at_once == 0) turns.insert(turns.end(), {{Kind::flush}, {Kind::read}});
    alone.insert(alone.end(), {object, question, {Kind::flush}, {Kind::read}});
  }
  works_.push_back({"64 draws and queries in turns", std::move(turns)});
  works_.push_back({"64 draws and queries, each read", std::move(alone)});
}

}  // namespace vislab
