// The swarm: many small things as large together as one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/scene/generators/swarm.h"
#include "common/scene/library.h"
#include "tests/scene/repository_data.h"

namespace vislab {
namespace {

using namespace test;

Scene swarm_of(std::uint32_t count) {
  SwarmParameters parameters;
  parameters.count = count;
  parameters.area_m2 = 30.0;
  Scene scene = make_swarm(parameters);
  scene.finish();
  return scene;
}

/// Of the cube's sphere: half of its edge's length times the root of 3.
double radius_of(const Object& object) {
  return std::sqrt(3.0) * glm::length(glm::dvec3(object.transform[0]));
}

TEST(Swarm, IsAsLargeInSumHoweverManyThereAre) {
  for (const std::uint32_t count : {1U, 10U, 1000U}) {
    double area = 0.0;
    const Scene scene = swarm_of(count);
    ASSERT_EQ(scene.object_count(), count);
    for (const Object& object : scene.objects) {
      area += std::numbers::pi * radius_of(object) * radius_of(object);
    }
    EXPECT_NEAR(area, 30.0, 1e-9);
  }
}

TEST(Swarm, HasThePlacesOfASmallerOneAndStaysInItsBlock) {
  const Scene few = swarm_of(10);
  const Scene many = swarm_of(500);
  for (ObjectId id = 0; id < 10; ++id) {
    EXPECT_EQ(few.objects[id].transform[3], many.objects[id].transform[3]);
  }
  for (const Object& object : many.objects) {
    const glm::dvec3 middle = object.transform[3];
    EXPECT_LE(std::abs(middle.x), 10.0);
    EXPECT_LE(std::abs(middle.y), 10.0);
    EXPECT_LE(std::abs(middle.z), 5.0);
  }
}

TEST(Swarm, IsDescribedInAFile) {
  const Scene scene = load_scene("swarm", repository_data()).scene;
  EXPECT_EQ(scene.object_count(), 20'000U);
  EXPECT_EQ(scene.report.self_intersecting_meshes, 0U);
}

}  // namespace
}  // namespace vislab
