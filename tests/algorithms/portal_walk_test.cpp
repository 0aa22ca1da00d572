// Walks through portals: what is seen is kept wherever the camera stands, and the walk ends.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/geometry/frustum.h"
#include "common/judge/truth.h"
#include "tests/algorithms/portal_rooms.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

constexpr Viewport small_image{64, 64};
const std::array<std::string, 3> variants{"portal.cull_box", "portal.polygon", "portal.frustum"};

std::set<ObjectId> kept_by(CullerRun& run, const Camera& camera) {
  const std::vector<ObjectId> objects = run.objects(camera);
  const std::set<ObjectId> once(objects.begin(), objects.end());
  EXPECT_EQ(once.size(), objects.size()) << "an object was emitted twice";
  return once;
}

/// Objects that a ray hits away from the edges of their triangles.
std::set<ObjectId> seen(RayCaster& caster, const Frame& frame) {
  std::set<ObjectId> objects;
  for (const TriangleHits& hit : caster.trace(frame).hits) {
    if (hit.clear_hits > 0) objects.insert(caster.scene().object_of(hit.triangle));
  }
  return objects;
}

bool holds(const std::set<ObjectId>& all, const std::set<ObjectId>& some) {
  return std::ranges::includes(all, some);
}

Camera looking(const glm::dvec3& eye, const glm::dvec3& target, double roll_deg = 0.0) {
  Camera camera = camera_at(eye, target);
  const Pose pose = camera.pose;
  const double c = std::cos(degrees(roll_deg));
  const double s = std::sin(degrees(roll_deg));
  camera.pose.right = pose.right * c + pose.up * s;
  camera.pose.up = pose.up * c - pose.right * s;
  return camera;
}

/// A scene, rays through it, and all conservative variants side by side.
class Lab {
 public:
  /// `more` are held to what is seen as well.
  explicit Lab(Scene scene, const std::vector<std::string>& more = {})
      : scene_(std::move(scene)),
        caster_(scene_, {4, 1, 1}),
        specs_(variants.begin(), variants.end()) {
    specs_.insert(specs_.end(), more.begin(), more.end());
    for (const std::string& variant : specs_) {
      runs_.push_back(std::make_unique<CullerRun>(variant, scene_));
    }
  }

  /// All keep what is seen; cull_box what polygon keeps. How many objects polygon keeps.
  std::size_t check(const Camera& camera) {
    const std::set<ObjectId> truth = seen(caster_, runs_[0]->frame(camera, small_image));
    std::vector<std::set<ObjectId>> kept;
    for (std::size_t i = 0; i < specs_.size(); ++i) {
      kept.push_back(kept_by(*runs_[i], camera));
      EXPECT_TRUE(holds(kept.back(), truth)) << specs_[i];
    }
    EXPECT_TRUE(holds(kept[0], kept[1])) << "cull_box leaves out what polygon keeps";
    return kept[1].size();
  }
  void update(const Camera& camera, const Changes& changes) {
    for (auto& run : runs_) run->update(camera, changes);
  }
  CullerRun& polygon() { return *runs_[1]; }
  const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  RayCaster caster_;
  std::vector<std::string> specs_;
  std::vector<std::unique_ptr<CullerRun>> runs_;
};

std::size_t count_in_frustum(const Scene& scene, const Camera& camera) {
  CullerRun run("frustum.flat", scene);
  return kept_by(run, camera).size();
}

TEST(PortalWalk, KeepsWhatIsSeenThroughRolledPortalsAndLeavesOutMuchOfTheRest) {
  for (const double roll : {0.0, 20.0, 45.0}) {
    Lab lab(make_room_line({.rooms = 5, .holes = 1, .roll_deg = roll}));
    std::size_t kept = 0;
    std::size_t in_frustum = 0;
    for (std::uint32_t room = 0; room < 5; ++room) {
      for (int turn = 0; turn < 8; ++turn) {
        const glm::dvec3 eye = RoomLine::middle(room) + glm::dvec3(-0.3, 0.2, 0.5);
        const glm::dvec3 ahead(std::cos(turn * 0.8), 0.1, std::sin(turn * 0.8));
        const Camera camera = looking(eye, eye + ahead, 9.0 * turn);
        kept += lab.check(camera);
        in_frustum += count_in_frustum(lab.scene(), camera);
      }
    }
    EXPECT_LT(kept, 0.7 * in_frustum) << roll;
  }
}

