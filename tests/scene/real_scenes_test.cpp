// Scenes from packages, which ./lab test fetches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/cell_check.h"
#include "common/scene/library.h"
#include "common/scene/orientation.h"
#include "common/scene/quake_world.h"
#include "tests/scene/repository_data.h"

namespace vislab {
namespace {

using test::repository_data;

Scene load(const std::string& name) { return load_scene(name, repository_data()).scene; }

TEST(RealScenes, TheDragonIsTheOneOfTheThesis) {
  const Scene dragon = load("dragon");
  EXPECT_EQ(dragon.triangle_count(), 47'794U);
  EXPECT_EQ(dragon.meshes[0].positions.size(), 22'998U);
  EXPECT_FALSE(dragon.meshes[0].closed);  // its authors say so: decimation left holes
}

TEST(RealScenes, OfTheDragonsOnlyTheOneInFullResolutionIsClosed) {
  const Scene middle = load("dragon_res2");
  EXPECT_EQ(middle.triangle_count(), 202'520U);
  EXPECT_FALSE(middle.meshes[0].closed);
#ifndef __SANITIZE_ADDRESS__  // looking for self-intersections takes ten times as long then
  const Scene full = load("dragon_full");
  EXPECT_EQ(full.triangle_count(), 871'414U);
  EXPECT_TRUE(full.meshes[0].closed);
  EXPECT_FALSE(full.meshes[0].solid);
#endif
}

TEST(RealScenes, TheCowIsTheOneOfTheThesisAndClosed) {
  const Scene cow = load("cow");
  EXPECT_EQ(cow.triangle_count(), 5'804U);
  EXPECT_EQ(cow.meshes[0].positions.size(), 2'903U);  // one of 2,904 is there twice
  EXPECT_TRUE(cow.meshes[0].closed);
}

TEST(RealScenes, BunnyManAndElephantAreClosed) {
  const std::pair<std::string, std::size_t> expected[] = {
      {"bunny", 75'408}, {"man", 34'986}, {"elephant", 5'558}, {"elephant_refined", 88'928}};
  for (const auto& [name, triangles] : expected) {
    const Scene scene = load(name);
    EXPECT_EQ(scene.triangle_count(), triangles) << name;
    EXPECT_TRUE(scene.meshes[0].closed) << name;
  }
}

TEST(RealScenes, TheHareIsABunnyWithAboutTheTrianglesOfTheThesis) {
  const Scene hare = load("hare");
  EXPECT_NEAR(static_cast<double>(hare.triangle_count()), 4968.0, 40.0);
  EXPECT_TRUE(hare.meshes[0].closed);
}

TEST(RealScenes, TheHaresShareOneMesh) {
  const Scene hare = load("hare");
#ifdef __SANITIZE_ADDRESS__  // each loads and judges the mesh again, which takes five times as long
  const std::vector<std::size_t> counts{14, 546};
#else
  const std::vector<std::size_t> counts{14, 28, 56, 112, 252, 546};
#endif
  for (const std::size_t count : counts) {
    const Scene hares = load("hares_" + std::to_string(count));
    EXPECT_EQ(hares.object_count(), count);
    EXPECT_EQ(hares.meshes.size(), 1U);
    EXPECT_EQ(hares.triangle_count(), count * hare.triangle_count());
  }
}

class OpenArena : public testing::Test {
 protected:
  static void SetUpTestSuite() { scene_ = new Scene(load("oa_dm2")); }
  static void TearDownTestSuite() { delete scene_; }
  static const QuakeWorld& world() { return *scene_->quake; }

  static Scene* scene_;
};

Scene* OpenArena::scene_ = nullptr;

TEST_F(OpenArena, HasTheKnownCounts) {
  EXPECT_EQ(scene_->triangle_count(), 12'033U);
  EXPECT_EQ(world().leaves.size(), 2560U);
  EXPECT_EQ(world().cluster_count, 1041U);
  int doors = 0;
  for (const QuakeBrushModel& model : world().brush_models) {
    doors += model.class_name == "func_door" ? 1 : 0;
  }
  EXPECT_EQ(doors, 11);
  double visible = 0.0;
  for (std::uint32_t from = 0; from < world().cluster_count; ++from) {
    for (std::uint32_t to = 0; to < world().cluster_count; ++to) {
      visible += world().sees(static_cast<std::int32_t>(from), static_cast<std::int32_t>(to));
    }
  }
  EXPECT_NEAR(visible / (1041.0 * 1041.0), 0.113, 0.0005);
}

TEST_F(OpenArena, KeepsTheLeafOfEveryObject) {
  ASSERT_EQ(world().leaf_of_object.size(), scene_->object_count());
  for (ObjectId id = 0; id < scene_->object_count(); ++id) {
    const std::uint32_t leaf = world().leaf_of_object[id];
    if (leaf != none_id) {
      EXPECT_EQ(world().leaves[leaf].object, id);
    }
  }
}

TEST_F(OpenArena, SeesEachPlaceFromItself) {
  ASSERT_GT(world().places.size(), 20U);
  for (const QuakePlace& place : world().places) {
    const std::int32_t cluster = world().leaves[place.leaf].cluster;
    EXPECT_TRUE(world().sees(cluster, cluster));
    EXPECT_EQ(world().leaf_at(place.eye), place.leaf);
    EXPECT_TRUE(world().leaves[place.leaf].bounds.contains(place.eye));
    EXPECT_TRUE(scene_->bounds().contains(place.eye));
  }
}

TEST_F(OpenArena, ShowsFrontFacesOnlyToThoseWhoStandInIt) {
  // The triangle nearest to a place, straight ahead in any direction, turns its front to it.
  const QuakePlace& place = world().places.front();
  int hits = 0;
  for (int k = 0; k < 64; ++k) {
    const double angle = 0.098 * k;
    const glm::dvec3 direction(std::cos(angle), 0.0, std::sin(angle));
    double nearest = std::numeric_limits<double>::infinity();
    bool front = false;
    for (ObjectId id = 0; id < scene_->object_count(); ++id) {
      for (std::uint32_t t = 0; t < scene_->triangle_count(id); ++t) {
        const auto c = world_triangle(scene_->mesh_of(id), scene_->objects[id].transform, t);
        const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
        const double slope = glm::dot(normal, direction);
        if (slope == 0.0) continue;
        const double distance = glm::dot(normal, c[0] - place.eye) / slope;
        if (distance <= 0.0 || distance >= nearest) continue;
        const glm::dvec3 p = place.eye + direction * distance;
        bool inside = true;
        for (std::size_t i = 0; i < 3; ++i) {
          inside &= glm::dot(normal, glm::cross(c[(i + 1) % 3] - c[i], p - c[i])) >= 0.0;
        }
        if (!inside) continue;
        nearest = distance;
        front = slope < 0.0;
      }
    }
    if (std::isinf(nearest)) continue;
    ++hits;
    EXPECT_TRUE(front) << "direction " << k;
  }
  EXPECT_GE(hits, 60);
}

TEST_F(OpenArena, IsWalkedWithinItsOpenLeaves) {
  const Path path = load_path("", *scene_, {512, 512}, 0, repository_data());
  ASSERT_EQ(path.frames.size(), 60U);
  for (const PathFrame& frame : path.frames) {
    const std::uint32_t leaf = world().leaf_at(frame.camera.pose.eye);
    EXPECT_GE(world().leaves[leaf].cluster, 0);
  }
  EXPECT_EQ(load_path("quake_walk", *scene_, {512, 512}, 0, repository_data()).content_hash(),
            path.content_hash());
}

/// The first triangle that a ray meets, from either side, one by one.
struct Hit {
  ObjectId object = none_id;
  double distance = std::numeric_limits<double>::infinity();
};

Hit first_hit(const Scene& scene, const glm::dvec3& eye, const glm::dvec3& direction) {
  Hit hit;
  for (ObjectId id = 0; id < scene.object_count(); ++id) {
    for (std::uint32_t t = 0; t < scene.triangle_count(id); ++t) {
      const auto c = world_triangle(scene.mesh_of(id), scene.objects[id].transform, t);
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      const double slope = glm::dot(normal, direction);
      if (slope == 0.0) continue;
      const double distance = glm::dot(normal, c[0] - eye) / slope;
      if (distance <= 0.0 || distance >= hit.distance) continue;
      const glm::dvec3 p = eye + direction * distance;
      bool inside = true;
      for (std::size_t i = 0; i < 3; ++i) {
        inside &= glm::dot(normal, glm::cross(c[(i + 1) % 3] - c[i], p - c[i])) >= 0.0;
      }
      if (inside) hit = {id, distance};
    }
  }
  return hit;
}

/// Of rays from places to what they hit: the last open leaf before it lists the object, and no
/// solid leaf lies between.
void expect_listed_hits(const Scene& scene, std::size_t place_step) {
  const QuakeWorld& world = *scene.quake;
  Random random(3);
  int hits = 0;
  for (std::size_t i = 0; i < world.places.size(); i += place_step) {
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3& eye = world.places[i].eye;
      const glm::dvec3 direction = random_direction(random);
      const Hit hit = first_hit(scene, eye, direction);
      ASSERT_NE(hit.object, none_id) << "place " << i;
      const auto leaf_before = [&](double back_m) {
        return world.leaf_at(eye + direction * std::max(hit.distance - back_m, 0.0));
      };
      // Corners are rounded to an eighth of a unit, so a face may lie that deep in solid matter.
      std::uint32_t leaf = leaf_before(0.0);
      for (double back_m = 1e-3; world.leaves[leaf].cluster < 0 && back_m < 0.1; back_m *= 2.0) {
        leaf = leaf_before(back_m);
      }
      for (double way_m = 0.0; way_m < hit.distance - 0.1; way_m += 0.05) {
        EXPECT_GE(world.leaves[world.leaf_at(eye + direction * way_m)].cluster, 0);
      }
      if (world.leaf_of_object[hit.object] == none_id) continue;
      EXPECT_TRUE(std::ranges::binary_search(world.leaves_of_object(hit.object), leaf))
          << "place " << i << " object " << hit.object << " leaf " << leaf;
      ++hits;
    }
  }
  EXPECT_GT(hits, 30);
}

/// Every eye is in an open leaf, and so are the corners of its near plane's window.
void expect_walk_in_the_open(const Scene& scene, const Path& path, double least_m) {
  const QuakeWorld& world = *scene.quake;
  const auto is_open = [&](const glm::dvec3& point) {
    return world.leaves[world.leaf_at(point)].cluster >= 0;
  };
  double length = 0.0;
  for (std::size_t i = 0; i < path.frames.size(); ++i) {
    const auto& [pose, lens] = path.frames[i].camera;
    EXPECT_TRUE(is_open(pose.eye)) << i;
    for (const double x : {lens.left, lens.right}) {
      for (const double y : {lens.bottom, lens.top}) {
        EXPECT_TRUE(is_open(pose.eye - pose.back * lens.near_m + pose.right * x + pose.up * y));
      }
    }
    if (i > 0) length += glm::distance(pose.eye, path.frames[i - 1].camera.pose.eye);
  }
  EXPECT_GT(length, least_m);
}

TEST_F(OpenArena, ListsTheLeavesOfWhatRaysHit) { expect_listed_hits(*scene_, 3); }

TEST_F(OpenArena, HasACellForEachOpenLeafAndNothingOddButTinyPortals) {
  EXPECT_EQ(scene_->cells.size(), 1041U);
  EXPECT_EQ(scene_->portals.size(), 2U * 2343U);
  EXPECT_EQ(world().doubt_about_sets(), "");
  EXPECT_EQ(world().report.leaves_open_to_outside, 2U);
  // High above a hall, behind no drawn face; rays from below go through into the sky.
  EXPECT_EQ(world().report.see_through_leaves, 1U);
}

TEST_F(OpenArena, IsWalkedThroughOnFoot) {
  expect_walk_in_the_open(
      *scene_, load_path("oa_dm2_walk", *scene_, {512, 512}, 0, repository_data()), 150.0);
}

TEST(Czest3ctf, HasTheKnownCountsAndIsWalkedThroughOnFoot) {
  const Scene scene = load("czest3ctf");
  EXPECT_EQ(scene.triangle_count(), 22'257U);
  EXPECT_EQ(scene.object_count(), 578U);
  EXPECT_EQ(scene.quake->cluster_count, 1441U);
  EXPECT_EQ(scene.cells.size(), 1441U);
  EXPECT_EQ(scene.portals.size(), 2U * 3430U);
  EXPECT_EQ(scene.quake->doubt_about_sets(), "");
  expect_listed_hits(scene, 20);
  expect_walk_in_the_open(
      scene, load_path("czest3ctf_walk", scene, {512, 512}, 0, repository_data()), 400.0);
}

TEST(Czest3ctf, HasFewerCellsThatFitTogetherWhenLeavesAreJoinedToRooms) {
  const Scene scene = load("czest3ctf_rooms");
  EXPECT_EQ(scene.cells.size(), 328U);
  const CellCheck check = check_cells(scene);
  EXPECT_EQ(check.overlaps.count + check.gaps.count + check.off.count, 0U);
}

TEST(Apartment, IsUprightAndSolidInParts) {
  const Scene scene = load("apartment");
  EXPECT_EQ(scene.object_count(), 57U);
  EXPECT_EQ(scene.meshes.size(), 57U);
  EXPECT_EQ(scene.triangle_count(), 10'532U);
  EXPECT_EQ(std::ranges::count_if(scene.meshes, &Mesh::solid), 26);
  EXPECT_EQ(scene.report.open_meshes, 22U);
  EXPECT_NEAR(scene.bounds().max.y, 2.5, 1e-3);  // the walls
  EXPECT_NEAR(scene.bounds().min.y, -0.02, 0.01);
}

TEST(Apartment, IsWalkedThroughWithoutMeetingAnything) {
  const Scene scene = load("apartment");
  const Path path = load_path("apartment_walk", scene, {512, 512}, 240, repository_data());
  for (std::size_t i = 0; i + 1 < path.frames.size(); ++i) {
    const glm::dvec3 from = path.frames[i].camera.pose.eye;
    const glm::dvec3 step = path.frames[i + 1].camera.pose.eye - from;
    EXPECT_TRUE(scene.bounds().contains(from));
    for (ObjectId id = 0; id < scene.object_count(); ++id) {
      Aabb box = transformed(scene.mesh_of(id).bounds, scene.objects[id].transform);
      if (box.max.y - box.min.y > 2.4F) continue;  // the walls, which go round everything
      EXPECT_GT(std::sqrt(distance_squared(box, from)), 0.2) << "object " << id << " frame " << i;
    }
    const Mesh& walls = scene.mesh_of(0);
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t) {
      const auto c = world_triangle(walls, scene.objects[0].transform, t);
      // The eye keeps 0.3 m to both sides and ahead.
      for (const double aside : {-0.3, 0.0, 0.3}) {
        const glm::dvec3 start = from + path.frames[i].camera.pose.right * aside;
        const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
        const glm::dvec3 way = step - path.frames[i].camera.pose.back * 0.3;
        const double slope = glm::dot(normal, way);
        const double u = glm::dot(normal, c[0] - start) / slope;
        if (slope == 0.0 || u < 0.0 || u > 1.0) continue;
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
          const glm::dvec3 edge = c[(k + 1) % 3] - c[k];
          inside &= glm::dot(normal, glm::cross(edge, start + way * u - c[k])) >= 0.0;
        }
        EXPECT_FALSE(inside) << "wall triangle " << t << " frame " << i;
      }
    }
  }
}

TEST(Outdoor, JoinsItsFilesWithoutSkiesAndTwins) {
  const Scene scene = load("outdoor");
  EXPECT_EQ(scene.object_count(), 198U);
  EXPECT_NEAR(scene.bounds().max.x - scene.bounds().min.x, 121.3, 0.1);
  const Path path = load_path("outdoor_walk", scene, {512, 512}, 0, repository_data());
  for (const PathFrame& frame : path.frames) {
    EXPECT_TRUE(scene.bounds().contains(frame.camera.pose.eye));
  }
}

TEST(MixedScene, HasTheModelsOfTheThesis) {
  const Scene scene = load("mixed");
  EXPECT_EQ(scene.object_count(), 8U);
  EXPECT_EQ(scene.meshes.size(), 5U);
  EXPECT_EQ(scene.triangle_count(), 47'794U + 5'804U + 4'184U + 10'000U + 4U * 4'968U);
  for (ObjectId id = 0; id < 8; ++id) {
    const Aabb box = transformed(scene.mesh_of(id).bounds, scene.objects[id].transform);
    EXPECT_NEAR(box.min.y, 0.0, 0.25);  // rotated boxes are a little larger than what is in them
    for (ObjectId other = 0; other < id; ++other) {
      const Aabb next = transformed(scene.mesh_of(other).bounds, scene.objects[other].transform);
      EXPECT_TRUE(box.max.x < next.min.x || box.min.x > next.max.x || box.max.z < next.min.z ||
                  box.min.z > next.max.z);
    }
  }
}

}  // namespace
}  // namespace vislab
