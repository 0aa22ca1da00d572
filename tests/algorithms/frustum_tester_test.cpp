#include "algorithms/frustum/frustum_tester.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/geometry/rounding.h"
#include "tests/geometry/adversarial_boxes.h"

namespace vislab {
namespace {

using frustum_culling::FrustumTester;
using frustum_culling::PlaneMask;
using frustum_culling::Switches;

Frame frame_of(const Camera& camera) {
  Frame frame;
  frame.camera = camera;
  return frame;
}

/// What everything has to agree with.
bool excluded(const Frustum& frustum, const Aabb& box) {
  return std::ranges::any_of(frustum.span(),
                             [&](const Plane& plane) { return surely_outside(plane, box); });
}

/// All combinations of the switches.
std::vector<Switches> all_switches() {
  std::vector<Switches> all;
  for (unsigned bits = 0; bits < 16; ++bits) {
    for (const Switches::Meta meta :
         {Switches::Meta::off, Switches::Meta::sphere, Switches::Meta::box}) {
      all.push_back({(bits & 1U) == 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0, meta});
    }
  }
  return all;
}

std::string text(const Switches& s) {
  return std::string(s.masking ? "masking " : "") + (s.plane_coherence ? "plane " : "") +
         (s.motion_coherence ? "motion " : "") + (s.octant ? "octant " : "") +
         (s.meta == Switches::Meta::sphere ? "sphere"
          : s.meta == Switches::Meta::box  ? "box"
                                           : "");
}

/// Could switches make the answer about an object differ from the definition's?
bool keeps_the_definition(const Switches& s) {
  return !s.motion_coherence && s.meta == Switches::Meta::off;
}

TEST(FrustumTester, AgreesWithTheDefinitionOnAdversarialBoxes) {
  Random random(11);
  std::vector<Switches> switches = all_switches();
  std::erase_if(switches, [](const Switches& s) { return !keeps_the_definition(s); });
  std::size_t outside = 0;
  std::size_t tested = 0;
  for (int c = 0; c < 400; ++c) {
    const Camera camera = test::adversarial_camera(random);
    const Frame frame = frame_of(camera);
    const Frustum frustum = frustum_of(camera);
    std::vector<Aabb> boxes;
    for (int i = 0; i < 100; ++i) boxes.push_back(test::adversarial_box(random, camera));
    for (const Switches& s : switches) {
      FrustumTester tester(s);
      tester.resize(boxes.size());
      for (int pass = 0; pass < 2; ++pass) {  // the second time with what the first remembers
        tester.start(frame);
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
          const bool expected = excluded(frustum, boxes[i]);
          ASSERT_EQ(tester.outside(boxes[i], i, tester.all_planes()), expected)
              << text(s) << ", camera " << c << ", box " << i;
          outside += expected ? 1 : 0;
          ++tested;
        }
      }
    }
  }
  EXPECT_GT(outside, tested / 10);
  EXPECT_LT(outside, tested - tested / 10);
}

TEST(FrustumTester, AnswersForNodesHoldForEveryBoxInside) {
  Random random(12);
  std::array<int, 3> answers{};
  for (int c = 0; c < 400; ++c) {
    const Camera camera = test::adversarial_camera(random);
    const Frame frame = frame_of(camera);
    const Frustum frustum = frustum_of(camera);
    for (const Switches& s : all_switches()) {
      if (!keeps_the_definition(s)) continue;
      FrustumTester tester(s);
      tester.resize(30);
      tester.start(frame);
      for (std::uint32_t node = 0; node < 30; ++node) {
        std::vector<Aabb> boxes;
        Aabb around;
        for (std::uint64_t i = 0; i <= random.below(3); ++i) {
          boxes.push_back(test::adversarial_box(random, camera));
          around.extend(boxes.back());
        }
        PlaneMask mask = tester.all_planes();
        const Side side = tester.side(around, node, mask);
        ++answers[static_cast<std::size_t>(side)];
        ASSERT_EQ(side == Side::inside, mask == 0 && side != Side::outside) << text(s);
        for (const Aabb& box : boxes) {
          if (side == Side::outside) {
            ASSERT_TRUE(excluded(frustum, box)) << text(s);
          } else {
            ASSERT_EQ(tester.outside(box, node, mask), excluded(frustum, box)) << text(s);
          }
        }
      }
    }
  }
  for (const int count : answers) EXPECT_GT(count, 1000);
}

/// A camera that stands, turns about its own axes, moves, does both, or changes its lens.
class RandomWalk {
 public:
  explicit RandomWalk(Random& random)
      : random_(&random), camera_(test::adversarial_camera(random)) {
    choose();
  }

