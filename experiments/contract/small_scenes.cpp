#include "experiments/contract/small_scenes.h"

#include <cmath>
#include <limits>

#include "common/geometry/random.h"

namespace vislab {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr Viewport small_viewport{64, 48};

double radians(double degrees) { return degrees * pi / 180.0; }

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& target, double fov_deg = 60.0,
                 double near_m = 0.1, double far_m = 200.0) {
  return {look_at(eye, target),
          perspective_lens(radians(fov_deg), small_viewport.aspect(), near_m, far_m)};
}

Camera orthographic_at(const glm::dvec3& eye, const glm::dvec3& target, double height_m) {
  return {look_at(eye, target), orthographic_lens(height_m, small_viewport.aspect(), 0.1, 200.0)};
}

Path standing(const std::vector<Camera>& cameras) {
  Path path;
  for (const Camera& camera : cameras) path.frames.push_back({camera, {}});
  return path;
}

Scene scene_of(std::vector<Mesh> meshes, std::vector<Object> objects) {
  Scene scene;
  scene.meshes = std::move(meshes);
  scene.objects = std::move(objects);
  scene.finish();
  return scene;
}

Mesh triangle_mesh() {
  Mesh mesh;
  mesh.positions = {{-1.0F, -1.0F, 0.0F}, {1.0F, -1.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// A cube with two triangles of no area: one with a repeated vertex, one along a line.
Mesh cube_with_slivers() {
  Mesh mesh = cube_mesh();
  const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back((mesh.positions[0] + mesh.positions[1]) * 0.5F);
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, middle, 1});
  return mesh;
}

/// All the awkward places and lenses around a cube from -1 to 1.
std::vector<Camera> awkward_cameras() {
  Camera infinite = camera_at({4.0, 3.0, 5.0}, {0.0, 0.0, 0.0});
  infinite.lens.far_m = std::numeric_limits<double>::infinity();
  Camera off_centre = camera_at({0.5, 0.3, 4.0}, {0.0, 0.0, 0.0});
  off_centre.lens.left *= 0.1;
  off_centre.lens.top *= 1.7;
  return {
      camera_at({4.0, 3.0, 5.0}, {0.0, 0.0, 0.0}),         // from outside
      camera_at({0.1, 0.2, 0.3}, {1.0, 0.4, 0.1}),         // inside the box
      camera_at({1.0, 0.0, 4.0}, {0.0, 0.0, 0.0}),         // on the plane of a side, outside
      camera_at({1.0, 0.2, 0.1}, {3.0, 0.0, 0.0}),         // on a side, looking out
      camera_at({1.0, 0.2, 0.1}, {0.0, 0.1, 0.0}),         // on a side, looking in
      camera_at({1.05, 0.0, 0.0}, {0.0, 0.0, 0.0}),        // nearer than the near plane
      camera_at({0.0, 0.0, 5.0}, {0.0, 0.0, 10.0}),        // looking away
      camera_at({3.0, 2.0, 4.0}, {0.9, 0.9, 0.9}, 0.01),   // tiny angle
      camera_at({0.0, 1.5, 2.0}, {0.0, 0.0, 0.0}, 175.0),  // huge angle
      camera_at({3.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 60.0, 1.9, 2.1),  // far plane cuts the cube
      infinite,
      off_centre,
      orthographic_at({4.0, 3.0, 5.0}, {0.0, 0.0, 0.0}, 5.0),
      orthographic_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}, 1.5),  // sides exactly edge-on
      orthographic_at({0.0, 0.0, 0.5}, {0.0, 0.0, 0.0}, 3.0),  // the box reaches behind the viewer
  };
}

SmallScene one_triangle() {
  return {"one triangle", scene_of({triangle_mesh()}, {Object{}}),
          standing({camera_at({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}),
                    camera_at({0.0, 0.0, -4.0}, {0.0, 0.0, 0.0}),  // from behind
                    camera_at({4.0, 0.0, 0.0}, {0.0, 0.0, 0.0}),   // exactly edge-on
                    camera_at({0.0, 0.0, 0.05}, {0.0, 0.0, -1.0})}),
          small_viewport};
}

