#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/scene/generators/generators.h"
#include "common/scene/paths/tracks.h"
#include "common/scene/settings.h"
#include "tests/input_error.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

Scene slab_scene() {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  scene.objects.push_back({0, box_transform({5.0, 0.0, 0.0}, {4.0, 1.0, 2.0}), none_id});
  scene.finish();
  return scene;
}

class Paths : public testing::Test {
 protected:
  Path load(const std::string& toml, int frames = 0) {
    return load_path(folder_.write("path.toml", toml).string(), scene_, {512, 512}, frames,
                     test::repository_data());
  }
  std::string refused(const std::string& toml) {
    return input_error([&]() { load(toml); });
  }

  TemporaryFolder folder_;
  Scene scene_ = slab_scene();
};

double distance_to_scene(const Scene& scene, const Camera& camera) {
  return std::sqrt(distance_squared(scene.bounds(), camera.pose.eye));
}

TEST_F(Paths, TheFittedPathOfAModelIsAnOrbitOutsideOfItsBox) {
  const Path path = load_path("", scene_, {512, 512}, 0, test::repository_data());
  ASSERT_EQ(path.frames.size(), 60U);
  for (const PathFrame& frame : path.frames) {
    const Lens& lens = frame.camera.lens;
    EXPECT_GT(distance_to_scene(scene_, frame.camera), 0.0);
    EXPECT_NEAR(lens.top / lens.near_m, std::tan(std::acos(-1.0) / 6.0), 1e-12);
    // Nothing of the scene is cut off by the near or far plane.
    for (int corner = 0; corner < 8; ++corner) {
      const Aabb& box = scene_.bounds();
      const glm::dvec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                         (corner & 2) != 0 ? box.max.y : box.min.y,
                         (corner & 4) != 0 ? box.max.z : box.min.z);
      EXPECT_LT(frame.camera.planar_depth(p), lens.far_m);
    }
    const double half_diagonal = std::hypot(lens.top, lens.right, lens.near_m);
    EXPECT_GT(distance_to_scene(scene_, frame.camera), half_diagonal);
  }
}

TEST_F(Paths, ASceneThatIsASinglePointIsSeenFromOneMetreAndMore) {
  for (const glm::dvec3& place : {glm::dvec3(0.0), glm::dvec3(1e-30), glm::dvec3(3.0, -7.0, 1e4)}) {
    scene_ = Scene();
    scene_.meshes.emplace_back();
    scene_.meshes[0].positions.assign(3, glm::vec3(0.0F));
    scene_.meshes[0].triangles.emplace_back(0, 1, 2);
    scene_.objects.push_back({0, box_transform(place, glm::dvec3(1.0)), none_id});
    scene_.finish();
    EXPECT_EQ(scene_.report.zero_area_triangles, 1U);
    const std::string turn = "kind = \"turn\"\neye = [0, 0, 0]\nrelative = true\n";
    const std::string orbit = "kind = \"orbit\"\n";
    const Path fitted = load_path("", scene_, {512, 512}, 0, test::repository_data());
    for (const Path& path : {fitted, load(turn), load(orbit)}) {
      for (const PathFrame& frame : path.frames) {
        const Lens& lens = frame.camera.lens;
        EXPECT_TRUE(std::isfinite(glm::length(frame.camera.pose.back)));
        EXPECT_GT(lens.near_m, 0.0);
        EXPECT_LT(lens.near_m, lens.far_m);
        EXPECT_LT(frame.camera.planar_depth(place), lens.far_m);
      }
    }
    if (glm::length(place) < 1.0) {
      EXPECT_GT(glm::distance(fitted.frames[0].camera.pose.eye, place), 1.0);
    }
  }
}

TEST_F(Paths, TheImageIsAsWideAsTheViewportSays) {
  const Path path = load_path("", scene_, {400, 200}, 0, test::repository_data());
  const Lens& lens = path.frames[0].camera.lens;
  EXPECT_DOUBLE_EQ(lens.right, 2.0 * lens.top);
}

TEST_F(Paths, AreSampledAtAnyNumberOfFrames) {
  const std::string walk = "kind = \"walk\"\npoints = [[0, 5, 9], [10, 5, 9]]\nframes = 11\n";
  const Path path = load(walk);
  ASSERT_EQ(path.frames.size(), 11U);
  EXPECT_EQ(path.frames.front().camera.pose.eye, glm::dvec3(0.0, 5.0, 9.0));
  EXPECT_LT(glm::distance(path.frames[3].camera.pose.eye, glm::dvec3(3.0, 5.0, 9.0)), 1e-12);
  EXPECT_EQ(path.frames.back().camera.pose.eye, glm::dvec3(10.0, 5.0, 9.0));
  EXPECT_EQ(load(walk, 3).frames.size(), 3U);
  EXPECT_EQ(load(walk, 1).frames.size(), 1U);
  EXPECT_EQ(load(walk).content_hash(), path.content_hash());
}

