// The parts of normal masks: classes of normals, look-ups, and the placing of boxes in sectors.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "algorithms/backface/direction_cube.h"
#include "algorithms/backface/sector_kernel.h"
#include "common/simd/simd_target.h"
#include "tests/algorithms/facing_worlds.h"

namespace vislab {
namespace {

using namespace backface_culling;

/// `f` once with each instruction set, and once with the best for each kernel.
template <typename Function>
void with_every_target(Function&& f) {
  f("default");
  for (const std::string& target : simd_targets()) {
    const SimdTargetScope scope(target);
    f(target);
  }
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

}  // namespace
}  // namespace vislab
