// Scenes whose dials say how much hides what, and polygons that hidden-surface algorithms disagree
// on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"
#include "common/scene/generators/surfaces.h"
#include "common/scene/library.h"
#include "tests/input_error.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

using test::repository_data;

Scene finished(Scene scene) {
  scene.finish();
  return scene;
}

Aabb box_of(const Scene& scene, ObjectId id) {
  return transformed(scene.mesh_of(id).bounds, scene.objects[id].transform);
}

TEST(OcclusionScenes, AreWhatTheirDescriptionsSay) {
  const std::pair<const char*, std::size_t> expected[] = {
      {"slit_wall", 606},        {"lattice_wall", 1201},        {"layered_tiles", 1320},
      {"moving_wall", 2001},     {"open_field", 4900},          {"plant", 4533},
      {"plant_tiny", 224},       {"crossing_quads", 6},         {"cyclic_bars", 3},
      {"tilted_polygons", 100},  {"coplanar_pair", 16},         {"scanline_fence", 100},
      {"touching_spans", 16},    {"city_bridge", 4409},         {"city_heavy", 288},
      {"plant_heavy", 321},      {"open_field_heavy", 144},     {"covered_bars", 128},
      {"phase_hidden_30", 2420}, {"phase_hidden_75_heavy", 360}};
  for (const auto& [name, objects] : expected) {
    const LoadedScene loaded = load_scene(name, repository_data());
    EXPECT_EQ(loaded.scene.object_count(), objects) << name;
    EXPECT_EQ(loaded.scene.report.self_intersecting_meshes, 0U) << name;
    const Path path =
        load_path(loaded.default_path, loaded.scene, {512, 512}, 0, repository_data());
    EXPECT_GE(path.frames.size(), 4U) << name;
  }
}

TEST(CityOfBenchmarks, HasTwoThousandBuildingsAndNoCameraWithinOne) {
  const Scene city = load_scene("city_100k", repository_data()).scene;
  EXPECT_EQ(city.object_count(), 102'000U);
  std::vector<Aabb> boxes;
  for (ObjectId id = 0; id < city.object_count(); ++id) boxes.push_back(box_of(city, id));
  for (const char* name : {"city_street_8", "city_elevated_8"}) {
    const Path path = load_path(name, city, {1024, 512}, 0, repository_data());
    ASSERT_EQ(path.frames.size(), 8U);
    for (const PathFrame& frame : path.frames) {
      EXPECT_EQ(frame.camera.lens.near_m, 0.3);
      EXPECT_EQ(frame.camera.lens.far_m, 3000.0);
      EXPECT_TRUE(std::ranges::none_of(
          boxes, [&](const Aabb& box) { return box.contains(frame.camera.pose.eye); }));
    }
  }
}

TEST(CityOfBenchmarks, MoreThatIsHiddenLeavesTheRestAndLiesWithinBuildings) {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 4;
  parameters.street_boxes = 50;
  const Scene city = finished(make_city(parameters));
  parameters.indoor_boxes = 300;
  const Scene full = finished(make_city(parameters));
  ASSERT_EQ(full.object_count(), 16U + 50U + 300U);
  for (ObjectId id = 0; id < city.object_count(); ++id) {
    EXPECT_EQ(full.objects[id].transform, city.objects[id].transform);
  }
  for (ObjectId id = 66; id < full.object_count(); ++id) {
    const Aabb box = box_of(full, id);
    bool inside = false;
    for (ObjectId building = 0; building < 16; ++building) {
      const Aabb walls = box_of(full, building);
      inside |= walls.contains(glm::dvec3(box.min)) && walls.contains(glm::dvec3(box.max));
    }
    EXPECT_TRUE(inside) << id;
  }
}

TEST(HeavyScenes, HaveAtLeastFiveThousandTrianglesInEveryObjectAndAreClosed) {
  for (const char* name : {"city_heavy", "plant_heavy", "open_field_heavy"}) {
    const Scene scene = load_scene(name, repository_data()).scene;
    for (ObjectId id = 0; id < scene.object_count(); ++id) {
      EXPECT_GE(scene.triangle_count(id), 5000U) << name;
    }
    for (const Mesh& mesh : scene.meshes) EXPECT_TRUE(mesh.solid) << name << ", " << mesh.name;
  }
}

TEST(HeavyScenes, StandWhereTheLightOnesStand) {
  CityParameters city;
  city.blocks_x = city.blocks_z = 4;
  city.street_boxes = 20;
  city.bridges = 1;
  const Scene light = finished(make_city(city));
  city.min_triangles = 1000;
  const Scene heavy = finished(make_city(city));
  ASSERT_EQ(heavy.object_count(), light.object_count());
  for (ObjectId id = 0; id < light.object_count(); ++id) {
    EXPECT_EQ(heavy.objects[id].transform, light.objects[id].transform);
    EXPECT_EQ(heavy.triangle_count(id) >= 1000, id < 16) << id;
  }
  PlantParameters plant;
  plant.bays_x = plant.bays_z = 2;
  const Scene whole = finished(make_plant(plant));
  plant.min_triangles = 500;
  plant.small_parts = false;
  const Scene coarse = finished(make_plant(plant));
  EXPECT_LT(coarse.object_count(), whole.object_count() / 2);
  std::size_t found = 0;  // all of it, in the same order
  for (const Object& object : whole.objects) {
    if (found < coarse.objects.size() && object.transform == coarse.objects[found].transform) {
      ++found;
    }
  }
  EXPECT_EQ(found, coarse.objects.size());
}

/// Does a line from `eye` to `to` meet an object of the scene that is no more than `last`?
bool meets(const Scene& scene, ObjectId last, const glm::dvec3& eye, const glm::dvec3& to) {
  for (ObjectId id = 0; id <= last; ++id) {
    // In the frame of the cube from -1 to 1.
    const glm::dmat4x3& place = scene.objects[id].transform;
    const glm::dmat3 back = glm::inverse(glm::dmat3(place[0], place[1], place[2]));
    const glm::dvec3 from = back * (eye - place[3]);
    const glm::dvec3 step = back * (to - eye);
    double enters = 0.0;
    double leaves = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (-1.0 - from[axis]) / step[axis];
      const double b = (1.0 - from[axis]) / step[axis];
      enters = std::max(enters, std::min(a, b));
      leaves = std::min(leaves, std::max(a, b));
    }
    if (enters < leaves) return true;
  }
  return false;
}