TEST_F(Paths, AWalkLooksWhereItGoesAndTurnsAtCorners) {
  const Path path =
      load("kind = \"walk\"\npoints = [[0, 5, 0], [6, 5, 0], [6, 5, -6]]\nframes = 41\n");
  EXPECT_LT(glm::distance(-path.frames[0].camera.pose.back, glm::dvec3(1.0, 0.0, 0.0)), 1e-12);
  EXPECT_LT(glm::distance(-path.frames[40].camera.pose.back, glm::dvec3(0.0, 0.0, -1.0)), 1e-12);
  int turning = 0;
  for (const PathFrame& frame : path.frames) {
    const glm::dvec3 forward = -frame.camera.pose.back;
    if (forward.x > 0.01 && forward.z < -0.01) {
      ++turning;
      EXPECT_LT(glm::distance(frame.camera.pose.eye, glm::dvec3(6.0, 5.0, 0.0)), 1e-9);
    }
  }
  EXPECT_GE(turning, 3);
}

TEST_F(Paths, AWalkWithATargetLooksAtIt) {
  const Path path = load(
      "kind = \"walk\"\nrelative = true\npoints = [[-2, 0, 2], [2, 0, 2]]\ntarget = [0, 0, 0]\n");
  for (const PathFrame& frame : path.frames) {
    const glm::dvec3 to_target = glm::normalize(scene_.bounds().center() - frame.camera.pose.eye);
    EXPECT_LT(glm::distance(-frame.camera.pose.back, to_target), 1e-12);
  }
}

