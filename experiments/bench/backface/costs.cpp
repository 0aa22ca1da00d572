#include "experiments/bench/backface/costs.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "algorithms/all_cullers.h"
#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

Scene scene_of(const std::string& world) {
  BumpySphereParameters parameters;
  parameters.subdivisions = 289;
  parameters.bumps = world == "low" ? Bumps::low : world == "high" ? Bumps::high : Bumps::none;
  Scene scene = make_bumpy_sphere(parameters);
  scene.finish();
  return scene;
}

/// By one thread, in the build that other work on the machine disturbed least.
Measurement build_rate(const std::string& culler, const std::string& world) {
  const Scene scene = scene_of(world);
  Registry registry;
  register_all_cullers(registry);
  double seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const auto made = registry.make(culler);
    const auto start = std::chrono::steady_clock::now();
    made->build(scene, {});
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    seconds = std::min(seconds, elapsed.count());
  }
  return {1e-6 * scene.triangle_count() / seconds, scene.meshes[0].solid};
}

Measurement bytes_per_triangle(const std::string& culler, const std::string& world) {
  const Scene scene = scene_of(world);
  Registry registry;
  register_all_cullers(registry);
  const auto made = registry.make(culler);
  made->build(scene, {});
  return {static_cast<double>(made->bytes()) / scene.triangle_count(), scene.meshes[0].solid};
}

}  // namespace

void add_costs(std::vector<BenchCase>& cases, const std::string& culler, const std::string& world) {
  cases.push_back({culler, world + ", build", "Mtriangle/s", "", nullptr,
                   [=] { return build_rate(culler, world); }});
  cases.push_back({culler, world + ", memory a triangle", "bytes", "", nullptr,
                   [=] { return bytes_per_triangle(culler, world); }});
}

}  // namespace vislab
