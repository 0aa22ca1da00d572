#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

Scene finished(const GrazingSlabsParameters& parameters) {
  Scene scene = make_grazing_slabs(parameters);
  scene.finish();
  return scene;
}

TEST(GrazingSlabs, AreSolidBoxesAroundTheOrigin) {
  GrazingSlabsParameters parameters;
  parameters.count = 300;
  const Scene scene = finished(parameters);
  EXPECT_EQ(scene.object_count(), 300U);
  EXPECT_EQ(scene.triangle_count(), 300U * 12U * 16U);
  EXPECT_TRUE(scene.meshes[0].solid);
  glm::dvec3 sum(0.0);
  for (const Object& object : scene.objects) {
    EXPECT_NEAR(glm::length(object.transform[3]), 10.0, 0.03);
    EXPECT_NEAR(glm::determinant(glm::dmat3(object.transform)), 1.0, 1e-12);
    sum += object.transform[3] / 10.0;
  }
  EXPECT_LT(glm::length(sum), 0.2 * 300.0);  // in all directions
}

TEST(GrazingSlabs, ThePlanesOfTheirUpperFacesPassTheOriginByTheTilt) {
  for (const double tilt : {0.0, 1e-8, 1e-5, 1e-3, 0.1, 1.5}) {
    GrazingSlabsParameters parameters;
    parameters.count = 20;
    parameters.tilt_rad = tilt;
    parameters.distance_m = 25.0;
    const Scene scene = finished(parameters);
    const Mesh& mesh = scene.meshes[0];
    for (ObjectId id = 0; id < scene.object_count(); ++id) {
      int upper = 0;
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3 corners = mesh.triangles[t];
        if (mesh.positions[corners.x].y + mesh.positions[corners.y].y +
                mesh.positions[corners.z].y <
            2.99F * mesh.bounds.max.y) {
          continue;
        }
        ++upper;
        const auto c = world_triangle(mesh, scene.objects[id].transform, t);
        const glm::dvec3 normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
        const double height = glm::dot(normal, -c[0]);  // of the origin above the plane
        const double expected = 25.0 * std::sin(tilt) * (id % 2 == 0 ? 1.0 : -1.0);
        EXPECT_NEAR(height, expected, 2e-12);
      }
      EXPECT_EQ(upper, 32);
    }
  }
}

TEST(GrazingSlabs, StayInTheirPlacesWhateverTheTilt) {
  GrazingSlabsParameters parameters;
  parameters.count = 10;
  const std::string hash = finished(parameters).content_hash();
  EXPECT_EQ(finished(parameters).content_hash(), hash);
  const Scene before = finished(parameters);
  parameters.tilt_rad = 1e-6;
  const Scene after = finished(parameters);
  EXPECT_NE(after.content_hash(), hash);
  for (ObjectId id = 0; id < 10; ++id) {
    const glm::dvec3 moved = after.objects[id].transform[3] - before.objects[id].transform[3];
    EXPECT_LT(glm::length(moved), 1e-4);
  }
  parameters.seed = 2;
  EXPECT_NE(finished(parameters).content_hash(), after.content_hash());
}

}  // namespace
}  // namespace vislab
