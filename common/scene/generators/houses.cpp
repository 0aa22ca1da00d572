// Houses with a given number of triangles.
//
// Idea: the walls of a house are grids whose odd cells are windows, sunk into the wall; the roof is
// a gable, fanned to the walls' grid lines, and so is the floor. Of the sizes whose number of
// triangles is just below the wanted one, one is taken at random; triangles are then split in three
// at their centroids until the number is met. The smallest houses are boxes and tents. Guarantee:
// closed, free of self-intersection; every even number of triangles from 8 on.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "common/scene/orientation.h"

namespace vislab {
namespace {

/// Windows along the front and the side, and one above the other: none above the other where there
/// are none along.
struct HouseSize {
  std::uint32_t front = 0, side = 0, floors = 0;
};

constexpr HouseSize largest{6, 5, 8};

std::uint32_t cells(std::uint32_t windows) { return 2 * windows + 1; }

std::uint32_t wall_triangles(std::uint32_t windows, std::uint32_t floors) {
  return 2 * cells(windows) * cells(floors) + 8 * windows * floors;
}

std::uint32_t triangles_of(const HouseSize& size) {
  const std::uint32_t walls =
      2 * (wall_triangles(size.front, size.floors) + wall_triangles(size.side, size.floors));
  const std::uint32_t roof = 2 * (cells(size.front) + 1);
  const std::uint32_t gables = 2 * cells(size.side);
  const std::uint32_t floor = 2 * (cells(size.front) + cells(size.side));
  return walls + roof + gables + floor;
}

/// Triangles over vertices that are shared where they are equal.
class SharedMesh {
 public:
  void triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const std::uint32_t first = vertex(a);
    const std::uint32_t second = vertex(b);
    mesh.triangles.emplace_back(first, second, vertex(c));
  }
  void quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  Mesh mesh;

 private:
  std::uint32_t vertex(const glm::vec3& p) {
    const auto [found, is_new] = numbers_.try_emplace(
        std::array<float, 3>{p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) mesh.positions.push_back(p);
    return found->second;
  }

  std::map<std::array<float, 3>, std::uint32_t> numbers_;
};

/// Grid lines of a wall about its middle: gaps and windows in turn. lines[i] = -lines[last - i].
std::vector<float> lines_of(std::uint32_t windows, float gap_m, float window_m, float blind_m) {
  const std::uint32_t count = cells(windows);
  if (windows == 0) return {-0.5F * blind_m, 0.5F * blind_m};
  std::vector<float> lines(count + 1);
  float place = 0.5F * (count % 4 == 1 ? gap_m : window_m);  // the middle cell
  for (std::uint32_t i = (count + 1) / 2; i <= count; ++i) {
    lines[i] = place;
    lines[count - i] = -place;
    place += i % 2 == 1 ? window_m : gap_m;  // cell i is a window if it is odd
  }
  return lines;
}

/// A quarter of a house's outline: the wall that is seen from +z, turned about the vertical.
class Quarter {
 public:
  Quarter(int turns, const std::vector<float>& along, float out)
      : turns_(turns), along_(along), out_(out) {}

  /// A point by grid line, height, and depth behind the wall.
  glm::vec3 at(std::size_t line, float height, float depth = 0.0F) const {
    return turned({along_[line], height, out_ - depth});
  }
  glm::vec3 turned(const glm::vec3& p) const {
    switch (turns_) {
      case 0:
        return p;
      case 1:
        return {p.z, p.y, -p.x};
      case 2:
        return {-p.x, p.y, -p.z};
      default:
        return {-p.z, p.y, p.x};
    }
  }
  std::size_t cells() const { return along_.size() - 1; }