SmallScene one_cube() {
  return {"one cube", scene_of({cube_mesh()}, {Object{}}), standing(awkward_cameras()),
          small_viewport};
}

SmallScene one_pixel() {
  return {"one pixel", scene_of({cube_mesh()}, {Object{}}), standing(awkward_cameras()), {1, 1}};
}

SmallScene no_area() {
  Mesh line;  // a whole mesh without area
  line.positions = {{0.0F, 2.0F, 0.0F}, {1.0F, 2.0F, 0.0F}, {3.0F, 2.0F, 0.0F}};
  line.triangles = {{0, 1, 2}};
  return {"triangles without area",
          scene_of({cube_with_slivers(), line}, {Object{}, Object{1, glm::dmat4x3(1.0), none_id}}),
          standing(awkward_cameras()), small_viewport};
}

/// Solids under every kind of placing transform, near and far from the origin of the world.
SmallScene placed_solids() {
  const glm::dvec3 far_away(30'000.0, -500.0, 20'000.0);
  glm::dmat4x3 sheared = placed(far_away + glm::dvec3(3.0, 0.0, 0.0));
  sheared[1] += glm::dvec3(0.9, 0.0, 0.4);
  glm::dmat4x3 mirrored = sheared;
  mirrored[0] = -mirrored[0];
  mirrored[3] += glm::dvec3(0.0, 0.0, 2.5);
  const double s = std::sin(0.7);
  const double c = std::cos(0.7);
  glm::dmat4x3 turned(glm::dvec3(c, 0.0, -s), glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(s, 0.0, c),
                      far_away + glm::dvec3(-3.0, 0.0, 0.0));
  Scene scene = scene_of(
      {cube_mesh(), sphere_mesh(8)},
      {{0, sheared, none_id},
       {1, sheared, none_id},
       {0, mirrored, none_id},
       {1, mirrored, none_id},
       {0, turned, none_id},
       {1, placed(far_away, {0.01, 1.0, 1.0}), none_id},                                // flat
       {1, placed(far_away, {1.0, 0.001, 1.0}), none_id},                               // very flat
       {0, placed(far_away, {40.0, 0.5, 0.5}), none_id},                                // long
       {1, placed(far_away + glm::dvec3(0.0, 2.0, 0.0), glm::dvec3(1e-3)), none_id}});  // tiny
  std::vector<Camera> cameras;
  for (int i = 0; i < 6; ++i) {
    const double angle = 1.1 * i;
    const glm::dvec3 side(std::cos(angle), 0.3 * std::sin(2.0 * angle), std::sin(angle));
    cameras.push_back(camera_at(far_away + 7.0 * side, far_away));
  }
  cameras.push_back(orthographic_at(far_away + glm::dvec3(5.0, 4.0, 60.0), far_away, 9.0));
  return {"solids turned, sheared, mirrored, scaled and far away", std::move(scene),
          standing(cameras), small_viewport};
}

/// A field of cubes and spheres; some move or turn into their mirror image, some hide and come
/// back, once all of them.
SmallScene moving_field() {
  Random random(7);
  std::vector<Object> objects;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const glm::dvec3 offset(random.uniform(-20.0, 20.0), random.uniform(-4.0, 4.0),
                            random.uniform(-20.0, 20.0));
    objects.push_back({i % 2, placed(offset, glm::dvec3(random.uniform(0.3, 1.5))), none_id});
  }
  Path path;
  for (int i = 0; i < 8; ++i) {
    const double angle = 0.5 * i;
    const glm::dvec3 eye(12.0 * std::cos(angle), 1.0, 12.0 * std::sin(angle));
    path.frames.push_back({camera_at(eye, {0.0, 0.0, 0.0}), {}});
  }
  for (std::size_t i = 1; i < 8; ++i) {
    Changes& changes = path.frames[i].changes;
    for (ObjectId object = static_cast<ObjectId>(i); object < 60; object += 9) {
      changes.moved.push_back(object);
      const glm::dvec3 offset(random.uniform(-15.0, 15.0), random.uniform(-3.0, 3.0),
                              random.uniform(-15.0, 15.0));
      const double mirror = object % 2 == 0 ? 1.0 : -1.0;
      changes.transforms.push_back(placed(offset, {mirror, 1.0, 1.0}));
    }
  }
  path.frames[2].changes.hidden = {0, 3, 4, 5, 40, 59};
  path.frames[3].changes.shown = {3, 59};
  path.frames[4].changes.shown = {0, 4, 5, 40};
  for (ObjectId object = 0; object < 60; ++object) {
    path.frames[5].changes.hidden.push_back(object);
    path.frames[6].changes.shown.push_back(object);
  }
  return {"a field that moves and hides", scene_of({cube_mesh(), sphere_mesh(5)}, objects),
          std::move(path), small_viewport};
}