TEST_F(Paths, ATurnIsOnTheSpotAndClosesUp) {
  const Path path = load("kind = \"turn\"\neye = [1, 2, 30]\nframes = 4\n");
  const glm::dvec3 expected[4] = {{1, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {0, 0, 1}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(path.frames[i].camera.pose.eye, glm::dvec3(1.0, 2.0, 30.0));
    EXPECT_LT(glm::distance(-path.frames[i].camera.pose.back, expected[i]), 1e-12);
  }
}

TEST_F(Paths, ATurnMayLookUpAndTurnByAnAnglePerFrame) {
  const std::string eye = "kind = \"turn\"\neye = [1, 2, 30]\n";
  const double up = std::sin(std::acos(-1.0) / 6.0);
  for (const PathFrame& frame : load(eye + "pitch_deg = 30\n").frames) {
    EXPECT_NEAR(-frame.camera.pose.back.y, up, 1e-12);
  }
  for (const int frames : {2, 5, 21}) {
    const Path path = load(eye + "degrees_per_frame = 150\n", frames);
    for (int i = 0; i < frames; ++i) {
      const glm::dvec3 forward = -path.frames[static_cast<std::size_t>(i)].camera.pose.back;
      const double heading = 150.0 * i * std::acos(-1.0) / 180.0;
      EXPECT_LT(glm::distance(forward, {std::cos(heading), 0.0, -std::sin(heading)}), 1e-9);
    }
  }
  EXPECT_TRUE(says(refused(eye + "degrees = 9\ndegrees_per_frame = 3\n"), "not both"));
}

TEST_F(Paths, RollTheCameraAndPutItsEyeAside) {
  const std::string eye = "kind = \"turn\"\neye = [1, 2, 30]\nframes = 4\n";
  const Path level = load(eye);
  const Path rolled = load(eye + "roll_deg = 90\neye_offset_m = 0.5\n");
  for (std::size_t i = 0; i < 4; ++i) {
    const Pose& a = level.frames[i].camera.pose;
    const Pose& b = rolled.frames[i].camera.pose;
    EXPECT_EQ(b.back, a.back);
    EXPECT_LT(glm::distance(b.up, -a.right), 1e-12);
    EXPECT_LT(glm::distance(b.right, a.up), 1e-12);
    EXPECT_LT(glm::distance(b.eye, a.eye + 0.5 * b.right), 1e-12);
  }
}

TEST_F(Paths, LookAsideByAnAngle) {
  const std::string eye = "kind = \"turn\"\neye = [1, 2, 30]\nframes = 4\npitch_deg = 20\n";
  const Path straight = load(eye);
  const Path aside = load(eye + "off_axis_deg = 30\n");
  for (std::size_t i = 0; i < 4; ++i) {
    const Pose& a = straight.frames[i].camera.pose;
    const Pose& b = aside.frames[i].camera.pose;
    EXPECT_EQ(b.eye, a.eye);
    EXPECT_EQ(b.up, a.up);
    EXPECT_NEAR(glm::dot(b.back, a.back), std::cos(std::acos(-1.0) / 6.0), 1e-12);
    EXPECT_NEAR(glm::dot(-b.back, a.right), 0.5, 1e-12);
    EXPECT_LT(glm::distance(glm::cross(b.right, b.up), b.back), 1e-12);
  }
  EXPECT_TRUE(says(refused(eye + "off_axis_deg = 91\n"), "`off_axis_deg` is wrong"));
}

TEST_F(Paths, AnAsymmetricWindowIsShiftedByAShareOfItsWidth) {
  const Lens centred = load("kind = \"orbit\"\nnear_m = 0.5\n").frames[0].camera.lens;
  for (const double share : {-0.5, 0.25, 0.5}) {
    const std::string key = "asymmetry = " + std::to_string(share) + "\n";
    const Lens lens = load("kind = \"orbit\"\nnear_m = 0.5\n" + key).frames[0].camera.lens;
    const double width = centred.right - centred.left;
    EXPECT_NEAR(lens.left, centred.left + share * width, 1e-12);
    EXPECT_NEAR(lens.right, centred.right + share * width, 1e-12);
    EXPECT_EQ(lens.top, centred.top);
  }
  EXPECT_TRUE(says(refused("kind = \"orbit\"\nasymmetry = 0.6\n"), "`asymmetry` is wrong"));
}

TEST_F(Paths, AnOrthographicImageIsAsHighAsItSays) {
  const Lens lens = load("kind = \"orbit\"\northographic_height_m = 7.0\n").frames[0].camera.lens;
  EXPECT_EQ(lens.projection, Projection::orthographic);
  EXPECT_DOUBLE_EQ(lens.top - lens.bottom, 7.0);
  EXPECT_LT(0.0, lens.near_m);
  EXPECT_LT(lens.near_m, lens.far_m);
  EXPECT_TRUE(says(refused("kind = \"orbit\"\northographic_height_m = 7\nfov_deg = 60\n"),
                   "`fov_deg` is for perspective lenses"));
  EXPECT_TRUE(says(refused("kind = \"orbit\"\northographic_height_m = 7\nfar_m = inf\n"),
                   "finite `far_m`"));
}

TEST_F(Paths, AFarPlaneMayBeInfinitelyFar) {
  const Lens finite = load("kind = \"orbit\"\n").frames[0].camera.lens;
  const Lens infinite = load("kind = \"orbit\"\nfar_m = inf\n").frames[0].camera.lens;
  EXPECT_TRUE(std::isinf(infinite.far_m));
  EXPECT_EQ(infinite.near_m, finite.near_m);
}

TEST_F(Paths, TheCornersOfWideAndShiftedNearPlanesDoNotCutTheScene) {
  for (const std::string& lens :
       {std::string("fov_deg = 150\n"), std::string("fov_deg = 90\nasymmetry = 0.5\n"),
        std::string("orthographic_height_m = 1.0\n")}) {
    SCOPED_TRACE(lens);
    for (const PathFrame& frame : load("kind = \"orbit\"\n" + lens).frames) {
      const Lens& window = frame.camera.lens;
      const double corner =
          std::hypot(std::max(std::abs(window.left), window.right), window.top, window.near_m);
      EXPECT_GT(distance_to_scene(scene_, frame.camera), corner);
    }
  }
}

TEST_F(Paths, StopAndGoStandsHalfOfTheTime) {
  const Path path =
      load("kind = \"stop_and_go\"\npoints = [[0, 5, 9], [10, 5, 9]]\nstops = 5\nframes = 201\n");
  int standing = 0;
  for (std::size_t i = 1; i < path.frames.size(); ++i) {
    standing += path.frames[i].camera.pose == path.frames[i - 1].camera.pose ? 1 : 0;
  }
  EXPECT_NEAR(standing, 100, 5);
  EXPECT_LT(glm::distance(path.frames.back().camera.pose.eye, glm::dvec3(10.0, 5.0, 9.0)), 1e-9);
}

TEST_F(Paths, ACutStaysEquallyLongAtEachEye) {
  const Path path = load(
      "kind = \"cut\"\neyes = [[0, 9, 9], [9, 9, 9], [9, 9, 0]]\n"
      "targets = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\nframes = 12\n");
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(path.frames[i].camera.pose.eye.x, i < 4 ? 0.0 : 9.0);
    EXPECT_EQ(path.frames[i].camera.pose.eye.z, i < 8 ? 9.0 : 0.0);
  }
}