  const Camera& camera() const { return camera_; }

  void step() {
    if (random_->below(8) == 0) choose();
    Pose& pose = camera_.pose;
    switch (kind_) {
      case 0:
        break;
      case 1:
        turn(pose.right, pose.back, angle_);
        break;
      case 2:
        turn(pose.back, pose.up, angle_);
        break;
      case 3:
        pose.eye += way_;
        break;
      case 4:
        pose.eye += way_;
        turn(pose.right, pose.back, angle_);
        break;
      default:
        camera_.lens.right *= 1.01;
    }
  }

 private:
  /// Turns two axes of the camera in their plane, the second towards the first.
  static void turn(glm::dvec3& first, glm::dvec3& second, double angle) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const glm::dvec3 turned = first * c - second * s;
    second = second * c + first * s;
    first = turned;
  }

  void choose() {
    kind_ = random_->below(6);
    const double size = test::log_uniform(*random_, 1e-4, 3.0);
    angle_ = random_->below(2) == 0 ? size : -size;
    way_ =
        test::random_vector(*random_, camera_.lens.near_m * test::log_uniform(*random_, 1e-3, 1e4));
  }

  Random* random_;
  Camera camera_;
  std::uint64_t kind_ = 0;
  double angle_ = 0.0;
  glm::dvec3 way_{0.0};
};

/// Does the box meet the frustum, for all that the exact test knows? What lies far beyond the
/// frustum is cut off first: beside it the test would have no digits left for the frustum.
bool meets(const ExactFrustum& exact, const Camera& camera, Aabb box) {
  const Lens& lens = camera.lens;
  if (std::isfinite(lens.far_m)) {
    double reach = std::max(std::abs(lens.near_m), std::abs(lens.far_m));
    for (const double side : {lens.left, lens.right, lens.bottom, lens.top}) {
      reach += std::abs(side) *
               (lens.projection == Projection::perspective ? lens.far_m / lens.near_m : 1.0);
    }
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = std::max(box.min[axis], round_down(camera.pose.eye[axis] - 2.0 * reach));
      box.max[axis] = std::min(box.max[axis], round_up(camera.pose.eye[axis] + 2.0 * reach));
    }
    if (box.empty()) return false;
  }
  return exact.side(box) != Side::outside;
}

TEST(FrustumTester, NeverCullsWhatTheExactTestKeepsOnRandomPaths) {
  Random random(13);
  std::vector<FrustumTester> testers;
  for (const Switches& s : all_switches()) {
    testers.emplace_back(s);
    testers.back().resize(60);
  }
  std::uint64_t skipped = 0;
  for (int path = 0; path < 120; ++path) {
    RandomWalk walk(random);
    std::vector<Aabb> boxes;
    for (int i = 0; i < 60; ++i) boxes.push_back(test::adversarial_box(random, walk.camera()));
    for (FrustumTester& tester : testers) tester.forget();
    for (int step = 0; step < 40; ++step) {
      const Camera& camera = walk.camera();
      const Frame frame = frame_of(camera);
      const ExactFrustum exact(camera);
      const auto moved = static_cast<std::uint32_t>(random.below(60));
      boxes[moved] = test::adversarial_box(random, camera);
      std::vector<bool> seen;
      for (const Aabb& box : boxes) seen.push_back(meets(exact, camera, box));
      for (FrustumTester& tester : testers) {
        tester.forget(moved);
        tester.start(frame);
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
          PlaneMask mask = tester.all_planes();
          const bool node = (i + static_cast<std::uint32_t>(step)) % 2 == 0;
          const bool culled = node ? tester.side(boxes[i], i, mask) == Side::outside
                                   : tester.outside(boxes[i], i, mask);
          ASSERT_FALSE(culled && seen[i])
              << text(tester.switches()) << ", path " << path << ", step " << step << ", box " << i;
          // What six planes exclude is never kept.
          if (!node) {
            ASSERT_TRUE(culled || !excluded(tester.frustum(), boxes[i])) << text(tester.switches());
          }
        }
      }
      walk.step();
    }
  }
  for (const FrustumTester& tester : testers) skipped += tester.skipped_tests();
  EXPECT_GT(skipped, 100000U);
}

