// backface.normal_mask: its classes, its kernels, what it finds, and that it is never wrong.
#include <gtest/gtest.h>

#include <bit>
#include <iostream>
#include <set>

#include "algorithms/backface/normal_mask.h"
#include "algorithms/backface/view_masks.h"
#include "common/scene/error.h"
#include "common/simd/simd_target.h"
#include "experiments/bench/backface/normals_field.h"
#include "tests/algorithms/facing_worlds.h"
#include "tests/geometry/exact_facing.h"

namespace vislab {
namespace {

using namespace backface_culling;
using test::FacingCounts;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int trials = 1;
#else
constexpr int trials = 10;
#endif

/// `f` once with each instruction set, and once with the best for each kernel.
template <typename Function>
void with_every_target(Function&& f) {
  f("default");
  for (const std::string& target : simd_targets()) {
    const SimdTargetScope scope(target);
    f(target);
  }
}

/// What a culler leaves out, judged exactly.
FacingCounts judged(const std::string& spec, const Scene& scene, const Camera& camera) {
  CullerRun run(spec, scene);
  const Frame frame = run.frame(camera);
  const std::vector<TriangleRange> kept = run.emitted(camera);
  return test::count_facings(scene, frame, test::exact_facings(scene, frame), kept);
}

Scene one_object(Mesh mesh, const glm::dmat4x3& transform = glm::dmat4x3(1.0)) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.objects = {{0, transform, none_id}};
  scene.finish();
  return scene;
}

glm::dvec3 unit_vector(Random& random) {
  glm::dvec3 v;
  do {
    v = test::vector_in(random, 1.0);
  } while (glm::length(v) > 1.0 || glm::length(v) < 0.1);
  return glm::normalize(v);
}

bool contains(const BackMask& mask, int class_index) {
  return (mask.bytes[class_index / 8] >> (class_index % 8) & 1) != 0;
}

TEST(DirectionCube, ClassesCoverTheSphere) {
  for (const int n : {1, 2, 5, 16, 18}) {
    const DirectionCube cube(n);
    EXPECT_EQ(cube.class_count(), 6 * n * n);
    Random random(4);
    std::set<int> reached;
    const auto is_in_its_square = [&](const glm::dvec3& normal) {
      const std::optional<int> found = cube.class_of(normal, 0.0);
      ASSERT_TRUE(found);
      ASSERT_GE(*found, 0);
      ASSERT_LT(*found, cube.class_count());
      reached.insert(*found);
      const std::array<glm::vec3, 4> corners = cube.corners(*found);
      const glm::dvec3 size = glm::abs(normal);
      const glm::dvec3 on_cube = normal / std::max({size.x, size.y, size.z});
      for (int axis = 0; axis < 3; ++axis) {
        const float low = std::min(corners[0][axis], corners[3][axis]);
        const float high = std::max(corners[0][axis], corners[3][axis]);
        EXPECT_GE(on_cube[axis], low - 1e-6);
        EXPECT_LE(on_cube[axis], high + 1e-6);
      }
    };
    for (int i = 0; i < 3000; ++i) is_in_its_square(unit_vector(random));
    // Edges and corners of the cube and of its squares.
    for (int x = -n; x <= n; ++x) {
      for (int y = -n; y <= n; ++y) {
        is_in_its_square(glm::dvec3(x, y, n));
        is_in_its_square(glm::dvec3(-n, x, y));
      }
    }
    for (int c = 0; c < cube.class_count(); ++c) {
      const std::array<glm::vec3, 4> corners = cube.corners(c);
      const glm::dvec3 middle(0.25F * (corners[0] + corners[1] + corners[2] + corners[3]));
      EXPECT_EQ(cube.class_of(middle, 0.0), c);
      reached.insert(c);
    }
    EXPECT_EQ(static_cast<int>(reached.size()), cube.class_count());
  }
}

TEST(DirectionCube, MarksAClassOnlyIfAllOfItsNormalsFaceAway) {
  Random random(5);
  for (const int n : {1, 3, 16, 18}) {
    const DirectionCube cube(n);
    int marked = 0;
    int all_behind = 0;
    for (int i = 0; i < 200; ++i) {
      MeshDirection v;
      v.direction = i < 6 ? glm::vec3(0.0F) : glm::vec3(unit_vector(random));
      if (i < 6) v.direction[i / 2] = i % 2 == 0 ? 1.0F : -1.0F;
      const BackMask mask = cube.facing_away(v);
      for (int c = 0; c < cube.class_count(); ++c) {
        bool behind = true;
        for (const glm::vec3& corner : cube.corners(c)) {
          behind = behind && glm::dot(glm::dvec3(corner), glm::dvec3(v.direction)) > 1e-5;
        }
        const bool is_marked = contains(mask, c);
        marked += is_marked ? 1 : 0;
        all_behind += behind ? 1 : 0;
        if (behind) {
          EXPECT_TRUE(is_marked) << "class " << c;
        }
        for (const glm::vec3& corner : cube.corners(c)) {
          const double product = glm::dot(glm::dvec3(corner), glm::dvec3(v.direction));
          EXPECT_TRUE(!is_marked || product > 0.0) << "class " << c;
        }
      }
      for (int c = cube.class_count(); c < 2048; ++c) EXPECT_FALSE(contains(mask, c));
    }
    EXPECT_GE(marked, all_behind);
    EXPECT_GE(marked, n > 1 ? 200 * cube.class_count() / 10 : 0);
  }
}

TEST(DirectionCube, LeavesAMarginForRoundingAndForTheErrorOfDirections) {
  Random random(11);
  int marked = 0;
  int unsure = 0;
  for (const int n : {3, 16, 18}) {
    const DirectionCube cube(n);
    for (int i = 0; i < 3000; ++i) {
      // A corner of a class that is seen edge-on, or nearly.
      const auto c = static_cast<int>(random.below(static_cast<std::uint64_t>(cube.class_count())));
      const std::array<glm::vec3, 4> corners = cube.corners(c);
      const glm::dvec3 corner(corners[random.below(4)]);
      const glm::dvec3 edge_on = glm::cross(corner, unit_vector(random));
      const double error = random.below(2) == 0 ? 0.0 : 1e-4 * random.uniform();
      const glm::dvec3 tilted =
          edge_on + corner * ((1e-5 + 2.0 * error) * random.uniform(0.0, 1.0));
      MeshDirection v;
      v.direction = tilted / std::max({std::abs(tilted.x), std::abs(tilted.y), std::abs(tilted.z)});
      v.error = static_cast<float>(error);
      double least = 1.0;
      const int axis = c / (n * n) / 2;
      for (const glm::vec3& m : corners) {
        // The square and the direction are both moved as far as they may be.
        const double beside =
            std::abs(v.direction[(axis + 1) % 3]) + std::abs(v.direction[(axis + 2) % 3]);
        const double size = std::abs(m.x) + std::abs(m.y) + std::abs(m.z);
        least = std::min(least, glm::dot(glm::dvec3(m), glm::dvec3(v.direction)) -
                                    0x1p-20 * beside - error * size);
      }
      const bool is_marked = contains(cube.facing_away(v), c);
      EXPECT_TRUE(!is_marked || least > 0.0) << "class " << c << " of " << n << ", " << least;
      marked += is_marked ? 1 : 0;
      unsure += least <= 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(marked, 500);
  EXPECT_GT(unsure, 500);
}

TEST(DirectionCube, MarksNothingForADirectionThatIsNotKnown) {
  const DirectionCube cube(16);
  EXPECT_EQ(cube.facing_away({glm::vec3(0.0F, 0.0F, -1.0F), 1.0F}), BackMask{});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(cube.facing_away({glm::vec3(nan), 0.0F}), BackMask{});
  EXPECT_EQ(cube.facing_away({glm::vec3(0.0F), nan}), BackMask{});
}

TEST(DirectionCube, GivesTrianglesWithoutAreaOrNearlySoNoClass) {
  Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, 2.0F, 3.0F}, {2.0F, 4.0F, 6.0F}, {0.1F, 0.1F, 0.1F},
                    {0.3F, 0.3F, 0.3F}, {0.7F, 0.7F, 0.7F}, {0.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}, {1, 1, 0}, {3, 4, 5}, {0, 1, 6}};
  const DirectionCube cube(16);
  EXPECT_FALSE(cube.class_of(mesh, 0));
  EXPECT_FALSE(cube.class_of(mesh, 1));
  EXPECT_FALSE(cube.class_of(mesh, 2));
  EXPECT_TRUE(cube.class_of(mesh, 3));
  EXPECT_FALSE(cube.class_of(glm::dvec3(0.0), 0.0));
  EXPECT_FALSE(cube.class_of(glm::dvec3(1.0, 2.0, 3.0), 1e-3));
}

TEST(NormalMask, RefusesMoreClassesThanTwoBytesTell) {
  Registry registry;
  register_all_cullers(registry);
  EXPECT_NO_THROW(registry.make("backface.normal_mask[n=18]"));
  for (const char* n : {"19", "0", "256"}) {
    try {
      registry.make("backface.normal_mask[n=" + std::string(n) + "]");
      ADD_FAILURE() << n << " was taken";
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("1 to 18"), std::string::npos) << message;
      EXPECT_NE(message.find("backface.normal_mask"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
  try {
    const DirectionCube cube(19);
    ADD_FAILURE() << "19 was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("1 to 18"), std::string::npos) << error.what();
  }
}

TEST(NormalMask, TakesTwoBytesATriangleAndALittleForBlocks) {
  const Scene scene = one_object(sphere_mesh(60));
  CullerRun run("backface.normal_mask", scene);
  const auto triangles = static_cast<double>(scene.triangle_count());
  const auto bytes = static_cast<double>(run.culler().bytes());
  EXPECT_GE(bytes, 2.0 * triangles);
  EXPECT_LE(bytes, (2.0 + 24.0 / 128.0) * triangles + 1000.0);
}

TEST(MaskKernel, AnswersTheSameWithEveryInstructionSetAndAnywhere) {
  Random random(6);
  for (int trial = 0; trial < 40; ++trial) {
    BackMask mask;
    const std::size_t used = std::array<std::size_t, 4>{256, 192, 27, 1}[random.below(4)];
    for (std::size_t i = 0; i < used; ++i) {
      mask.bytes[i] = static_cast<std::uint8_t>(random.below(256));
    }
    const std::size_t first = random.below(70);
    const std::size_t count = random.below(400);
    std::vector<std::uint8_t> offsets(first + count + mask_kernel_padding);
    std::vector<std::uint8_t> bits(offsets.size());
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      offsets[i] = static_cast<std::uint8_t>(random.below(256));
      bits[i] = static_cast<std::uint8_t>(random.below(9) == 8 ? 0 : 1 << random.below(8));
    }
    std::vector<std::uint64_t> expected((count + 63) / 64 + 1, 77);
    look_up_scalar(mask, offsets.data() + first, bits.data() + first, count, expected.data());
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_back = (mask.bytes[offsets[first + i]] & bits[first + i]) != 0;
      ASSERT_EQ(expected[i / 64] >> (i % 64) & 1, is_back ? 1U : 0U);
    }
    with_every_target([&](const std::string& target) {
      std::vector<std::uint64_t> back(expected.size(), 77);
      look_up(mask, offsets.data() + first, bits.data() + first, count, back.data());
      EXPECT_EQ(back, expected) << target;
      // The mask for every other word or two, and nothing for the rest.
      const std::array<BackMask, 3> masks{BackMask{}, mask, mask};
      const std::size_t words = count / 64;
      std::vector<std::uint16_t> numbers(words);
      for (std::size_t w = 0; w < words; ++w) numbers[w] = static_cast<std::uint16_t>(w % 3);
      look_up_words(masks.data(), numbers.data(), offsets.data() + first, bits.data() + first,
                    words, back.data());
      for (std::size_t w = 0; w < words; ++w) {
        EXPECT_EQ(back[w], numbers[w] == 0 ? 0 : expected[w]) << target;
      }
    });
  }
}

TEST(SectorKernel, PutsBoxesBetweenTheSameLinesWithEveryInstructionSet) {
  Random random(7);
  int known = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double reach = std::array<double, 3>{10.0, 1e3, 1e7}[random.below(3)];
    Camera camera;
    camera.pose = look_at(test::vector_in(random, reach), test::vector_in(random, reach));
    const glm::dmat3 linear = test::linear_map(random, false);
    const glm::dvec3 place = camera.pose.eye - camera.pose.back * random.uniform(0.0, 8.0);
    const glm::dmat4x3 transform{linear[0], linear[1], linear[2], place};
    MeshFrame mesh;
    mesh.middle = test::vector_in(random, 2.0);
    mesh.size = 1.0;
    Lens lens = perspective_lens(degrees(random.uniform(10.0, 150.0)), 1.3, 0.1, 100.0);
    lens.left *= random.uniform(0.2, 2.0);
    const SectorLines lines(lens, 1 + static_cast<int>(random.below(SectorLines::most_sectors)));
    const std::size_t count = 1 + random.below(70);
    PointBoxes boxes(count);
    std::vector<std::vector<glm::dvec3>> points(count);
    for (std::size_t box = 0; box < count; ++box) {
      const glm::dvec3 middle = test::vector_in(random, 0.9);
      for (int i = 0; i < (box % 2 == 0 ? 1 : 4); ++i) {
        glm::dvec3 local = mesh.middle + middle + test::vector_in(random, 0.1);
        if (box % 2 == 0) {
          // On a line of each kind, as nearly as float allows.
          const auto some_line = [&] {
            return static_cast<int>(random.below(static_cast<std::uint64_t>(lines.count())));
          };
          const double x = lines.x(some_line());
          const double y = lines.y(some_line());
          const Pose& pose = camera.pose;
          const glm::dvec3 world =
              pose.eye + random.uniform(0.1, 9.0) * (x * pose.right + y * pose.up - pose.back);
          local = glm::inverse(linear) * (world - place);
        }
        // Points of a mesh are float.
        const glm::dvec3 point = glm::dvec3(glm::vec3(local));
        mesh.size =
            std::max({mesh.size, std::abs(point.x - mesh.middle.x),
                      std::abs(point.y - mesh.middle.y), std::abs(point.z - mesh.middle.z)});
        points[box].push_back(point);
        boxes.add(box, point - mesh.middle);
      }
    }
    const SectorRows rows = sector_rows(camera, lines, transform, mesh);
    std::vector<Rectangle> expected(count);
    find_rectangles_scalar(rows, boxes, 0, count, expected.data());
    with_every_target([&](const std::string& target) {
      std::vector<Rectangle> found(count);
      find_rectangles(rows, boxes, 0, count, found.data());
      EXPECT_EQ(found, expected) << target;
      const std::size_t first = count / 2;
      find_rectangles(rows, boxes, first, count - first, found.data());
      EXPECT_TRUE(std::equal(expected.begin() + static_cast<std::ptrdiff_t>(first), expected.end(),
                             found.begin()))
          << target;
    });
    for (std::size_t box = 0; box < count; ++box) {
      const Rectangle& rectangle = expected[box];
      if (!rectangle.known()) continue;
      ++known;
      for (const glm::dvec3& point : points[box]) {
        using Exact = glm::tvec3<long double>;
        const Exact seen = Exact(linear[0]) * static_cast<long double>(point.x) +
                           Exact(linear[1]) * static_cast<long double>(point.y) +
                           Exact(linear[2]) * static_cast<long double>(point.z) +
                           (Exact(transform[3]) - Exact(camera.pose.eye));
        const long double z = -glm::dot(seen, Exact(camera.pose.back));
        const long double x = glm::dot(seen, Exact(camera.pose.right));
        const long double y = glm::dot(seen, Exact(camera.pose.up));
        ASSERT_GT(z, 0.0L);
        EXPECT_GE(x, lines.x(rectangle.left) * z);
        EXPECT_LE(x, lines.x(rectangle.right) * z);
        EXPECT_GE(y, lines.y(rectangle.bottom) * z);
        EXPECT_LE(y, lines.y(rectangle.top) * z);
      }
    }
  }
  EXPECT_GT(known, 300);
}

TEST(NormalMask, FindsTheSharesThatWerePredicted) {
  struct Prediction {
    double fov_deg;
    std::array<double, 3> recall;  // 1 sector, 4 x 4, 8 x 8
  };
  const std::array<Prediction, 5> predictions{{{30.0, {0.62, 0.85, 0.89}},
                                               {45.0, {0.49, 0.82, 0.88}},
                                               {60.0, {0.36, 0.78, 0.86}},
                                               {90.0, {0.20, 0.72, 0.82}},
                                               {120.0, {0.06, 0.65, 0.80}}}};
  const std::array<int, 3> sectors{1, 4, 8};
  for (const Prediction& prediction : predictions) {
    const NormalsField field = normals_field(prediction.fov_deg, 16, 150, 5);
    ASSERT_TRUE(field.scene.meshes[0].solid);
    const SceneState state(field.scene);
    const Frame frame{0, field.camera, {64, 64}, state.view(), 0.0};
    const std::vector<test::Facing> facings = test::exact_facings(field.scene, frame);
    for (std::size_t i = 0; i < sectors.size(); ++i) {
      CullerRun run("backface.normal_mask[sectors=" + std::to_string(sectors[i]) + "]",
                    field.scene);
      const FacingCounts counts =
          test::count_facings(field.scene, frame, facings, run.emitted(field.camera));
      EXPECT_TRUE(counts.all_right());
      EXPECT_NEAR(counts.recall(), prediction.recall[i], 0.03)
          << prediction.fov_deg << " degrees, " << sectors[i] << " sectors a side";
    }
  }
}

/// A lens of any kind: wide, off-centre, orthographic.
Lens any_lens(Random& random, double reach) {
  const double near_m = 0.01;
  if (random.below(4) == 0) {
    return orthographic_lens(random.uniform(0.1, 10.0) * reach, 1.0, 0.0, 100.0 * reach);
  }
  Lens lens = perspective_lens(degrees(random.uniform(5.0, 170.0)), random.uniform(0.5, 2.0),
                               near_m, 100.0 * reach);
  if (random.below(3) == 0) {
    const double x = random.uniform(-2.0, 2.0) * near_m;
    lens.left += x;
    lens.right += x;
    lens.bottom += 0.5 * x;
    lens.top += 0.5 * x;
  }
  return lens;
}

TEST(NormalMask, IsNeverWrongWithAnyLensNumberOfSectorsAndTransform) {
  Random random(8);
  FacingCounts sum;
  BumpySphereParameters parameters;
  parameters.subdivisions = 12;
  parameters.bumps = Bumps::low;
  const Mesh bumpy = bumpy_sphere_mesh(parameters);
  for (int trial = 0; trial < 12 * trials; ++trial) {
    Scene scene;
    scene.meshes = {bumpy, cube_mesh()};
    const glm::dvec3 middle = test::vector_in(random, trial % 3 == 0 ? 1e6 : 10.0);
    for (std::uint32_t i = 0; i < 4; ++i) {
      const glm::dmat3 linear = i == 0 ? glm::dmat3(1.0) : test::linear_map(random, trial % 2 == 0);
      const glm::dvec3 place = middle + test::vector_in(random, 6.0);
      scene.objects.push_back({i / 3, {linear[0], linear[1], linear[2], place}, none_id});
    }
    scene.finish();
    const std::string spec =
        "backface.normal_mask[n=" + std::to_string(2 + random.below(17)) +
        ",sectors=" + std::to_string(1 + random.below(SectorLines::most_sectors)) + "]";
    for (int view = 0; view < 6; ++view) {
      Camera camera = test::facing_camera(random, scene);
      if (view % 2 == 0) camera.lens = any_lens(random, 20.0);
      const FacingCounts counts = judged(spec, scene, camera);
      EXPECT_TRUE(counts.all_right())
          << spec << ", trial " << trial << ", view " << view << ": " << counts.front_left_out
          << " front faces, " << counts.edge_on_left_out << " edge-on";
      sum += counts;
    }
  }
  std::cout << sum.back << " back faces, " << sum.back_left_out << " left out\n";
  EXPECT_GT(sum.back_left_out, sum.back / 4);
}

TEST(NormalMask, TestsObjectsBesideTheView) {
  const Scene scene = one_object(sphere_mesh(8));
  Camera camera = camera_at({0.0, 0.0, 9.0}, {9.0, 0.0, 0.0});  // 45 degrees beside the middle
  camera.lens = perspective_lens(degrees(40.0), 1.0, 0.1, 100.0);
  const FacingCounts counts = judged("backface.normal_mask", scene, camera);
  EXPECT_TRUE(counts.all_right());
  EXPECT_GT(counts.recall(), 0.5);
}

TEST(NormalMask, KeepsWhatReachesBehindTheEye) {
  // Beside the eye, half of it in front.
  const Scene scene = one_object(sphere_mesh(8));
  const Camera camera = camera_at({0.0, 0.0, 3.0}, {3.0, 0.0, 3.0});
  EXPECT_EQ(judged("backface.normal_mask", scene, camera).back_left_out, 0U);
}

TEST(NormalMask, AnswersTheSameForPartsOfAMesh) {
  Random random(9);
  const Scene scene = one_object(sphere_mesh(20));
  const Camera camera = camera_at({0.4, 0.7, 2.2}, {0.3, 0.0, 0.0});
  const auto left_out = [&](const std::vector<TriangleRange>& offered) {
    CullerRun run("backface.normal_mask[sectors=16]", scene);
    const std::span<const TriangleRange> span(offered);
    std::set<std::uint32_t> out;
    for (const TriangleRange& range : offered) {
      for (std::uint32_t i = 0; i < range.count; ++i) out.insert(range.first + i);
    }
    for (const TriangleRange& range : run.emitted(
             camera, Candidates::of(std::span<const std::span<const TriangleRange>>(&span, 1)))) {
      for (std::uint32_t i = 0; i < range.count; ++i) out.erase(range.first + i);
    }
    return out;
  };
  const std::uint32_t all = scene.triangle_count(0);
  const std::set<std::uint32_t> whole = left_out({{0, 0, all}});
  EXPECT_GT(whole.size(), all / 4);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<TriangleRange> parts;
    const std::uint64_t longest = trial % 2 == 0 ? 9 : 300;
    for (std::uint32_t first = 0; first < all;) {
      const auto count = static_cast<std::uint32_t>(
          std::min<std::uint64_t>(1 + random.below(longest), all - first));
      parts.push_back({0, first, count});
      first += count;
    }
    EXPECT_EQ(left_out(parts), whole) << "parts of up to " << longest;
  }
}

