// Made meshes and distorted placements, as descriptions ask for them.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/input_error.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

using test::repository_data;

class Shapes : public testing::Test {
 protected:
  Scene load(const std::string& toml) const {
    return load_scene(folder_.write("scene.toml", toml).string(), repository_data()).scene;
  }
  std::string refused(const std::string& toml) const {
    return input_error([&]() { load(toml); });
  }

 private:
  TemporaryFolder folder_;
};

const std::string sphere = "[generator]\nkind = \"bumpy_sphere\"\nsubdivisions = 6\n";
const std::string placed =
    "[[objects]]\nshape = \"bumpy_sphere\"\nsubdivisions = 6\nat = [3, 1, 0]\nsize_m = 4\n";
const std::string field =
    "[generator]\nkind = \"mesh_field\"\ncount = 400\nextent_m = 30\nmin_half_size_m = 0.2\n"
    "max_half_size_m = 0.5\n";
const std::string of_spheres = "[generator.mesh]\nshape = \"bumpy_sphere\"\nsubdivisions = 2\n";

glm::dmat3 linear(const Scene& scene, ObjectId id) {
  return glm::dmat3(scene.objects[id].transform);
}

TEST_F(Shapes, ABumpySphereHasTheKeysOfItsParameters) {
  const Scene smooth = load(sphere);
  EXPECT_EQ(smooth.triangle_count(), 432U);
  EXPECT_NE(load(sphere + "bumps = \"low\"\n").content_hash(), smooth.content_hash());
  EXPECT_NE(load(sphere + "bumps = \"high\"\n").content_hash(),
            load(sphere + "bumps = \"low\"\n").content_hash());
  EXPECT_LT(load(sphere + "hole = 0.5\n").triangle_count(), 300U);
  const Scene offset = load(sphere + "mesh_offset = [100, 0, 0]\n");
  EXPECT_NEAR(offset.meshes[0].bounds.center().x, 100.0, 1e-5);
  EXPECT_NEAR(offset.bounds().center().x, 0.0, 1e-4);
}

TEST_F(Shapes, RefuseValuesThatAreWrong) {
  EXPECT_TRUE(says(refused(sphere + "bumps = \"some\"\n"), "known: none, low, high"));
  EXPECT_TRUE(says(refused(sphere + "hole = 1.0\n"), "`hole` is wrong"));
  EXPECT_TRUE(says(refused(sphere + "mesh_offset = [1e7, 0, 0]\n"), "`mesh_offset` is wrong"));
  EXPECT_TRUE(says(refused("[generator]\nkind = \"bumpy_sphere\"\nsubdivisions = 0\n"),
                   "`subdivisions` is wrong"));
  EXPECT_TRUE(says(refused(placed + "scale = [1, 0, 1]\n"), "`scale` is wrong"));
  EXPECT_TRUE(says(refused(placed + "scale = 2\n"), "`scale` is wrong"));
  EXPECT_TRUE(says(refused(placed + "shear = [0, 0, 1e4]\n"), "`shear` is wrong"));
  EXPECT_TRUE(says(refused("[mesh]\nfile = \"a.off\"\nup = \"x\"\n"), "`up` is wrong"));
  EXPECT_TRUE(says(refused(field + "mirrored = 1.5\n" + of_spheres), "`mirrored` is wrong"));
  EXPECT_TRUE(says(refused(field + "shear = -1.0\n" + of_spheres), "`shear` is wrong"));
  EXPECT_TRUE(says(refused(field + "shear = 900.0\n" + of_spheres), "`extent_m` must be at least"));
  EXPECT_TRUE(says(refused(field + "[generator.mesh]\nshape = \"cone\"\n"),
                   "known: bumpy_sphere, ribbed_sphere"));
  const std::string slabs = "[generator]\nkind = \"grazing_slabs\"\n";
  EXPECT_TRUE(says(refused(slabs + "tilt_rad = -1e-3\n"), "`tilt_rad` is wrong"));
  EXPECT_TRUE(says(refused(slabs + "tilt = 1e-3\n"), "`tilt` is not a key"));
}

