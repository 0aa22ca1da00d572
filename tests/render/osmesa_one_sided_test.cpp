// Objects whose back faces the OSMesa device leaves out.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "common/render/osmesa_device.h"
#include "tests/render/small_scenes.h"

namespace vislab {
namespace {

using test::frame_of;
using test::object_at;
using test::square_mesh;
using test::wall_and_cubes;

/// The square turned about the y axis so that its back is seen, and mirrored in x.
Scene squares_of_every_facing() {
  Scene scene;
  scene.meshes = {square_mesh()};
  Object front = object_at(0, {-1.5, 0.0, -4.0});
  Object back = object_at(0, {-0.5, 0.0, -4.0});
  back.transform[0] = {-1.0, 0.0, 0.0};
  back.transform[2] = {0.0, 0.0, -1.0};
  Object mirrored_front = object_at(0, {0.5, 0.0, -4.0});
  mirrored_front.transform[0] = {-1.0, 0.0, 0.0};
  Object mirrored_back = object_at(0, {1.5, 0.0, -4.0});
  mirrored_back.transform[2] = {0.0, 0.0, -1.0};
  scene.objects = {front, back, mirrored_front, mirrored_back};
  scene.finish();
  return scene;
}

TEST(OneSided, LeavesOutTheBacksOfTheObjectsThatAreNamedHoweverTheyAreMirrored) {
  const Scene scene = squares_of_every_facing();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  const auto seen = [&](std::span<const ObjectId> one_sided) {
    device.begin_frame(frame_of(state, {64, 64}));
    device.cull_back_faces(one_sided);
    device.draw(state.view().shown);
    const std::vector<std::uint32_t> ids = device.read_ids();
    std::set<ObjectId> objects(ids.begin(), ids.end());
    objects.erase(none_id);
    return objects;
  };
  const std::array<ObjectId, 4> all = {0, 1, 2, 3};
  const std::array<ObjectId, 2> some = {1, 2};
  // A mirroring transform keeps the order of a triangle's corners: what was counter-clockwise seen
  // from outside turns clockwise. Mirrored in x the square still faces +z, mirrored in z it faces
  // away.
  EXPECT_EQ(seen(all), (std::set<ObjectId>{0, 2}));
  EXPECT_EQ(seen(some), (std::set<ObjectId>{0, 2, 3}));
  EXPECT_EQ(seen({}), (std::set<ObjectId>{0, 1, 2, 3})) << "begin_frame forgets";
}

TEST(OneSided, LeavesOutTheSameBacksWhetherItDrawsObjectsRangesOrTriangles) {
  const Scene scene = wall_and_cubes();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  const std::array<ObjectId, 2> cubes = {1, 3};
  std::vector<TriangleRange> ranges;
  for (const ObjectId object : state.view().shown) {
    ranges.push_back({object, 0, 1});
    ranges.push_back({object, 1, scene.triangle_count(object) - 1});
  }
  const auto depth_of = [&](auto&& draw) {
    device.begin_frame(frame_of(state, {64, 64}));
    device.cull_back_faces(cubes);
    draw();
    return device.read_depth();
  };
  const std::vector<float> objects = depth_of([&] { device.draw(state.view().shown); });
  EXPECT_EQ(objects, depth_of([&] { device.draw(ranges); }));
  EXPECT_EQ(objects, depth_of([&] { device.draw_ids(ranges); }));
}

TEST(OneSided, SaysWhatItDrawsOneSided) {
  Scene scene = squares_of_every_facing();
  scene.objects[3].transform[0] = {1.0, 1.0, 0.0};
  scene.objects[3].transform[1] = {1.0, 1.0 + 1e-7, 0.0};
  scene.finish();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame_of(state, {8, 8}));
  EXPECT_TRUE(device.one_sided().empty());
  const std::array<ObjectId, 4> named = {2, 0, 2, 3};
  device.cull_back_faces(named);
  const std::vector<ObjectId> now(device.one_sided().begin(), device.one_sided().end());
  EXPECT_EQ(now, (std::vector<ObjectId>{2, 0})) << "3 is too flat to tell its sides apart";
  device.begin_frame(frame_of(state, {8, 8}));
  EXPECT_TRUE(device.one_sided().empty());
}

TEST(OneSided, AsksAboutBothSidesOfBoxesWhateverIsDrawnOneSided) {
  const Scene scene = squares_of_every_facing();
  const SceneState state(scene);
  OsMesaDevice device;
  device.load(scene);
  const Aabb box{{-0.5, -0.5, -3.0}, {0.5, 0.5, -2.0}};
  const auto samples = [&](std::span<const ObjectId> one_sided) {
    device.begin_frame(frame_of(state, {64, 64}));
    device.cull_back_faces(one_sided);
    device.draw(one_sided);
    return device.samples(device.query({&box, 1}));
  };
  const std::array<ObjectId, 2> backs = {1, 3};
  EXPECT_EQ(samples(backs), samples({}));
}

}  // namespace
}  // namespace vislab