TEST(NormalMask, MakesMasksOnceForObjectsThatAreTurnedTheSame) {
  Random random(10);
  const glm::dmat3 linear = test::linear_map(random, false);
  Scene scene;
  scene.meshes = {sphere_mesh(4)};
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 place(0.1 * (i % 10) - 0.5, 0.1 * (i / 10) - 0.5, 0.0);
    scene.objects.push_back(
        {0, {linear[0] * 0.01, linear[1] * 0.01, linear[2] * 0.01, place}, none_id});
  }
  scene.finish();
  CullerRun run("backface.normal_mask[sectors=1]", scene);
  const Camera camera = camera_at({0.0, 0.0, 2.0}, {0.0, 0.0, 0.0});
  const std::vector<TriangleRange> first = run.emitted(camera);
  EXPECT_EQ(run.counter("directions_tested"), 4U);
  EXPECT_EQ(run.emitted(camera), first);
  EXPECT_EQ(run.counter("directions_tested"), 8U);  // another frame
}

TEST(NormalMask, MakesMasksAnewWhenTheCameraTurns) {
  const Scene scene = one_object(sphere_mesh(20));
  CullerRun both("backface.normal_mask", scene);
  const Camera first = camera_at({0.0, 0.0, 3.0}, {0.0, 0.0, 0.0});
  const Camera second = camera_at({0.5, 0.0, 3.0}, {-1.0, 0.4, 0.0});
  // Also within one frame: stereo pairs are two calls.
  const auto seen = [&](CullerRun& run, const Camera& camera) {
    RecordingSink sink;
    const Frame frame{0, camera, {64, 64}, run.frame(camera).objects, 0.0};
    sink.start(scene, frame);
    run.culler().cull(frame, Candidates::everything(), sink);
    return sink.emitted();
  };
  const std::vector<TriangleRange> of_first = seen(both, first);
  CullerRun fresh("backface.normal_mask", scene);
  const std::vector<TriangleRange> of_second = seen(fresh, second);
  EXPECT_NE(of_first, of_second);
  EXPECT_EQ(seen(both, second), of_second);
  EXPECT_EQ(seen(both, first), of_first);
  // Objects that are turned otherwise have the rectangles of others, but not their masks.
  Scene turned = scene;
  turned.objects.push_back(turned.objects[0]);
  turned.objects[1].transform[0] = -turned.objects[1].transform[0];
  turned.objects[1].transform[2] *= 0.3;
  Scene alone = scene;
  alone.objects[0] = turned.objects[1];
  turned.finish();
  alone.finish();
  CullerRun with_both("backface.normal_mask", turned);
  CullerRun with_one("backface.normal_mask", alone);
  std::vector<TriangleRange> expected = with_one.emitted(first);
  for (TriangleRange& range : expected) range.object = 1;
  std::vector<TriangleRange> found = with_both.emitted(first);
  std::erase_if(found, [](const TriangleRange& range) { return range.object == 0; });
  EXPECT_EQ(found, expected);
}

