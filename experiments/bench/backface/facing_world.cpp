#include "experiments/bench/backface/facing_world.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>

#include "algorithms/backface/back_bits.h"
#include "common/scene/generators/generators.h"
#include "common/scene/library.h"

namespace vislab {
namespace {

using backface_culling::words_of;

constexpr std::uint32_t subdivisions = 289;
constexpr std::size_t eyes = 64;
constexpr double distance = 3.0;

DataFolders folders() {
  const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
  return {data, data / "cache"};
}

Scene bumpy_sphere(Bumps bumps) {
  return make_bumpy_sphere({subdivisions, bumps, 0.0, glm::dvec3(0.0)});
}

/// The mesh alone, where its own frame has it.
Scene scene_of(const std::string& name) {
  if (name == "sphere") return bumpy_sphere(Bumps::none);
  if (name == "low") return bumpy_sphere(Bumps::low);
  if (name == "high") return bumpy_sphere(Bumps::high);
  Scene scene;
  scene.meshes.push_back(std::move(load_scene(name, folders()).scene.meshes.front()));
  scene.objects = {{0, glm::dmat4x3(1.0), none_id}};
  return scene;
}

/// Evenly spread directions: steps of the golden angle along a spiral from pole to pole.
glm::dvec3 direction(std::size_t index) {
  const double height = 1.0 - (2.0 * static_cast<double>(index) + 1.0) / eyes;
  const double turn = static_cast<double>(index) * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt(1.0 - height * height);
  return {radius * std::cos(turn), radius * std::sin(turn), height};
}

/// Surely behind the triangle's plane: the determinant of the three ways from a corner in double is
/// off by less than 16 epsilons of its terms, the rounding of the ways included.
bool is_back(const Mesh& mesh, const glm::uvec3& triangle, const glm::dvec3& eye) {
  const glm::dvec3 a(mesh.positions[triangle.x]);
  const glm::dvec3 u = glm::dvec3(mesh.positions[triangle.y]) - a;
  const glm::dvec3 v = glm::dvec3(mesh.positions[triangle.z]) - a;
  const glm::dvec3 way = eye - a;
  const glm::dvec3 forward(u.y * v.z, u.z * v.x, u.x * v.y);
  const glm::dvec3 backward(u.z * v.y, u.x * v.z, u.y * v.x);
  const double terms = glm::dot(glm::abs(forward) + glm::abs(backward), glm::abs(way));
  return glm::dot(forward - backward, way) < -16.0 * std::numeric_limits<double>::epsilon() * terms;
}

}  // namespace

FacingWorld::FacingWorld(const std::string& name) : scene_(scene_of(name)) {
  scene_.finish();
  state_ = std::make_unique<SceneState>(scene_);
  const glm::dvec3 middle(mesh().bounds.center());
  const glm::vec3 sides = mesh().bounds.max - mesh().bounds.min;
  const double size = 0.5 * double(std::max({sides.x, sides.y, sides.z}));
  for (std::size_t i = 0; i < eyes; ++i) {
    const glm::dvec3 eye = middle + distance * size * direction(i);
    cameras_.push_back({look_at(eye, middle),
                        perspective_lens(std::numbers::pi / 3.0, 1.0, 0.1 * size, 10.0 * size)});
    std::vector<std::uint64_t>& bits = back_.emplace_back(words_of(mesh().triangles.size()), 0);
    for (std::size_t t = 0; t < mesh().triangles.size(); ++t) {
      const bool back = is_back(mesh(), mesh().triangles[t], eye);
      bits[t / 64] |= std::uint64_t{back} << (t % 64);
      back_count_ += back ? 1 : 0;
    }
  }
}

std::shared_ptr<const FacingWorld> FacingWorld::of(const std::string& name) {
  static std::map<std::string, std::weak_ptr<const FacingWorld>> made;
  std::shared_ptr<const FacingWorld> world = made[name].lock();
  if (!world) {
    world.reset(new FacingWorld(name));
    made[name] = world;
  }
  return world;
}

std::vector<std::string> FacingWorld::scanned() {
  if (!std::filesystem::exists(folders().cache / "libcgal-demo")) return {};
  return {"bunny", "elephant_refined"};
}

Frame FacingWorld::frame(std::size_t eye) const {
  return {eye, cameras_[eye], Viewport{512, 512}, state_->view(), 0.0};
}

void LeftOut::count(const FacingWorld& world, std::size_t eye,
                    std::span<const std::uint64_t> left_out) {
  const std::span<const std::uint64_t> truth = world.back(eye);
  for (std::size_t word = 0; word < truth.size(); ++word) {
    back += static_cast<std::uint64_t>(std::popcount(left_out[word] & truth[word]));
    not_back += static_cast<std::uint64_t>(std::popcount(left_out[word] & ~truth[word]));
  }
}

double LeftOut::share(const FacingWorld& world) const {
  return static_cast<double>(back) / static_cast<double>(world.back_count());
}

}  // namespace vislab