 private:
  int turns_;
  const std::vector<float>& along_;
  float out_;
};

void add_wall(SharedMesh& house, const Quarter& quarter, const std::vector<float>& heights) {
  constexpr float sunk_m = 0.25F;
  for (std::size_t j = 0; j + 1 < heights.size(); ++j) {
    for (std::size_t i = 0; i < quarter.cells(); ++i) {
      const std::array<glm::vec3, 4> outer{quarter.at(i, heights[j]), quarter.at(i + 1, heights[j]),
                                           quarter.at(i + 1, heights[j + 1]),
                                           quarter.at(i, heights[j + 1])};
      if (i % 2 == 0 || j % 2 == 0) {
        house.quad(outer[0], outer[1], outer[2], outer[3]);
        continue;
      }
      const std::array<glm::vec3, 4> inner{
          quarter.at(i, heights[j], sunk_m), quarter.at(i + 1, heights[j], sunk_m),
          quarter.at(i + 1, heights[j + 1], sunk_m), quarter.at(i, heights[j + 1], sunk_m)};
      house.quad(inner[0], inner[1], inner[2], inner[3]);
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        house.quad(outer[k], outer[next], inner[next], inner[k]);
      }
    }
  }
}

Mesh gabled_house(const HouseSize& size, Random& random) {
  const std::vector<float> front =
      lines_of(size.front, 1.3F, 1.2F, static_cast<float>(random.uniform(6.0, 10.0)));
  const std::vector<float> side =
      lines_of(size.side, 1.3F, 1.2F, static_cast<float>(random.uniform(6.0, 10.0)));
  std::vector<float> heights =
      lines_of(size.floors, 1.4F, 1.4F, static_cast<float>(random.uniform(2.5, 4.0)));
  const float ground = heights.front();
  for (float& height : heights) height -= ground;
  const float eaves = heights.back();
  const float ridge = eaves + static_cast<float>(random.uniform(2.0, 4.0));
  const std::array<Quarter, 4> quarters{
      Quarter(0, front, side.back()), Quarter(1, side, front.back()),
      Quarter(2, front, side.back()), Quarter(3, side, front.back())};
  SharedMesh house;
  for (const Quarter& quarter : quarters) add_wall(house, quarter, heights);
  for (std::size_t k = 0; k < 4; ++k) {
    const Quarter& quarter = quarters[k];
    const bool gable = k % 2 == 1;
    // The ridge runs along the front; a gable's tip is an end of it.
    const glm::vec3 tip = gable ? quarter.turned({0.0F, ridge, front.back()})
                                : quarter.turned({front.back(), ridge, 0.0F});
    for (std::size_t i = 0; i < quarter.cells(); ++i) {
      house.triangle(quarter.at(i, eaves), quarter.at(i + 1, eaves), tip);
      house.triangle(glm::vec3(0.0F), quarter.at(i + 1, 0.0F), quarter.at(i, 0.0F));
    }
    if (!gable) {
      house.triangle(quarter.at(0, eaves), tip, quarter.turned({front.front(), ridge, 0.0F}));
    }
  }
  return house.mesh;
}

/// A box of 12 triangles on the ground.
Mesh box_house(Random& random) {
  const glm::dvec3 half(random.uniform(2.0, 5.0), random.uniform(1.5, 3.0),
                        random.uniform(2.0, 5.0));
  Mesh mesh = box_mesh(half, 1, 1.0);
  for (glm::vec3& p : mesh.positions) p.y += static_cast<float>(half.y);
  return mesh;
}

/// A roof of 8 triangles on the ground.
Mesh tent_house(Random& random) {
  const auto x = static_cast<float>(random.uniform(2.0, 4.0));
  const auto z = static_cast<float>(random.uniform(2.0, 4.0));
  const auto y = static_cast<float>(random.uniform(2.0, 4.0));
  Mesh mesh;
  mesh.positions = {{-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z}, {-x, y, 0}, {x, y, 0}};
  mesh.triangles = {{0, 1, 5}, {0, 5, 4}, {2, 3, 4}, {2, 4, 5},
                    {1, 2, 5}, {3, 0, 4}, {0, 3, 2}, {0, 2, 1}};
  return mesh;
}

/// All sizes with at most so many triangles, and at least seven tenths of that if there are any;
/// otherwise the one with most.
std::vector<HouseSize> sizes_near(std::uint32_t triangles) {
  std::vector<HouseSize> near;
  HouseSize best;
  for (std::uint32_t front = 0; front <= largest.front; ++front) {
    for (std::uint32_t side = 0; side <= largest.side; ++side) {
      for (std::uint32_t floors = 0; floors <= largest.floors; ++floors) {
        if ((front + side == 0) != (floors == 0)) continue;
        const HouseSize size{front, side, floors};
        const std::uint32_t count = triangles_of(size);
        if (count > triangles) continue;
        if (10 * count >= 7 * triangles) near.push_back(size);
        if (count > triangles_of(best)) best = size;
      }
    }
  }
  if (near.empty()) near.push_back(best);
  return near;
}

}  // namespace

Mesh house_mesh(std::uint32_t triangles, std::uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  if (triangles < 12) {
    mesh = tent_house(random);
  } else if (triangles < triangles_of(HouseSize())) {
    mesh = box_house(random);
  } else {
    const std::vector<HouseSize> sizes = sizes_near(triangles);
    mesh = gabled_house(sizes[random.below(sizes.size())], random);
  }
  mesh.name = "house";
  // New triangles queue up behind the others, so that all are split before one is split again.
  for (std::size_t next = 0; mesh.triangles.size() + 2 <= triangles; ++next) {
    const glm::uvec3 old = mesh.triangles[next];
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(
        (mesh.positions[old.x] + mesh.positions[old.y] + mesh.positions[old.z]) / 3.0F);
    mesh.triangles[next] = {old.x, old.y, middle};
    mesh.triangles.emplace_back(old.y, old.z, middle);
    mesh.triangles.emplace_back(old.z, old.x, middle);
  }
  return mesh;
}

Scene make_houses(const HousesParameters& parameters) {
  constexpr double pitch_m = 25.0;
  constexpr double aside_m = 1.0;
  Scene scene;
  Random random(parameters.seed);
  const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(parameters.count)));
  const std::uint32_t rows = (parameters.count + columns - 1) / columns;
  const std::uint32_t least = (parameters.min_triangles + 1) / 2;
  const std::uint32_t most = parameters.max_triangles / 2;
  for (std::uint32_t i = 0; i < parameters.count; ++i) {
    const auto triangles = static_cast<std::uint32_t>(2 * (least + random.below(most - least + 1)));
    scene.meshes.push_back(house_mesh(triangles, random.bits()));
    const double quarter = 0.5 * std::numbers::pi * static_cast<double>(random.below(4));
    const double heading = quarter + random.uniform(-0.2, 0.2);
    const double x =
        (i % columns + 0.5 - 0.5 * columns) * pitch_m + random.uniform(-aside_m, aside_m);
    const double z = (i / columns + 0.5 - 0.5 * rows) * pitch_m + random.uniform(-aside_m, aside_m);
    const glm::dmat3 turn = rotation({0.0, 1.0, 0.0}, heading);
    scene.objects.push_back(
        {i, glm::dmat4x3(turn[0], turn[1], turn[2], glm::dvec3(x, 0.0, z)), none_id});
  }
  return scene;
}

}  // namespace vislab