/// How many of the objects after `screens` have all corners of their boxes in the frame of the mesh
/// behind a screen, and how many none.
std::pair<std::size_t, std::size_t> hidden_and_seen(const Scene& scene, ObjectId screens,
                                                    const glm::dvec3& eye) {
  std::size_t hidden = 0;
  std::size_t seen = 0;
  for (ObjectId id = screens; id < scene.object_count(); ++id) {
    std::size_t covered = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Aabb& box = scene.mesh_of(id).bounds;
      const glm::dvec4 at((corner & 1) != 0 ? box.max.x : box.min.x,
                          (corner & 2) != 0 ? box.max.y : box.min.y,
                          (corner & 4) != 0 ? box.max.z : box.min.z, 1);
      covered += meets(scene, screens - 1, eye, scene.objects[id].transform * at);
    }
    hidden += covered == 8;
    seen += covered == 0;
  }
  return {hidden, seen};
}

TEST(ScreenedRing, HidesTheShareThatItsDialSaysAndNothingElseChanges) {
  ScreenedRingParameters parameters;
  parameters.objects = 10;
  const Scene open = finished(make_screened_ring(parameters));
  for (const double hidden : {0.0, 0.3, 0.75, 0.95, 1.0}) {
    parameters.hidden = hidden;
    const Scene scene = finished(make_screened_ring(parameters));
    ASSERT_EQ(scene.object_count(), 440U);
    const auto expected = static_cast<std::size_t>(std::lround(400 * hidden));
    for (const glm::dvec3& eye : {glm::dvec3(0.0), glm::dvec3(0.2, 0.0, 0.0)}) {
      EXPECT_EQ(hidden_and_seen(scene, 40, eye), std::make_pair(expected, 400 - expected));
    }
    for (ObjectId id = 40; id < 440; ++id) {
      EXPECT_EQ(scene.objects[id].transform, open.objects[id].transform);
    }
  }
}