TEST_F(Paths, ARecordedPathGivesEveryPoseOnce) {
  std::string json = R"({"frames": [)";
  constexpr int count = 49;
  for (int i = 0; i < count; ++i) {
    json += (i == 0 ? "" : ",") + std::string(R"({"eye": [)") + std::to_string(i) +
            R"(, 5, 9], "target": [5, 0, 0]})";
  }
  const std::filesystem::path file = folder_.write("recorded.json", json + "]}");
  const Path direct = load_path(file.string(), scene_, {512, 512}, 0, test::repository_data());
  ASSERT_EQ(direct.frames.size(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(direct.frames[static_cast<std::size_t>(i)].camera.pose.eye.x, i);
  }
  EXPECT_EQ(load("kind = \"recorded\"\nfile = \"recorded.json\"\n").content_hash(),
            direct.content_hash());
}

TEST_F(Paths, RefuseRecordingsThatAreWrong) {
  const auto refused_json = [&](const std::string& json) {
    const std::filesystem::path file = folder_.write("wrong.json", json);
    return input_error([&]() {
      load_path(file.string(), scene_, {512, 512}, 0, test::repository_data());
    });
  };
  EXPECT_TRUE(says(refused_json("{\"frames\": ["), "cut short"));
  EXPECT_TRUE(says(refused_json("{\"frames\": []}"), "one pose or more"));
  EXPECT_TRUE(says(refused_json(R"({"frames": [{"eye": [0, 0, 0]}]})"), "frame 0"));
  EXPECT_TRUE(says(refused_json(R"({"frames": [{"eye": [0, 0, 0], "target": [0, 0, 0]}]})"),
                   "must differ"));
  EXPECT_TRUE(says(refused_json(R"({"frames": [{"eye": [0, 0], "target": [0, 0, 1]}]})"),
                   "three finite numbers"));
  EXPECT_TRUE(says(refused_json(R"({"frames": [{"look": 1}]})"), "`look` is not a key"));
}

TEST_F(Paths, RefuseDescriptionsThatAreWrong) {
  EXPECT_TRUE(says(refused("kind = \"spiral\"\n"), "known: cut, orbit"));
  EXPECT_TRUE(says(refused("kind = \"turn\"\n"), "`eye` is missing"));
  EXPECT_TRUE(says(refused("kind = \"turn\"\neye = [0, 0, 0]\neyes = 1\n"), "`eyes` is not a key"));
  EXPECT_TRUE(says(refused("kind = \"walk\"\npoints = [[0, 0, 0]]\n"), "at least 2"));
  EXPECT_TRUE(says(refused("kind = \"orbit\"\ndistance = 0.9\n"), "`distance` is wrong"));
  EXPECT_TRUE(says(refused("kind = \"orbit\"\nnear_m = 5.0\nfar_m = 4.0\n"), "near plane"));
  EXPECT_TRUE(says(refused("kind = \"places\"\n"), "Quake III world"));
  EXPECT_TRUE(says(refused("kind = \"portals\"\n"), "with portals"));
  EXPECT_TRUE(says(refused("kind = \"orbit\"\nframes = 0\n"), "`frames` is wrong"));
  EXPECT_TRUE(says(refused("kind = \"recorded\"\nfile = \"absent.json\"\n"), "does not exist"));
  EXPECT_TRUE(says(input_error([&]() {
                     load_path("no_such_path", scene_, {512, 512}, 0, test::repository_data());
                   }),
                   "`no_such_path` is not a path or file; known:"));
}

TEST_F(Paths, APortalPathVisitsEveryCellAndReturns) {
  RoomRingParameters parameters;
  parameters.rooms = 6;
  Scene ring = make_room_ring(parameters);
  ring.finish();
  const Path path = load_path("ring_walk", ring, {512, 512}, 200, test::repository_data());
  EXPECT_LT(glm::distance(path.frames.front().camera.pose.eye, path.frames.back().camera.pose.eye),
            1e-9);
  double angle = 0.0;
  for (std::size_t i = 1; i < path.frames.size(); ++i) {
    const glm::dvec3 a = path.frames[i - 1].camera.pose.eye;
    const glm::dvec3 b = path.frames[i].camera.pose.eye;
    angle += std::atan2(a.z * b.x - a.x * b.z, a.x * b.x + a.z * b.z);
    EXPECT_NEAR(b.y, 1.6, 1e-12);
  }
  EXPECT_NEAR(angle, 2.0 * std::acos(-1.0), 1e-9);
}

TEST_F(Paths, EveryDescriptionInTheRepositoryLoads) {
  const DataFolders data = test::repository_data();
  Scene ring = make_room_ring(RoomRingParameters());
  ring.finish();
  for (const auto& entry : std::filesystem::directory_iterator(data.data / "paths")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem().string();
    const std::string kind = Settings::from_file(entry.path()).text("kind");
    if (kind == "places" || kind == "tour") continue;  // of Quake III worlds: see the real scenes
    SCOPED_TRACE(name);
    EXPECT_GE(load_path(name, ring, {512, 512}, 0, data).frames.size(), 1U);
    EXPECT_EQ(load_path(name, ring, {512, 512}, 60, data).frames.size(), 60U);
  }
}

}  // namespace
}  // namespace vislab