/// Much behind a wall: what occlusion culling is for. Seen from the front, along the wall, from
/// above and from behind.
SmallScene behind_a_wall() {
  Random random(11);
  std::vector<Object> objects = {{0, placed({0.0, 0.0, 0.0}, {6.0, 4.0, 0.2}), none_id}};
  for (std::uint32_t i = 0; i < 40; ++i) {
    const glm::dvec3 offset(random.uniform(-7.0, 7.0), random.uniform(-4.0, 4.0),
                            random.uniform(-12.0, -2.0));
    objects.push_back({i % 2, placed(offset, glm::dvec3(random.uniform(0.1, 0.7))), none_id});
  }
  return {"much behind a wall",
          scene_of({cube_mesh(), sphere_mesh(5)}, objects),
          standing({camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}),
                    camera_at({0.0, 0.0, 2.0}, {0.0, 0.0, 0.0}),
                    camera_at({9.0, 0.0, 2.0}, {0.0, 0.0, -4.0}),
                    camera_at({0.0, 8.0, 6.0}, {0.0, 0.0, -4.0}),
                    camera_at({0.0, 0.0, -16.0}, {0.0, 0.0, 0.0}),
                    orthographic_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0}, 7.0)}),
          {65, 49}};
}

/// Single sheets seen from both sides, behind each other and touching.
SmallScene open_sheets() {
  std::vector<Object> objects;
  for (int i = 0; i < 5; ++i) {
    const double step = i;
    objects.push_back({0, placed({0.4 * step, 0.1 * step, -1.5 * step}), none_id});
  }
  objects.push_back({0, placed({0.0, 0.0, 0.0}), none_id});  // equal to the first
  return {"open sheets", scene_of({triangle_mesh()}, objects),
          standing({camera_at({1.0, 0.5, 4.0}, {0.5, 0.0, 0.0}),
                    camera_at({1.0, 0.5, -12.0}, {0.5, 0.0, 0.0}),
                    camera_at({0.8, 0.0, -2.0}, {0.5, 0.0, -8.0})}),
          small_viewport};
}

/// Houses with small things between them, from the street and from above.
SmallScene streets() {
  CityParameters city;
  city.blocks_x = 4;
  city.blocks_z = 3;
  city.roof_share = 0.5;
  city.street_boxes = 20;
  Scene scene = make_city(city);
  scene.finish();
  return {"streets of a small city", std::move(scene),
          standing({camera_at({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0}),
                    camera_at({0.0, 1.7, 0.0}, {20.0, 4.0, 0.0}),
                    camera_at({12.5, 1.7, 1.0}, {0.0, 8.0, -30.0}),
                    camera_at({70.0, 60.0, 50.0}, {0.0, 0.0, 0.0}),
                    orthographic_at({30.0, 100.0, 20.0}, {0.0, 0.0, 0.0}, 90.0)}),
          small_viewport};
}

/// Rooms whose walls are seen from inside only, and doors through which one sees on.
SmallScene rooms() {
  Scene scene = make_room_ring({});
  scene.finish();
  const Aabb first = scene.cells[0].bounds;
  const Aabb second = scene.cells[1].bounds;
  const glm::dvec3 eye = first.center();
  return {
      "a ring of rooms", std::move(scene),
      standing({camera_at(eye, second.center()), camera_at(eye, 2.0 * eye),
                camera_at(second.center(), eye), camera_at({0.0, 60.0, 20.0}, {0.0, 0.0, 0.0})}),
      small_viewport};
}