TEST(ScreenedRing, DividesItsTrianglesAmongAsManyObjectsAsItsDialSays) {
  ScreenedRingParameters parameters;
  parameters.sectors = 20;
  parameters.all_triangles = 2'400'000;
  for (const std::uint32_t objects : {1U, 25U, 100U}) {
    parameters.objects = objects;
    const Scene scene = make_screened_ring(parameters);
    EXPECT_EQ(scene.meshes[1].triangles.size(), 120'000U / objects);
  }
  parameters.all_triangles = 2'400;
  EXPECT_EQ(make_screened_ring(parameters).meshes[1].triangles.size(), 12U);
}

TEST(CoveredBars, AreHiddenAtEveryAngleAndTheirBoxesAtNoneButTheFirst) {
  CoveredBarsParameters parameters;
  for (const double angle : {0.0, 10.0, 45.0}) {
    parameters.angle_deg = angle;
    const Scene scene = finished(make_covered_bars(parameters));
    ASSERT_EQ(scene.object_count(), 128U);
    for (const glm::dvec3& eye : {glm::dvec3(-1.0, 0.3, 70.0), glm::dvec3(5.0, 0.0, 70.0)}) {
      EXPECT_EQ(hidden_and_seen(scene, 64, eye).first, 64U) << angle;
    }
    const Aabb box = box_of(scene, 64);
    const glm::dvec3 corner(box.min.x, box.max.y, box.max.z);
    EXPECT_EQ(meets(scene, 63, {0.0, 0.0, 70.0}, corner), angle == 0.0) << angle;
  }
}

TEST(CityOfBenchmarks, BridgesLieOverMiddleStreetsAtTheirClearance) {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 8;
  parameters.bridges = 3;
  parameters.bridge_clearance = 0.5;
  const Scene city = finished(make_city(parameters));
  ASSERT_EQ(city.object_count(), 67U);
  double z = -50.0;
  for (ObjectId id = 64; id < 67; ++id) {
    const Aabb deck = box_of(city, id);
    EXPECT_NEAR(deck.min.y, 10.0, 1e-4);
    EXPECT_NEAR(deck.center().z, z, 1e-3);
    EXPECT_NEAR(deck.max.x - deck.min.x, 200.0, 1e-3);
    z += 50.0;
    for (ObjectId building = 0; building < 64; ++building) {
      const Aabb walls = box_of(city, building);
      EXPECT_TRUE(walls.min.z >= deck.max.z || walls.max.z <= deck.min.z);
    }
  }
}

TEST(SlitWall, HasSlitsOfTheWidthsThatItsDialsSay) {
  SlitWallParameters parameters;
  for (const double gap : {0.0, 0.01, 0.5, 3.0}) {
    parameters.gap_m = gap;
    const Scene scene = finished(make_slit_wall(parameters));
    double expected = gap;
    for (ObjectId panel = 0; panel < parameters.slits; ++panel) {
      const double slit = box_of(scene, panel + 1).min.x - box_of(scene, panel).max.x;
      EXPECT_NEAR(slit, expected, 1e-5);
      expected *= parameters.ratio;
    }
    EXPECT_NEAR(box_of(scene, 0).min.x, -20.0, 1e-5);
    EXPECT_NEAR(box_of(scene, parameters.slits).max.x, 20.0, 1e-5);
  }
}

TEST(LatticeWall, CoversTheShareThatItsDialSays) {
  LatticeWallParameters parameters;
  for (const double coverage : {0.1, 0.5, 0.9, 1.0}) {
    parameters.coverage = coverage;
    const Scene scene = finished(make_lattice_wall(parameters));
    double area = 0.0;
    for (std::uint32_t t = 0; t < scene.triangle_count(0); ++t) {
      const auto c = world_triangle(scene.mesh_of(0), scene.objects[0].transform, t);
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      EXPECT_GT(normal.z, 0.0);
      area += 0.5 * glm::length(normal);
    }
    EXPECT_NEAR(area / 800.0, coverage, 1e-4);
    EXPECT_EQ(scene.report.zero_area_triangles, 0U);
  }
}

TEST(LayeredTiles, CloseTheViewTogetherAndInNoLayerAlone) {
  LayeredTilesParameters parameters;
  for (const std::uint32_t layers : {1U, 3U, 6U}) {
    parameters.layers = layers;
    const Scene scene = finished(make_layered_tiles(parameters));
    const std::uint32_t slats = layers * parameters.slats;
    for (double slope = -0.7; slope < 0.7; slope += 0.0137) {  // of a ray from the origin
      std::uint32_t hits = 0;
      for (ObjectId id = 0; id < slats; ++id) {
        const Aabb slat = box_of(scene, id);
        const double x = -slope * slat.max.z;
        hits += x >= slat.min.x && x <= slat.max.x ? 1 : 0;
      }
      EXPECT_GE(hits, 1U) << layers << " layers, slope " << slope;
      EXPECT_LE(hits, 2U);
    }
  }
}

TEST(LayeredTiles, AreNumberedInTheOrderThatIsAskedFor) {
  LayeredTilesParameters parameters;
  const auto depths = [&](DrawOrder order) {
    parameters.order = order;
    const Scene scene = make_layered_tiles(parameters);
    std::vector<double> z;
    for (ObjectId id = 0; id < 120; ++id) z.push_back(scene.objects[id].transform[3].z);
    return z;
  };
  EXPECT_TRUE(std::ranges::is_sorted(depths(DrawOrder::near_first), std::greater<>()));
  EXPECT_TRUE(std::ranges::is_sorted(depths(DrawOrder::far_first)));
  const std::vector<double> shuffled = depths(DrawOrder::shuffled);
  EXPECT_FALSE(std::ranges::is_sorted(shuffled));
  EXPECT_FALSE(std::ranges::is_sorted(shuffled, std::greater<>()));
}

TEST(OpenField, HasNoBoxInTheShadowOfAnother) {
  OpenFieldParameters parameters;
  parameters.count = 400;
  parameters.spacing_m = 2.4;
  const Scene scene = finished(make_open_field(parameters));
  // Seen from 27 degrees above the ground a box covers less than twice its height behind it.
  for (ObjectId id = 0; id < scene.object_count(); ++id) {
    const Aabb box = box_of(scene, id);
    const double reach = 2.0 * (box.max.y - box.min.y);
    for (ObjectId other = 0; other < id; ++other) {
      const Aabb next = box_of(scene, other);
      const double gap_x = std::max(box.min.x - next.max.x, next.min.x - box.max.x);
      const double gap_z = std::max(box.min.z - next.max.z, next.min.z - box.max.z);
      EXPECT_GE(std::hypot(std::max(gap_x, 0.0), std::max(gap_z, 0.0)), reach - 1e-4);
    }
  }
}

TEST(Plant, StandsWhereItStoodWhateverTheOcclusion) {
  PlantParameters parameters;
  parameters.bays_x = parameters.bays_z = 4;
  std::size_t before = 0;
  std::vector<Object> bare;
  for (const double occlusion : {0.0, 0.3, 0.7, 1.0}) {
    parameters.occlusion = occlusion;
    const Scene scene = finished(make_plant(parameters));
    EXPECT_GT(scene.object_count(), before);
    before = scene.object_count();
    if (bare.empty()) bare = scene.objects;
    std::size_t found = 0;  // everything of the bare plant, in the same order
    for (const Object& object : scene.objects) {
      found += found < bare.size() && object.transform == bare[found].transform ? 1 : 0;
    }
    EXPECT_EQ(found, bare.size());
  }
}

TEST(Plant, IsOfSolidsAndItsAislesAreFree) {
  PlantParameters parameters;
  parameters.bays_x = parameters.bays_z = 4;
  parameters.occlusion = 1.0;
  const Scene scene = finished(make_plant(parameters));
  EXPECT_EQ(std::ranges::count_if(scene.meshes, &Mesh::solid), 3);
  for (ObjectId id = 0; id < scene.object_count(); ++id) {
    const Aabb box = box_of(scene, id);
    for (const double aisle : {-11.0, 0.0, 11.0}) {
      EXPECT_TRUE(box.min.z >= aisle + 1.499 || box.max.z <= aisle - 1.499) << id;
    }
  }
}

TEST(Plant, HasHeavyCoilsFromFifteenSegmentsOn) {
  for (const std::uint32_t segments : {3U, 8U, 15U}) {
    const Mesh coil = coil_mesh(segments, 3.0, 0.15);
    EXPECT_EQ(coil.triangles.size(), 24U * segments * segments + 2U * (segments - 2));
    EXPECT_TRUE(is_closed_outward(coil));
    EXPECT_TRUE(is_closed_outward(pipe_mesh(segments)));
    EXPECT_EQ(pipe_mesh(segments).triangles.size(), 4U * segments - 4U);
  }
  EXPECT_GE(coil_mesh(15, 3.0, 0.15).triangles.size(), 5000U);
}

/// z of a flat object's plane over a place of the xy plane.
double height_at(const Object& object, double x, double y) {
  const glm::dvec3 normal = object.transform[2];
  const glm::dvec3 p = object.transform[3];
  return p.z - (normal.x * (x - p.x) + normal.y * (y - p.y)) / normal.z;
}

TEST(Surfaces, CrossAsDeepAsTheDialSays) {
  for (const double penetration : {0.0, 0.5, 1.0}) {
    const Scene scene = finished(make_crossing_quads({penetration, 2}));
    ASSERT_EQ(scene.object_count(), 4U);
    const double left = scene.objects[1].transform[3].x - 1.0;
    EXPECT_NEAR(height_at(scene.objects[1], left, 0.0), 0.5, 1e-12);
    EXPECT_NEAR(height_at(scene.objects[1], left + 2.0, 0.0), -0.5 * penetration, 1e-12);
    EXPECT_EQ(height_at(scene.objects[0], left, 0.0), 0.0);
  }
}

TEST(Surfaces, BarsAreAPileWithoutTiltAndARingWithIt) {
  for (const auto& [tilt_deg, ring] :
       {std::pair(0.0, false), {0.4, false}, {2.0, true}, {30.0, true}}) {
    const Scene scene = finished(make_cyclic_bars({tilt_deg, 0.02}));
    int over = 0;  // bars that lie over the next where their middle lines cross
    for (int i = 0; i < 3; ++i) {
      const double angle = 2.0 * 3.14159265358979 * (i + 0.5) / 3.0;
      const double x = 0.9 * std::cos(angle);
      const double y = 0.9 * std::sin(angle);
      const double here = height_at(scene.objects[i], x, y);
      over += here > height_at(scene.objects[(i + 1) % 3], x, y) ? 1 : 0;
    }
    EXPECT_EQ(over == 0 || over == 3, ring) << tilt_deg;
  }
}

TEST(Surfaces, NearlyCoplanarPairsDifferByTheirTilt) {
  for (const double tilt : {1e-1, 1e-4, 1e-8}) {
    CoplanarPairParameters parameters;
    parameters.tilt_rad = tilt;
    const Scene scene = finished(make_coplanar_pair(parameters));
    for (ObjectId id = 0; id < scene.object_count(); id += 2) {
      const glm::dvec3 a = scene.objects[id].transform[2];
      const glm::dvec3 b = scene.objects[id + 1].transform[2];
      EXPECT_NEAR(glm::length(glm::cross(a, b)), std::sin(tilt), 1e-15 + 1e-9 * tilt);
      EXPECT_GT(a.z, 0.9);
    }
  }
}

TEST(Surfaces, SpansTouchAtTheirLeftEndsAndTheNearerComesFirstOrSecond) {
  for (const double difference : {0.1, 0.0}) {
    const Scene scene = finished(make_touching_spans({difference, 4}));
    ASSERT_EQ(scene.object_count(), 8U);
    for (ObjectId id = 0; id < 8; ++id) {
      const bool nearer = (id % 2 == 0) == (id / 2 % 2 == 0);
      EXPECT_NEAR(height_at(scene.objects[id], 0.0, 0.0), nearer ? difference : 0.0, 1e-12);
      EXPECT_GT((nearer ? 1.0 : -1.0) * height_at(scene.objects[id], 1.0, 0.0), 0.4);
      EXPECT_NEAR(box_of(scene, id).min.x, 0.0, 1e-12);
    }
  }
}

TEST(Surfaces, TheFenceHasAsManySlatsOnAScanlineAsItsDialSays) {
  for (const std::uint32_t polygons : {1U, 30U, 1000U}) {
    ScanlineFenceParameters parameters;
    parameters.polygons = polygons;
    const Scene scene = finished(make_scanline_fence(parameters));
    EXPECT_EQ(scene.object_count(), polygons);
    for (ObjectId id = 0; id < polygons; ++id) {
      EXPECT_LE(scene.bounds().min.y, -0.99F);
      EXPECT_LE(box_of(scene, id).min.y, -0.99F);
      EXPECT_GE(box_of(scene, id).max.y, 0.99F);
    }
  }
}

TEST(OcclusionScenes, RefuseWrongDials) {
  TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    folder.write("scene.toml", "[generator]\n" + text);
    return input_error([&] { load_scene((folder.path() / "scene.toml").string(), {}); });
  };
  EXPECT_TRUE(says(refused("kind = \"plant\"\nocclusion = 1.5\n"), "occlusion"));
  EXPECT_TRUE(says(refused("kind = \"slit_wall\"\ngap_m = 30.0\n"), "gap_m"));
  EXPECT_TRUE(says(refused("kind = \"layered_tiles\"\norder = \"sideways\"\n"), "near_first"));
  EXPECT_TRUE(says(refused("kind = \"lattice_wall\"\ncoverage = 0.0\n"), "coverage"));
  EXPECT_TRUE(says(refused("kind = \"open_field\"\nspacing_m = 1.0\n"), "spacing_m"));
  EXPECT_TRUE(says(refused("kind = \"jungle\"\n"), "tilted_polygons"));
}

}  // namespace
}  // namespace vislab