TEST(PortalWalk, KeepsWhatIsSeenFromAnyDistanceOfAPortal) {
  const RoomLine line{.rooms = 3, .holes = 1, .roll_deg = 30.0};
  Lab lab(make_room_line(line));
  const glm::dvec3 door = line.hole_middle(1, 0);
  for (const double distance : {1.0, 0.3, 0.1, 0.09, 0.03, 1e-2, 1e-3, 1e-4, 0.0}) {
    for (const double side : {-1.0, 1.0}) {
      for (const glm::dvec3& aside :
           {glm::dvec3(0.0), glm::dvec3(0.0, 0.0, 0.49), glm::dvec3(0.0, 0.3, -0.3)}) {
        const glm::dvec3 eye = door + aside + glm::dvec3(side * distance, 0.0, 0.0);
        for (const double turn : {0.0, 0.4, 1.2, std::numbers::pi / 2.0, 2.5, std::numbers::pi}) {
          SCOPED_TRACE(testing::Message() << distance << " m, side " << side << ", " << turn);
          lab.check(looking(eye, eye + glm::dvec3(std::cos(turn), 0.0, std::sin(turn)), 15.0));
        }
      }
    }
  }
}

TEST(PortalWalk, BehindAPortalNearerThanTheNearPlaneStartingAtTheEyeLeavesOutTheRoom) {
  const RoomLine line{.rooms = 2};
  const Scene scene = make_room_line(line);
  const glm::dvec3 eye = line.hole_middle(0, 0) - glm::dvec3(0.05, 0.0, 0.0);
  const Camera camera = looking(eye, eye + glm::dvec3(1.0, 0.0, 0.0));
  RayCaster caster(scene, {4, 1, 1});
  CullerRun wrong("portal.wrong[error=eye_cell]", scene);
  EXPECT_FALSE(holds(kept_by(wrong, camera), seen(caster, wrong.frame(camera, small_image))));
}

TEST(PortalWalk, OutsideEveryCellKeepsWhatIsInTheFrustum) {
  const Scene scene = make_room_line({.rooms = 4});
  for (const glm::dvec3& eye : {glm::dvec3(-9.0, 2.0, 1.0), glm::dvec3(-0.12, 1.5, 0.0)}) {
    const Camera camera = looking(eye, {8.0, 1.5, 0.0});
    for (const std::string& variant : variants) {
      CullerRun run(variant, scene);
      EXPECT_EQ(kept_by(run, camera).size(), count_in_frustum(scene, camera));
      EXPECT_EQ(run.counter("frames_outside"), 1U);
    }
  }
}

TEST(PortalWalk, CellsThatOverlapDoNotMakeUpForAGap) {
  Scene scene = make_room_line({.rooms = 2});
  ConvexRegion half = scene.cells[0].regions.front();
  half.planes.push_back({{0.0, 0.0, 1.0}, 0.0});
  scene.cells[0].regions = {half, half, half};
  const glm::dvec3 eye = RoomLine::middle(0) + glm::dvec3(0.0, 0.0, 0.03);
  const Camera camera = looking(eye, eye + glm::dvec3(1.0, 0.0, 0.0));
  CullerRun run("portal.polygon", scene);
  EXPECT_EQ(kept_by(run, camera).size(), count_in_frustum(scene, camera));
  EXPECT_EQ(run.counter("frames_outside"), 1U);
  kept_by(run, looking(eye + glm::dvec3(0.0, 0.0, 0.1), eye + glm::dvec3(1.0, 0.0, 0.1)));
  EXPECT_EQ(run.counter("frames_outside"), 1U);
}

TEST(PortalWalk, WithoutCellsKeepsWhatIsInTheFrustum) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (int i = 0; i < 9; ++i) {
    scene.objects.push_back({0, box_transform({2.0 * i, 0.0, 0.0}, glm::dvec3(0.5)), none_id});
  }
  scene.finish();
  const Camera camera = looking({9.0, 0.0, 9.0}, {4.0, 0.0, 0.0});
  CullerRun run("portal.polygon", scene);
  EXPECT_EQ(kept_by(run, camera).size(), count_in_frustum(scene, camera));
}