constexpr double degree = std::numbers::pi / 180.0;

Camera looking_at(const glm::dvec3& eye, const glm::dvec3& target, double fov_deg = 60.0,
                  double far_m = 100.0) {
  return {look_at(eye, target), perspective_lens(fov_deg * degree, 1.0, 0.1, far_m)};
}

/// Unit cubes on a grid around the origin.
std::vector<Aabb> cubes() {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 low(i % 10 * 8 - 40, i / 10 % 10 * 8 - 40, i / 100 * 8 - 40);
    boxes.push_back({low, low + 1.0F});
  }
  return boxes;
}

struct Counts {
  std::uint64_t planes, skipped, kept;
};

/// Tests the cubes from a camera at the origin that turns step by step about the vertical.
Counts turn_among_cubes(const Switches& switches, double step_deg, int steps) {
  const std::vector<Aabb> boxes = cubes();
  FrustumTester tester(switches);
  tester.resize(boxes.size());
  Counts counts{};
  for (int step = 0; step < steps; ++step) {
    const double angle = step * step_deg * degree;
    tester.start(frame_of(looking_at(glm::dvec3(0.3), glm::dvec3(0.3) +
                                                          glm::dvec3(std::sin(angle), 0.0, 0.0) +
                                                          glm::dvec3(0.0, 0.0, std::cos(angle)))));
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      counts.kept += tester.outside(boxes[i], i, tester.all_planes()) ? 0 : 1;
    }
  }
  counts.planes = tester.plane_tests();
  counts.skipped = tester.skipped_tests();
  return counts;
}

TEST(FrustumTester, EachSwitchSavesPlaneTests) {
  const Counts plain = turn_among_cubes({}, 3.0, 60);
  EXPECT_EQ(plain.skipped, 0U);
  const auto gains = [&](Switches switches, double at_most) {
    const Counts counts = turn_among_cubes(switches, 3.0, 60);
    EXPECT_LE(counts.kept, plain.kept) << text(switches);
    EXPECT_LT(static_cast<double>(counts.planes), at_most * static_cast<double>(plain.planes))
        << text(switches);
  };
  gains({.plane_coherence = true}, 0.8);
  gains({.motion_coherence = true}, 0.7);
  gains({.octant = true}, 0.9);
  gains({.meta = Switches::Meta::sphere}, 0.9);
  gains({.meta = Switches::Meta::box}, 0.9);
}

TEST(FrustumTester, MaskingSavesTheTestsOfChildren) {
  const Frame frame = frame_of(looking_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}));
  const Aabb parent{{-50.0F, -1.0F, -20.0F}, {50.0F, 1.0F, -10.0F}};  // cut by left and right only
  const Aabb child{{-1.0F, -1.0F, -20.0F}, {1.0F, 1.0F, -10.0F}};
  for (const bool masking : {true, false}) {
    FrustumTester tester({.masking = masking});
    tester.start(frame);
    PlaneMask mask = tester.all_planes();
    EXPECT_EQ(tester.side(parent, 0, mask), Side::intersecting);
    EXPECT_EQ(mask, 3);
    const std::uint64_t before = tester.plane_tests();
    EXPECT_EQ(tester.side(child, 1, mask), Side::inside);
    EXPECT_EQ(mask, 0);
    EXPECT_EQ(tester.plane_tests() - before, masking ? 2U : 6U);
  }
}