/// Covers with edges through centres of pixels, but for what snapping moves them, and behind each
/// something that stands out by one row or column of pixels: what a rasteriser covers there that
/// the device does not cover is missing from the image.
SmallScene edges_on_pixel_centres() {
  std::vector<Object> objects;
  for (int i = 0; i < 12; ++i) {
    // Pixels are squares of 1 m; 1/1024 m is less than half a step of a device's grid.
    const double beside = i % 3 == 0 ? 0.0 : (i % 3 == 1 ? 1.0 : -1.0) / 1024.0;
    const double half_width = 3.0, half_height = 4.0;
    const glm::dvec3 at(-24.5 + 16.0 * (i % 4), -15.5 + 15.0 * (i / 4), 0.0);
    objects.push_back({0, placed(at, {half_width + beside, half_height + beside, 0.5}), none_id});
    for (const glm::dvec3& side : {glm::dvec3(half_width, 0.0, 0.0),
                                   {-half_width, 0.0, 0.0},
                                   {0.0, half_height, 0.0},
                                   {0.0, -half_height, 0.0}}) {
      // Beside the centre, which would lie on the diagonal of the small one's face else.
      const glm::dvec3 behind = at + side + glm::dvec3(0.0625, 0.03125, -3.0);
      objects.push_back({0, placed(behind, {0.25, 0.25, 0.5}), none_id});
    }
  }
  Camera upside_down = orthographic_at({0.0, 0.0, 30.0}, {0.0, 0.0, 0.0}, 48.0);
  upside_down.pose.right = -upside_down.pose.right;
  upside_down.pose.up = -upside_down.pose.up;
  return {"edges through the centres of pixels", scene_of({cube_mesh()}, objects),
          standing({orthographic_at({0.0, 0.0, 30.0}, {0.0, 0.0, 0.0}, 48.0), upside_down}),
          small_viewport};
}

}  // namespace

Mesh sphere_mesh(int rings) {
  Mesh mesh;
  mesh.name = "sphere";
  const int sectors = 2 * rings;
  const auto count = static_cast<std::uint32_t>(sectors);
  mesh.positions.emplace_back(0.0F, 1.0F, 0.0F);
  for (int ring = 1; ring < rings; ++ring) {
    const double polar = pi * ring / rings;
    for (int sector = 0; sector < sectors; ++sector) {
      const double around = 2.0 * pi * sector / sectors;
      mesh.positions.emplace_back(glm::dvec3(std::sin(polar) * std::sin(around), std::cos(polar),
                                             std::sin(polar) * std::cos(around)));
    }
  }
  mesh.positions.emplace_back(0.0F, -1.0F, 0.0F);
  const auto south = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t sector = 0; sector < count; ++sector) {
    const std::uint32_t next = (sector + 1) % count;
    mesh.triangles.emplace_back(0U, 1 + sector, 1 + next);
    for (int ring = 1; ring + 1 < rings; ++ring) {
      const std::uint32_t upper = 1 + static_cast<std::uint32_t>(ring - 1) * count;
      const std::uint32_t lower = upper + count;
      mesh.triangles.emplace_back(upper + sector, lower + sector, lower + next);
      mesh.triangles.emplace_back(upper + sector, lower + next, upper + next);
    }
    mesh.triangles.emplace_back(south, south - count + next, south - count + sector);
  }
  return mesh;
}

glm::dmat4x3 placed(const glm::dvec3& offset, const glm::dvec3& scale) {
  return box_transform(offset, scale);
}

std::vector<SmallScene> small_scenes() {
  std::vector<SmallScene> scenes;
  scenes.push_back(one_triangle());
  scenes.push_back(one_cube());
  scenes.push_back(one_pixel());
  scenes.push_back(no_area());
  scenes.push_back(placed_solids());
  scenes.push_back(moving_field());
  scenes.push_back(behind_a_wall());
  scenes.push_back(open_sheets());
  scenes.push_back(streets());
  scenes.push_back(rooms());
  scenes.push_back(edges_on_pixel_centres());
  return scenes;
}

}  // namespace vislab