TEST(PortalWalk, EightPortalsBetweenTwoRoomsDoNotMultiplyFromRoomToRoom) {
  const RoomLine line{.rooms = 9, .holes = 8};
  Lab lab(make_room_line(line));
  const glm::dvec3 eye = RoomLine::middle(0) + glm::dvec3(-1.5, 0.0, 0.3);
  const Camera camera = looking(eye, eye + glm::dvec3(1.0, 0.02, 0.01));
  lab.check(camera);
  const std::uint64_t visits = lab.polygon().counter("cells_visited");
  EXPECT_LE(visits, 9U * 513U);
  EXPECT_GT(visits, 20U);
}

TEST(PortalWalk, EnteringARoomOnceLeavesOutWhatOtherPortalsShow) {
  const RoomLine line{.rooms = 3, .holes = 4};
  const Scene scene = make_room_line(line);
  RayCaster caster(scene, {4, 1, 1});
  CullerRun wrong("portal.wrong", scene);
  const glm::dvec3 eye = RoomLine::middle(0) + glm::dvec3(-1.5, 0.0, 0.0);
  const Camera camera = looking(eye, eye + glm::dvec3(1.0, 0.0, 0.0));
  EXPECT_FALSE(holds(kept_by(wrong, camera), seen(caster, wrong.frame(camera, small_image))));
}

TEST(PortalWalk, ForgettingWhatIsLeftOfTheViewGoesEveryWayToItsBound) {
  const Scene scene = make_room_line({.rooms = 9, .holes = 4});
  RayCaster caster(scene, {4, 1, 1});
  CullerRun right("portal.polygon", scene), wrong("portal.wrong[error=forgets_view]", scene);
  const glm::dvec3 eye = RoomLine::middle(0) + glm::dvec3(-1.5, 0.0, 0.0);
  const Camera camera = looking(eye, eye + glm::dvec3(1.0, 0.0, 0.0));
  EXPECT_TRUE(holds(kept_by(wrong, camera), seen(caster, wrong.frame(camera, small_image))));
  kept_by(right, camera);
  EXPECT_GT(wrong.counter("cells_visited"), 10U * right.counter("cells_visited"));
  EXPECT_LE(wrong.counter("cells_visited"), 9U * 513U);
}

TEST(PortalWalk, EndsInARingOfThirtyRooms) {
  Scene scene = make_room_ring({30, 2, 1});
  for (CellId room = 0; room < 30; ++room) {
    // Between its doors' planes, and as high as a room.
    Cell& cell = scene.cells[room];
    cell.regions = {{cell.bounds, {{{0.0, 1.0, 0.0}, 0.0}, {{0.0, -1.0, 0.0}, 5.0}}}};
    for (const Portal& portal : scene.portals) {
      if (portal.from == room) cell.regions.front().planes.push_back(portal.plane);
    }
    cell.objects.clear();
  }
  for (ObjectId object = 0; object < scene.objects.size(); ++object) {
    const CellId room = scene.objects[object].cell;
    scene.cells[room].objects.push_back(object);
    // A room's object has the passage to the next one, which is behind the portal in part.
    if (scene.objects[object].mesh > 0) scene.cells[(room + 1) % 30].objects.push_back(object);
  }
  for (Cell& cell : scene.cells) std::ranges::sort(cell.objects);
  scene.finish();
  Lab lab(std::move(scene));
  const Pose start = lab.scene().cells[0].regions.empty() ? Pose{} : [&] {
    const glm::dvec3 middle = lab.scene().cells[0].bounds.center();
    const glm::dvec3 next = lab.scene().cells[1].bounds.center();
    return look_at(middle, next);
  }();
  for (int turn = 0; turn < 6; ++turn) {
    const glm::dvec3 ahead =
        -start.back * std::cos(0.5 * turn) + start.right * std::sin(0.5 * turn);
    lab.check(looking(start.eye, start.eye + ahead));
  }
  EXPECT_EQ(lab.polygon().counter("frames_outside"), 0U);
  EXPECT_LE(lab.polygon().counter("cells_visited"), 6U * 30U);
}