/// How far a camera of 60 degrees may turn before a box that was just outside of `plane` is tested
/// again: by steps of a degree, to the sign's side.
int steps_without_a_test(const glm::dvec3& axis, double sign, const Aabb& box, int plane) {
  Switches switches;
  switches.motion_coherence = true;
  FrustumTester tester(switches);
  tester.resize(1);
  Camera camera = looking_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  tester.start(frame_of(camera));
  EXPECT_TRUE(surely_outside(tester.frustum().planes[static_cast<std::size_t>(plane)], box));
  EXPECT_TRUE(tester.outside(box, 0, tester.all_planes()));
  const std::uint64_t tests = tester.plane_tests();
  const Pose start = camera.pose;
  for (int step = 1; step < 400; ++step) {
    const double angle = sign * step * degree;
    const auto turned = [&](const glm::dvec3& v) {
      return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
             axis * glm::dot(axis, v) * (1.0 - std::cos(angle));
    };
    camera.pose = {start.eye, turned(start.right), turned(start.up), turned(start.back)};
    tester.start(frame_of(camera));
    tester.outside(box, 0, tester.all_planes());
    if (tester.plane_tests() != tests) return step - 1;
  }
  return 400;
}

TEST(FrustumTester, MotionCoherenceEndsBefore180DegreesLessTheFieldOfView) {
  const glm::dvec3 up(0.0, 1.0, 0.0);
  const glm::dvec3 right(1.0, 0.0, 0.0);
  const Aabb at_left{{-20.0F, 0.0F, -10.0F}, {-19.0F, 1.0F, -9.0F}};
  const Aabb at_right{{19.0F, 0.0F, -10.0F}, {20.0F, 1.0F, -9.0F}};
  const Aabb below{{0.0F, -20.0F, -10.0F}, {1.0F, -19.0F, -9.0F}};
  const Aabb above{{0.0F, 19.0F, -10.0F}, {1.0F, 20.0F, -9.0F}};
  EXPECT_EQ(steps_without_a_test(up, -1.0, at_left, Frustum::left), 119);
  EXPECT_EQ(steps_without_a_test(up, 1.0, at_right, Frustum::right), 119);
  EXPECT_EQ(steps_without_a_test(right, 1.0, below, Frustum::bottom), 119);
  EXPECT_EQ(steps_without_a_test(right, -1.0, above, Frustum::top), 119);
  // Towards the box, or about another axis, it is tested at once.
  EXPECT_EQ(steps_without_a_test(up, 1.0, at_left, Frustum::left), 0);
  EXPECT_EQ(steps_without_a_test(right, -1.0, below, Frustum::bottom), 0);
  EXPECT_EQ(steps_without_a_test(right, 1.0, at_left, Frustum::left), 0);
}

TEST(FrustumTester, MotionCoherenceFollowsTranslationsUntilThePlaneIsReached) {
  Switches switches;
  switches.motion_coherence = true;
  FrustumTester tester(switches);
  tester.resize(1);
  // Behind the far plane, which comes nearer by a metre a step.
  const Aabb box{{0.0F, 0.0F, -121.0F}, {1.0F, 1.0F, -110.5F}};
  for (int step = 0; step < 12; ++step) {
    const glm::dvec3 eye(0.0, 0.0, -step);
    tester.start(frame_of(looking_at(eye, eye - glm::dvec3(0.0, 0.0, 1.0))));
    EXPECT_EQ(tester.outside(box, 0, tester.all_planes()), step <= 10) << step;
    EXPECT_EQ(tester.skipped_tests(), std::min(step, 10)) << step;
  }
}

