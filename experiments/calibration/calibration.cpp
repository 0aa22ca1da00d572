#include "experiments/calibration/calibration.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/render/osmesa_device.h"
#include "common/scene/generators/generators.h"
#include "experiments/analysis/statistics.h"
#include "experiments/calibration/cluster_test_cost.h"

namespace vislab {
namespace {

constexpr Viewport viewport{512, 512};
constexpr int repeats = 15;
constexpr int attempts = 5;

// The sphere's triangles are as large in the image as those of a scanned figure that fills it: some
// three pixels.
constexpr std::uint32_t sphere_subdivisions = 48;
constexpr std::uint32_t piece_triangles = 8;
constexpr std::uint32_t tetrahedra_a_side = 32;

// All meshes are open, so that Scene::finish does not find out whether they are solid, which takes
// longer than to calibrate.

/// A tetrahedron without one of its sides.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.name = "tetrahedron";
  mesh.positions = {
      {1.0F, 1.0F, 1.0F}, {1.0F, -1.0F, -1.0F}, {-1.0F, 1.0F, -1.0F}, {-1.0F, -1.0F, 1.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}};
  return mesh;
}

/// Where the small tetrahedra stand: a square grid around the origin.
std::vector<glm::dmat4x3> places() {
  std::vector<glm::dmat4x3> all;
  const double spacing = 2.0 / tetrahedra_a_side;
  for (std::uint32_t i = 0; i < tetrahedra_a_side * tetrahedra_a_side; ++i) {
    glm::dmat4x3& place = all.emplace_back(0.1 * spacing);
    place[3] = {spacing * (i % tetrahedra_a_side + 0.5) - 1.0,
                spacing * (i / tetrahedra_a_side + 0.5) - 1.0, 0.0};
  }
  return all;
}

/// All of them as one mesh.
Mesh merged(const Mesh& mesh, const std::vector<glm::dmat4x3>& transforms) {
  Mesh sum;
  sum.name = "tetrahedra";
  for (const glm::dmat4x3& transform : transforms) {
    const auto first = static_cast<std::uint32_t>(sum.positions.size());
    for (const glm::vec3& p : mesh.positions) {
      sum.positions.push_back(glm::vec3(transform * glm::dvec4(glm::dvec3(p), 1.0)));
    }
    for (const glm::uvec3& t : mesh.triangles) sum.triangles.push_back(t + first);
  }
  return sum;
}

/// Objects: a sphere, the tetrahedra as one, and one by one.
Scene calibration_scene() {
  Scene scene;
  scene.name = "calibration";
  BumpySphereParameters sphere;
  sphere.subdivisions = sphere_subdivisions;
  sphere.hole = 0.001;
  scene.meshes = {bumpy_sphere_mesh(sphere), merged(tetrahedron(), places()), tetrahedron()};
  scene.objects = {{0, glm::dmat4x3(1.0), none_id}, {1, glm::dmat4x3(1.0), none_id}};
  for (const glm::dmat4x3& place : places()) scene.objects.push_back({2, place, none_id});
  scene.finish();
  return scene;
}

/// The device at work on the scene.
class Drawing {
 public:
  Drawing() {
    device_.load(scene_);
    frame_.viewport = viewport;
    frame_.camera = {look_at({0.0, 0.0, 3.0}, {0.0, 0.0, 0.0}),
                     perspective_lens(75.0 * std::numbers::pi / 180.0, 1.0, 0.1, 10.0)};
    frame_.objects = state_.view();
    for (ObjectId object = 2; object < scene_.object_count(); ++object) small_.push_back(object);
  }

  std::uint32_t sphere_triangles() const { return scene_.triangle_count(0); }
  std::size_t small_objects() const { return small_.size(); }

  void draw_sphere(std::uint32_t triangles) {
    const TriangleRange range{0, 0, triangles};
    draw(std::span(&range, 1));
  }
  /// Half of the sphere, every second piece of it; returns their number.
  std::size_t draw_pieces() {
    if (pieces_.empty()) {
      for (std::uint32_t first = 0; first + piece_triangles <= sphere_triangles();
           first += 2 * piece_triangles) {
        pieces_.push_back({0, first, piece_triangles});
      }
    }
    draw(std::span<const TriangleRange>(pieces_));
    return pieces_.size();
  }
  void draw_small() { draw(std::span<const ObjectId>(small_)); }
  void draw_small_as_one() {
    const ObjectId object = 1;
    draw(std::span(&object, 1));
  }

 private:
  template <typename Items>
  void draw(const Items& items) {
    device_.begin_frame(frame_);
    device_.draw(items);
    device_.finish();
  }

  Scene scene_ = calibration_scene();
  SceneState state_{scene_};
  OsMesaDevice device_;
  Frame frame_;
  std::vector<ObjectId> small_;
  std::vector<TriangleRange> pieces_;
};

double nanoseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count();
}

}  // namespace

Cost cost_of(std::span<const double> larger_ns, std::span<const double> smaller_ns, double items) {
  if (larger_ns.empty() || larger_ns.size() != smaller_ns.size()) {
    throw std::logic_error("cost_of: there are no pairs of times");
  }
  std::vector<double> more;
  for (std::size_t i = 0; i < larger_ns.size(); ++i) {
    more.push_back(std::max(0.0, larger_ns[i] - smaller_ns[i]) / items);
  }
  const double least =
      std::max(0.0, std::ranges::min(larger_ns) - std::ranges::min(smaller_ns)) / items;
  return {least, std::min(least, quantile(more, 0.25)), std::max(least, quantile(more, 0.75))};
}

Cost cost_of_more(const std::function<void()>& larger, const std::function<void()>& smaller,
                  double items, int times) {
  larger();
  smaller();
  std::vector<double> larger_ns, smaller_ns;
  for (int i = 0; i < times; ++i) {
    larger_ns.push_back(nanoseconds(larger));
    smaller_ns.push_back(nanoseconds(smaller));
  }
  return cost_of(larger_ns, smaller_ns, items);
}

CostTable calibrate() {
  Drawing drawing;
  const std::uint32_t all = drawing.sphere_triangles();
  // A machine that is busy throughout may hide what the larger work costs; then it is done again.
  for (int attempt = 0; attempt < attempts; ++attempt) {
    CostTable table;
    table.triangle = cost_of_more([&] { drawing.draw_sphere(all); },
                                  [&] { drawing.draw_sphere(all / 4); }, all - all / 4, repeats);
    table.draw = cost_of_more([&] { drawing.draw_small(); }, [&] { drawing.draw_small_as_one(); },
                              static_cast<double>(drawing.small_objects() - 1), repeats);
    const double pieces = static_cast<double>(drawing.draw_pieces());
    table.piece = cost_of_more([&] { drawing.draw_pieces(); },
                               [&] { drawing.draw_sphere(all / 2); }, pieces - 1.0, repeats);
    table.cluster_test = cluster_test_cost(repeats);
    if (table.triangle.ns > 0.0 && table.cluster_test.ns > 0.0) return table;
  }
  throw std::runtime_error(
      "the costs of drawing and testing could not be told from what else the machine does");
}

}  // namespace vislab