TEST(PortalWalk, KeepsWhatIsSeenWhereCellsOverlap) {
  for (const double overlap : {1e-3, 0.1, 0.5}) {
    const RoomLine line{.rooms = 3, .holes = 1, .overlap_m = overlap};
    Lab lab(make_room_line(line));
    for (const double x : {-0.6, -0.4, -0.05, -1e-3, 0.0, 1e-3, 0.05, 0.4, 0.6}) {
      const glm::dvec3 eye = line.hole_middle(0, 0) + glm::dvec3(x, 0.0, 0.1);
      for (const double turn : {0.0, 1.0, 2.0, 3.1}) {
        lab.check(looking(eye, eye + glm::dvec3(std::cos(turn), 0.0, std::sin(turn))));
      }
    }
  }
}

TEST(PortalWalk, AdjacencyLeavesOutTheRoomAfterTheNext) {
  const Scene scene = make_room_line({.rooms = 3});
  RayCaster caster(scene, {4, 1, 1});
  CullerRun run("portal.adjacency", scene);
  const Camera from_middle = looking(RoomLine::middle(1), RoomLine::middle(2));
  EXPECT_TRUE(holds(kept_by(run, from_middle), seen(caster, run.frame(from_middle, small_image))));
  const Camera from_end = looking(RoomLine::middle(0), RoomLine::middle(2));
  EXPECT_FALSE(holds(kept_by(run, from_end), seen(caster, run.frame(from_end, small_image))));
}

TEST(PortalWalk, FollowsFurnitureFromRoomToRoomAndBack) {
  Lab lab(make_room_line({.rooms = 4}));
  const ObjectId box = 1;  // of room 0
  ASSERT_EQ(lab.scene().objects[box].cell, 0U);
  const Camera camera = looking(RoomLine::middle(3) + glm::dvec3(0.0, 0.0, 1.5),
                                RoomLine::middle(3) + glm::dvec3(-0.2, -0.2, 3.0));
  EXPECT_FALSE(kept_by(lab.polygon(), camera).contains(box));
  const auto move = [&](const glm::dmat4x3& transform) {
    lab.update(camera, {{box}, {transform}, {}, {}});
    lab.check(camera);
    return kept_by(lab.polygon(), camera).contains(box);
  };
  const glm::dvec3 in_view = RoomLine::middle(3) + glm::dvec3(0.0, -0.2, 3.0);
  EXPECT_TRUE(move(box_transform(in_view, glm::dvec3(0.3))));
  EXPECT_FALSE(move(box_transform(RoomLine::middle(1), glm::dvec3(0.3))));
  // In no cell: no portal tells anything about it.
  EXPECT_TRUE(move(box_transform(in_view + glm::dvec3(0.0, 0.0, 9.0), glm::dvec3(0.3))));
  EXPECT_FALSE(move(lab.scene().objects[box].transform));

  EXPECT_TRUE(move(box_transform(in_view, glm::dvec3(0.3))));
  lab.update(camera, {{}, {}, {}, {box}});
  EXPECT_FALSE(kept_by(lab.polygon(), camera).contains(box));
  lab.update(camera, {{}, {}, {box}, {}});
  EXPECT_TRUE(kept_by(lab.polygon(), camera).contains(box));
  lab.polygon().reset();
  EXPECT_FALSE(kept_by(lab.polygon(), camera).contains(box));
}

TEST(PortalWalk, SeesThroughThePlaceOfAWallThatIsHiddenOrHasGone) {
  const RoomLine line{.rooms = 4};
  Lab lab(make_room_line(line), {"portal.pvs"});
  ObjectId wall = none_id;  // between rooms 0 and 1
  for (ObjectId object = 0; object < lab.scene().object_count() && wall == none_id; ++object) {
    if (lab.scene().mesh_of(object).name == "wall") wall = object;
  }
  ASSERT_NE(wall, none_id);
  const glm::dvec3 eye = RoomLine::middle(0);
  const Camera camera = looking(eye, eye + glm::dvec3(1.0, 0.0, 0.6));
  const std::size_t closed = lab.check(camera);
  lab.update(camera, {{}, {}, {}, {wall}});
  EXPECT_GT(lab.check(camera), closed);
  // Away from its place nothing is different.
  const Camera elsewhere =
      looking(RoomLine::middle(3), RoomLine::middle(3) + glm::dvec3(0.5, 0, 1));
  EXPECT_LT(lab.check(elsewhere), count_in_frustum(lab.scene(), camera));
  lab.update(camera, {{}, {}, {wall}, {}});
  EXPECT_EQ(lab.check(camera), closed);
  glm::dmat4x3 moved = lab.scene().objects[wall].transform;
  moved[3] += glm::dvec3(0.0, 20.0, 0.0);
  lab.update(camera, {{wall}, {moved}, {}, {}});
  EXPECT_GT(lab.check(camera), closed);
}