TEST(FrustumTester, MotionCoherenceForgetsWhenTheLensOrTheBoxChanges) {
  Switches switches;
  switches.motion_coherence = true;
  FrustumTester tester(switches);
  tester.resize(1);
  Camera camera = looking_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  const Aabb box{{-20.0F, 0.0F, -10.0F}, {-19.0F, 1.0F, -9.0F}};
  const auto skips = [&] {
    const std::uint64_t before = tester.skipped_tests();
    tester.start(frame_of(camera));
    EXPECT_TRUE(tester.outside(box, 0, tester.all_planes()));
    return tester.skipped_tests() > before;
  };
  EXPECT_FALSE(skips());
  EXPECT_TRUE(skips());
  camera.lens.far_m *= 2.0;
  EXPECT_FALSE(skips());
  EXPECT_TRUE(skips());
  tester.forget(0);
  EXPECT_FALSE(skips());
  EXPECT_TRUE(skips());
  tester.forget_motion();
  EXPECT_FALSE(skips());
  EXPECT_TRUE(skips());
  tester.forget();
  EXPECT_FALSE(skips());
}

TEST(FrustumTester, OctantsOfAnOffCentreLensLieAroundItsOwnMiddle) {
  // All of the window lies right of the view: its middle is 45 degrees off.
  Camera camera = looking_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  camera.lens = {Projection::perspective, 0.05, 0.2, -0.05, 0.05, 0.1, 100.0};
  FrustumTester tester({.octant = true});
  tester.start(frame_of(camera));
  // Seen right of the camera's vertical, but nearer to the window's left border, which excludes it.
  const Aabb left_of_window{{2.0F, 0.0F, -10.0F}, {2.5F, 0.5F, -9.5F}};
  const Aabb in_window{{12.0F, 0.0F, -10.0F}, {12.5F, 0.5F, -9.5F}};
  EXPECT_TRUE(tester.outside(left_of_window, 0, tester.all_planes()));
  EXPECT_EQ(tester.plane_tests(), 1U);
  EXPECT_FALSE(tester.outside(in_window, 0, tester.all_planes()));
  EXPECT_EQ(tester.plane_tests(), 4U);
}

TEST(FrustumTester, MetaVolumesFindBoxesOffTheCorners) {
  // Off the edge between the left and the far plane, and outside of neither.
  const Camera camera = looking_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 60.0, 10.0);
  const Aabb box{{-40.0F, -1.0F, -40.0F}, {-6.1F, 1.0F, -9.5F}};
  for (const Switches::Meta meta : {Switches::Meta::off, Switches::Meta::box}) {
    FrustumTester tester({.meta = meta});
    tester.start(frame_of(camera));
    EXPECT_EQ(tester.outside(box, 0, tester.all_planes()), meta != Switches::Meta::off);
  }
  Camera endless = camera;
  endless.lens.far_m = std::numeric_limits<double>::infinity();
  for (const Switches::Meta meta : {Switches::Meta::sphere, Switches::Meta::box}) {
    FrustumTester tester({.meta = meta});
    tester.start(frame_of(endless));
    EXPECT_FALSE(tester.outside(box, 0, tester.all_planes()));
    EXPECT_EQ(tester.skipped_tests(), 0U);
  }
}

TEST(FrustumTester, KeepsBrokenBoxesWithEverySwitch) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const Camera camera = looking_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  for (const Switches& s : all_switches()) {
    FrustumTester tester(s);
    tester.resize(2);
    for (int pass = 0; pass < 2; ++pass) {
      tester.start(frame_of(camera));
      for (const float broken : {nan, infinity, -infinity}) {
        for (int axis = 0; axis < 3; ++axis) {
          Aabb box{{500.0F, 500.0F, 500.0F}, {501.0F, 501.0F, 501.0F}};
          box.min[axis] = broken;
          PlaneMask mask = tester.all_planes();
          EXPECT_EQ(tester.side(box, 0, mask), Side::intersecting) << text(s);
          EXPECT_EQ(mask, tester.all_planes());
          EXPECT_FALSE(tester.outside(box, 1, mask)) << text(s);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vislab