TEST_F(Shapes, AreStretchedMirroredAndShearedAsObjects) {
  // The sphere's radius is 2 m before all that.
  const Scene plain = load(placed);
  EXPECT_NEAR(glm::determinant(linear(plain, 0)), 8.0, 1e-6);
  const Scene mirrored = load(placed + "scale = [-1, 1, 1]\n");
  EXPECT_NEAR(glm::determinant(linear(mirrored, 0)), -8.0, 1e-6);
  const Scene flat = load(placed + "scale = [1, 0.25, 1.5]\nheading_deg = 90\n");
  EXPECT_NEAR(flat.bounds().half_size().x, 3.0, 1e-5);
  EXPECT_NEAR(flat.bounds().half_size().y, 0.5, 1e-5);
  EXPECT_NEAR(flat.bounds().half_size().z, 2.0, 1e-5);
  const Scene sheared = load(placed + "shear = [3, 0.5, -1]\nscale = [2, 1, 1]\n");
  const glm::dmat3 m = linear(sheared, 0);
  EXPECT_LT(glm::distance(m * glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(12.0, 2.0, 0.0)), 1e-5);
  EXPECT_LT(glm::distance(m * glm::dvec3(0.0, 0.0, 1.0), glm::dvec3(2.0, -2.0, 2.0)), 1e-5);
  EXPECT_NEAR(glm::determinant(m), 16.0, 1e-5);
  for (const Scene* scene : {&plain, &mirrored, &flat, &sheared}) {
    // It stands on `at`; boxes of objects are those of the turned boxes of their meshes.
    double lowest = 1e9;
    for (std::uint32_t t = 0; t < scene->triangle_count(); ++t) {
      for (const glm::dvec3& p : world_triangle(scene->meshes[0], scene->objects[0].transform, t)) {
        lowest = std::min(lowest, p.y);
      }
    }
    EXPECT_NEAR(lowest, 1.0, 1e-5);
    EXPECT_TRUE(scene->meshes[0].solid);
  }
}

TEST_F(Shapes, AFieldMirrorsItsShareAndMoreOfTheSameForALargerOne) {
  std::vector<bool> before(400, false);
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const Scene scene = load(field + "mirrored = " + std::to_string(share) + "\n" + of_spheres);
    const Scene plain = load(field + of_spheres);
    int mirrored = 0;
    for (ObjectId id = 0; id < 400; ++id) {
      const bool is_mirrored = glm::determinant(linear(scene, id)) < 0.0;
      mirrored += is_mirrored ? 1 : 0;
      EXPECT_TRUE(is_mirrored || !before[id]);
      before[id] = is_mirrored;
      EXPECT_LT(glm::distance(scene.objects[id].transform[3], plain.objects[id].transform[3]),
                1e-6);
    }
    EXPECT_NEAR(mirrored, 400 * share, 40 * share * (1.0 - share) * 4.0);
  }
}

TEST_F(Shapes, AShearedFieldKeepsClearOfTheOrigin) {
  for (const std::string shear : {"1.0", "5.0"}) {
    for (const std::string rotated : {"true", "false"}) {
      const Scene scene =
          load(field + "shear = " + shear + "\nrotated = " + rotated + "\n" + of_spheres);
      for (ObjectId id = 0; id < 400; ++id) {
        const glm::dmat3 m = linear(scene, id);
        // x goes along with y: what is left of column y without that is at a right angle to x.
        EXPECT_NEAR(glm::dot(m[0], m[1]) / glm::dot(m[0], m[0]), std::stod(shear), 1e-9);
        for (const glm::vec3& p : scene.meshes[0].positions) {
          EXPECT_GE(glm::length(scene.objects[id].transform * glm::dvec4(p, 1.0)), 4.999);
        }
      }
    }
  }
}

TEST_F(Shapes, ABoxFieldMayBeMirroredAndSheared) {
  const Scene scene = load(
      "[generator]\nkind = \"box_field\"\ncount = 50\nextent_m = 30\nedge_m = 1\nmirrored = 1.0\n"
      "shear = 2.0\n");
  for (ObjectId id = 0; id < 50; ++id) {
    EXPECT_EQ(linear(scene, id), glm::dmat3({-0.5, 0.0, 0.0}, {1.0, 0.5, 0.0}, {0.0, 0.0, 0.5}));
  }
}

TEST_F(Shapes, AFieldOfMadeSpheresSharesOneMesh) {
  const Scene scene = load(field + of_spheres);
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.triangle_count(), 400U * 48U);
  EXPECT_TRUE(scene.meshes[0].solid);
}

}  // namespace
}  // namespace vislab