// The corners of a portal that lies in the near plane are before and behind it by rounding alone.
TEST(PortalWalk, GoesThroughAPortalOfManyCornersThatLiesInTheNearPlane) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.6, 0.1, 0.8));
  const glm::dvec3 aside = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), normal));
  const glm::dvec3 up = glm::cross(normal, aside);
  std::vector<glm::dvec3> corners;
  for (int i = 0; i < 23; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 23.0;
    corners.push_back(0.9 * (std::cos(angle) * aside + std::sin(angle) * up));
  }
  Scene scene = make_room_line({.rooms = 1});
  for (const double side : {1.0, -1.0}) {
    Cell cell;
    std::vector<Plane> planes{{side * normal, 0.0}};
    for (const glm::dvec3& p : {aside, -aside, up, -up, -side * normal}) planes.push_back({p, 9.0});
    cell.regions = {*region_inside(planes)};
    cell.bounds = cell.regions[0].bounds;
    scene.cells.push_back(cell);
  }
  const auto first = static_cast<CellId>(scene.cells.size() - 2);
  scene.portals.push_back(make_portal(corners, first, first + 1));
  std::ranges::reverse(corners);
  scene.portals.push_back(make_portal(corners, first + 1, first));
  scene.finish();
  std::uint32_t through = 0;
  for (const std::string& variant : variants) {
    CullerRun run(variant, scene);
    for (int i = 0; i < 200; ++i) {
      const double near = 0.02 + 0.0014 * i;
      Camera camera = looking(normal * near + 0.01 * aside, 0.01 * aside);
      camera.lens = perspective_lens(1.0, 1.0, near, 100.0);
      run.objects(camera);
    }
    through += run.counter("cells_visited") > 0 ? 1 : 0;
  }
  EXPECT_EQ(through, variants.size());
}

TEST(PortalWalk, KeepsWhatAnOrthographicCameraSees) {
  Lab lab(make_room_line({.rooms = 4, .holes = 2, .roll_deg = 10.0}));
  Camera camera = looking(RoomLine::middle(1), RoomLine::middle(3) + glm::dvec3(0.0, 0.0, 1.0));
  camera.lens = orthographic_lens(1.0, 1.0, 0.05, 50.0);
  for (const double turn : {0.0, 0.3, std::numbers::pi / 2.0, 2.0, 3.0}) {
    camera.pose =
        look_at(camera.pose.eye, camera.pose.eye + glm::dvec3(std::cos(turn), 0.0, std::sin(turn)));
    lab.check(camera);
  }
  EXPECT_EQ(lab.polygon().counter("frames_outside"), 0U);
}

TEST(PortalWalk, KeepsOnlyWhatIsOffered) {
  const Scene scene = make_room_line({.rooms = 2});
  CullerRun run("portal.polygon", scene);
  const Camera camera = looking(RoomLine::middle(0), RoomLine::middle(1));
  const std::set<ObjectId> all = kept_by(run, camera);
  ASSERT_GT(all.size(), 2U);
  const std::vector<ObjectId> offered{*all.rbegin(), *all.begin()};
  const std::array<std::span<const ObjectId>, 1> runs{offered};
  const std::vector<ObjectId> kept =
      run.objects(camera, Candidates::of(std::span<const std::span<const ObjectId>>(runs)));
  EXPECT_EQ(std::set<ObjectId>(kept.begin(), kept.end()),
            std::set<ObjectId>(offered.begin(), offered.end()));
}

TEST(PortalWalk, EmitsNearRoomsFirst) {
  const Scene scene = make_room_line({.rooms = 4});
  CullerRun run("portal.polygon", scene);
  CellId last = 0;
  for (const ObjectId object : run.objects(looking(RoomLine::middle(0), RoomLine::middle(3)))) {
    EXPECT_GE(scene.objects[object].cell, last);
    last = scene.objects[object].cell;
  }
  EXPECT_EQ(last, 3U);
}

}  // namespace
}  // namespace vislab