TEST(NormalMask, TestedByTheMiddleOfClassesIsWrong) {
  // The negative control: most normals of a class whose middle faces away do so too.
  const NormalsField field = normals_field(60.0, 8, 100, 6);
  const SceneState state(field.scene);
  const Frame frame{0, field.camera, {64, 64}, state.view(), 0.0};
  const std::vector<test::Facing> facings = test::exact_facings(field.scene, frame);
  Registry registry;
  register_all_cullers(registry);
  const CullerInfo& info = registry.entry("backface.normal_mask").info;
  std::uint64_t last = 0;
  for (const int n : {18, 8, 2}) {
    const auto wrong = [&](ClassTest class_test) {
      const std::unique_ptr<ICuller> culler = make_normal_mask(info, {n, 8, false, class_test});
      culler->build(field.scene, {});
      RecordingSink sink;
      sink.start(field.scene, frame);
      culler->cull(frame, Candidates::everything(), sink);
      return test::count_facings(field.scene, frame, facings, sink.emitted()).front_left_out;
    };
    EXPECT_EQ(wrong(ClassTest::corners), 0U);
    const std::uint64_t front = wrong(ClassTest::centre);
    EXPECT_GT(front, last) << "n = " << n;  // the coarser the worse
    last = front;
  }
}

}  // namespace
}  // namespace vislab
