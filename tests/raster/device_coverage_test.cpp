// What the rasteriser covers, beside what the graphics device covers: a depth buffer that covers a
// pixel more hides what the device shows there.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/random.h"
#include "common/raster/brute_force_raster.h"
#include "common/raster/depth_raster.h"
#include "common/render/osmesa_device.h"

namespace vislab {
namespace {

constexpr Viewport size{48, 32};

/// World positions are window positions.
Camera window_camera() {
  Camera camera;
  camera.pose.eye = {0.0, 0.0, 5.0};
  camera.lens = {Projection::orthographic, 0.0, 48.0, 0.0, 32.0, 1.0, 9.0};
  return camera;
}

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.objects.emplace_back();
  scene.finish();
  return scene;
}

/// Rows from the top, for messages.
std::string picture(const std::vector<bool>& covered) {
  std::string text;
  for (int y = size.height - 1; y >= 0; --y) {
    for (int x = 0; x < size.width; ++x) {
      text += covered[static_cast<std::size_t>(y * size.width + x)] ? '#' : '.';
    }
    text += '\n';
  }
  return text;
}

std::vector<bool> covered_by_device(OsMesaDevice& device, const Scene& scene) {
  SceneState state(scene);
  Frame frame;
  frame.camera = window_camera();
  frame.viewport = size;
  frame.objects = state.view();
  device.load(scene);
  device.begin_frame(frame);
  device.draw_ids(std::vector<TriangleRange>{{0, 0, scene.triangle_count(0)}});
  std::vector<bool> covered;
  for (const TriangleId id : device.read_ids()) covered.push_back(id != none_id);
  return covered;
}

template <typename Raster>
std::vector<bool> covered_by(Raster& raster, const Scene& scene, const RasterMesh& mesh) {
  const Camera camera = window_camera();
  const auto nothing = static_cast<float>(WindowTransform(camera, size).nearness(9.0));
  raster.begin(camera);
  RasterDraw draw;
  draw.mesh = &mesh;
  draw.transform = &scene.objects[0].transform;
  draw.count = scene.triangle_count(0);
  raster.draw(std::array{draw});
  std::vector<bool> covered;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) covered.push_back(raster.nearness(x, y) > nothing);
  }
  return covered;
}

/// What can be drawn there with edges through centres of pixels, and a little beside them, so that
/// snapping takes them there.
Mesh on_pixel_centres(Random& random, int kind) {
  const auto coordinate = [&](int pixels) {
    const double place =
        static_cast<double>(1 + random.below(static_cast<std::uint64_t>(pixels - 2)));
    return static_cast<float>(place + 0.5 + (kind == 2 ? random.uniform(-1.0, 1.0) / 600.0 : 0.0));
  };
  const float left = coordinate(size.width), right = coordinate(size.width);
  const float below = coordinate(size.height), above = coordinate(size.height);
  Mesh mesh;
  if (kind == 0) {
    mesh.positions = {{left, below, 0.0F},
                      {right, above, 0.0F},
                      {coordinate(size.width), coordinate(size.height), 0.0F}};
    mesh.triangles = {{0, 1, 2}};
  } else {
    mesh.positions = {
        {left, below, 0.0F}, {right, below, 0.0F}, {right, above, 0.0F}, {left, above, 0.0F}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  }
  return mesh;
}

TEST(DeviceCoverage, EdgesThroughPixelCentresTakeThePixelsThatTheDeviceTakes) {
  OsMesaDevice device;
  const SetupOptions conservative{Coverage::centres, DepthRounding::lowered};
  BruteForceRaster plain(size, conservative);
  DepthRaster tiled(size, RasterOptions{conservative, false, 1});
  Random random(41);
  std::ptrdiff_t all = 0;
  for (int trial = 0; trial < 150; ++trial) {
    Mesh mesh = on_pixel_centres(random, trial % 3);
    const glm::vec3 across = mesh.positions[2] - mesh.positions[0];
    if (across.x == 0.0F || across.y == 0.0F) continue;
    const Scene scene = scene_of(std::move(mesh));
    const RasterMesh raster_mesh(scene.meshes[0]);
    const std::vector<bool> right = covered_by_device(device, scene);
    EXPECT_EQ(picture(covered_by(plain, scene, raster_mesh)), picture(right)) << trial;
    EXPECT_EQ(picture(covered_by(tiled, scene, raster_mesh)), picture(right)) << trial;
    all += std::ranges::count(right, true);
  }
  EXPECT_GT(all, 5000);
}

}  // namespace
}  // namespace vislab
