#include "common/scene/generators/rooms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/convex_region.h"
#include "common/scene/error.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/pierced_board.h"

namespace vislab {
namespace {

constexpr double sill_m = 0.02;
constexpr double window_width_m = 1.4, window_height_m = 1.2, window_sill_m = 0.9;
constexpr double stair_m = 1.4;
constexpr double around_m = 30.0;  // of the cell outside, from the house

/// From one end to the other along an axis.
struct Span {
  double low = 0.0, high = 0.0;

  double middle() const { return 0.5 * (low + high); }
  double length() const { return high - low; }
};

/// What divides two cells: a board in the plane z = 0 of a frame, whose z axis points to `front`.
struct Divider {
  glm::dmat3 axes{1.0};
  glm::dvec3 center{0.0};
  Span x, y;  // of the board from the center, in its frame
  CellId front = none_id, back = none_id;

  glm::dvec3 world(const glm::dvec2& p) const { return center + axes[0] * p.x + axes[1] * p.y; }
};

/// The nearest floats, so that the board's vertices and the portal's corners are the same.
glm::dvec2 as_in_mesh(const glm::dvec2& p) { return glm::dvec2(glm::vec2(p)); }

/// A rectangle turned about its middle.
BoardOpening rectangle(const glm::dvec2& middle, const glm::dvec2& half, double roll_rad) {
  const glm::dvec2 right(std::cos(roll_rad), std::sin(roll_rad));
  const glm::dvec2 up(-right.y, right.x);
  const glm::dvec2 a = right * half.x;
  const glm::dvec2 b = up * half.y;
  return {as_in_mesh(middle - a - b), as_in_mesh(middle + a - b), as_in_mesh(middle + a + b),
          as_in_mesh(middle - a + b)};
}

/// The random numbers of a wall between two rooms; as many for every wall, whatever the dials say.
struct WallDraw {
  double weight = 0.0, door = 0.0, shift = 0.0;
  std::array<double, 8> open{};
};

class Building {
 public:
  explicit Building(const RoomsParameters& parameters)
      : p_(parameters), random_(parameters.seed), things_(parameters.seed ^ 0x5DEECE66DULL) {
    const double half_wall = 0.5 * p_.wall_m;
    columns_ = spans(p_.columns, p_.width_m);
    rows_ = spans(p_.rows, p_.depth_m);
    double shift = 0.5 * (columns_.front().low + columns_.back().high);
    for (Span& span : columns_) span = {span.low - shift, span.high - shift};
    shift = rows_.front().high + half_wall;
    // Along -z.
    for (Span& span : rows_) span = {shift - span.high, shift - span.low};
    for (std::uint32_t s = 0; s < p_.storeys; ++s) {
      const double floor = s * (p_.height_m + p_.wall_m);
      storeys_.push_back({floor, floor + p_.height_m});
    }
  }

  Scene make() {
    scene_.meshes.push_back(p_.box_triangles > 12 ? dense_cube_mesh(p_.box_triangles)
                                                  : cube_mesh());
    add_rooms();
    draw_stairs();
    if (p_.windows == Windows::outside) add_outside();
    for (std::uint32_t s = 0; s < p_.storeys; ++s) add_storey(s);
    for (std::uint32_t f = 0; f <= p_.storeys; ++f) add_floors(f);
    add_furniture();
    if (p_.windows == Windows::outside) add_things_outside();
    if (p_.small_things_per_room > 0) add_small_things();
    for (Cell& cell : scene_.cells) {
      for (const ConvexRegion& region : cell.regions) cell.bounds.extend(region.bounds);
    }
    return std::move(scene_);
  }

 private:
  std::vector<Span> spans(std::uint32_t count, double size) {
    std::vector<Span> all;
    double at = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double length = size * (1.0 + p_.variation * random_.uniform(-1.0, 1.0));
      all.push_back({at, at + length});
      at += length + p_.wall_m;
    }
    return all;
  }

  CellId cell(std::uint32_t column, std::uint32_t row, std::uint32_t storey) const {
    return (storey * p_.rows + row) * p_.columns + column;
  }

  void add_rooms() {
    for (const Span& y : storeys_) {
      for (const Span& z : rows_) {
        for (const Span& x : columns_) {
          scene_.cells.push_back(
              {{}, {box_region({x.low, y.low, z.low}, {x.high, y.high, z.high})}, {}});
        }
      }
    }
  }

  void draw_stairs() {
    const std::uint32_t count = p_.columns * p_.rows;
    std::uint32_t before = count;
    for (std::uint32_t s = 0; s + 1 < p_.storeys; ++s) {
      auto room = static_cast<std::uint32_t>(random_.below(count));
      if (room == before) room = (room + 1) % count;
      stairs_.push_back(room);
      before = room;
    }
  }

  // Walls ---------------------------------------------------------------------------------------

  /// Where a wall of this storey stands; outer walls cover the floors' edges.
  Span wall_height(std::uint32_t storey, bool outer) const {
    const bool lowest = outer && storey == 0;
    const bool highest = outer && storey + 1 == p_.storeys;
    return {storeys_[storey].low - p_.wall_m * (lowest ? 1.0 : 0.5),
            storeys_[storey].high + p_.wall_m * (highest ? 1.0 : 0.5)};
  }

  /// The wall between columns i - 1 and i in a row. Outer ones have the house's corners.
  Divider wall_across_x(std::uint32_t i, std::uint32_t row, std::uint32_t storey) const {
    const bool outer = i == 0 || i == p_.columns;
    const Span z = rows_[row];
    const double near = p_.wall_m * (outer && row == 0 ? 1.0 : 0.5);
    const double far = p_.wall_m * (outer && row + 1 == p_.rows ? 1.0 : 0.5);
    const Span y = wall_height(storey, outer);
    Divider wall;
    wall.axes = {{0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}};
    const double x =
        i == 0 ? columns_[0].low - 0.5 * p_.wall_m : columns_[i - 1].high + 0.5 * p_.wall_m;
    wall.center = {x, storeys_[storey].low, z.middle()};
    wall.x = {-0.5 * z.length() - near, 0.5 * z.length() + far};
    wall.y = {y.low - wall.center.y, y.high - wall.center.y};
    wall.front = i < p_.columns ? cell(i, row, storey) : outside_;
    wall.back = i > 0 ? cell(i - 1, row, storey) : outside_;
    return wall;
  }

  /// The wall between rows i - 1 and i in a column.
  Divider wall_across_z(std::uint32_t i, std::uint32_t column, std::uint32_t storey) const {
    const bool outer = i == 0 || i == p_.rows;
    const Span x = columns_[column];
    const double left = outer && column == 0 ? 0.0 : 0.5 * p_.wall_m;
    const double right = outer && column + 1 == p_.columns ? 0.0 : 0.5 * p_.wall_m;
    const Span y = wall_height(storey, outer);
    Divider wall;
    const double z = i == 0 ? rows_[0].high + 0.5 * p_.wall_m : rows_[i - 1].low - 0.5 * p_.wall_m;
    wall.center = {x.middle(), storeys_[storey].low, z};
    wall.x = {-0.5 * x.length() - left, 0.5 * x.length() + right};
    wall.y = {y.low - wall.center.y, y.high - wall.center.y};
    wall.front = i > 0 ? cell(column, i - 1, storey) : outside_;
    wall.back = i < p_.rows ? cell(column, i, storey) : outside_;
    return wall;
  }

  void add_storey(std::uint32_t storey) {
    std::vector<Divider> inner;
    std::vector<double> lengths;
    std::vector<WallDraw> draws;
    const auto add = [&](const Divider& wall, bool outer, double length) {
      if (outer) {
        add_outer_wall(wall, length);
      } else {
        inner.push_back(wall);
        lengths.push_back(length);
        draws.push_back(drawn());
      }
    };
    for (std::uint32_t row = 0; row < p_.rows; ++row) {
      for (std::uint32_t i = 0; i <= p_.columns; ++i) {
        add(wall_across_x(i, row, storey), i == 0 || i == p_.columns, rows_[row].length());
      }
    }
    for (std::uint32_t i = 0; i <= p_.rows; ++i) {
      for (std::uint32_t column = 0; column < p_.columns; ++column) {
        add(wall_across_z(i, column, storey), i == 0 || i == p_.rows, columns_[column].length());
      }
    }
    const std::vector<std::uint8_t> joins = joining_walls(inner, draws);
    for (std::size_t i = 0; i < inner.size(); ++i) {
      const bool has_doors = joins[i] != 0 || draws[i].door < p_.doors;
      add_inner_wall(inner[i], lengths[i], draws[i], has_doors ? p_.portals : 0);
    }
  }

  WallDraw drawn() {
    WallDraw draw;
    draw.weight = random_.uniform();
    draw.door = random_.uniform();
    draw.shift = random_.uniform(-1.0, 1.0);
    for (double& open : draw.open) open = random_.uniform();
    return draw;
  }

  /// Marks the walls of a random tree that joins all rooms (Kruskal).
  static std::vector<std::uint8_t> joining_walls(const std::vector<Divider>& walls,
                                                 const std::vector<WallDraw>& draws) {
    std::vector<std::size_t> order(walls.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return draws[i].weight; });
    std::vector<std::uint8_t> joins(walls.size(), 0);
    std::vector<CellId> group;
    const auto group_of = [&](CellId cell) {
      while (cell >= group.size()) group.push_back(static_cast<CellId>(group.size()));
      while (group[cell] != cell) cell = group[cell];
      return cell;
    };
    for (const std::size_t i : order) {
      const CellId a = group_of(walls[i].front);
      const CellId b = group_of(walls[i].back);
      if (a == b) continue;
      group[std::max(a, b)] = std::min(a, b);
      joins[i] = 1;
    }
    return joins;
  }

  void add_inner_wall(const Divider& wall, double length, const WallDraw& draw,
                      std::uint32_t doors) {
    const bool crack = p_.crack_m > 0.0;
    const std::uint32_t parts = doors + (crack ? 1 : 0);
    std::vector<BoardOpening> openings;
    for (std::uint32_t i = 0; i < parts; ++i) {
      const double part = length / parts;
      const double middle = part * (i + 0.5) - 0.5 * length;
      if (i == doors) {
        openings.push_back(crack_at(middle, part));
        if (p_.crack_portal) join(wall, openings.back());
      } else {
        openings.push_back(door_at(middle, part, draw.shift));
        if (draw.open[i] < p_.open) {
          join(wall, openings.back());
        } else {
          close(wall, openings.back());
        }
      }
    }
    add_board(wall, openings);
  }

  BoardOpening crack_at(double middle, double part) const {
    if (p_.crack_m > part - 0.1) does_not_fit("a crack", p_.crack_m, part);
    const double height = std::min(p_.door_height_m, p_.height_m - 2.0 * sill_m);
    return rectangle({middle, sill_m + 0.5 * height}, {0.5 * p_.crack_m, 0.5 * height}, 0.0);
  }

  BoardOpening door_at(double middle, double part, double draw) const {
    const double roll = p_.door_roll_deg * std::numbers::pi / 180.0;
    glm::dvec2 half(0.5 * p_.door_width_m, 0.5 * p_.door_height_m);
    if (roll == 0.0) half.x = std::min(half.x, 0.5 * part - 0.1);
    const glm::dvec2 reach(half.x * std::cos(roll) + half.y * std::sin(roll),
                           half.x * std::sin(roll) + half.y * std::cos(roll));
    if (half.x <= 0.0 || 2.0 * reach.x > part - 0.1) does_not_fit("a door", 2.0 * reach.x, part);
    const double high = sill_m + std::max(half.y, reach.y);
    if (high + reach.y > p_.height_m - sill_m) {
      does_not_fit("a door's height", high + reach.y, p_.height_m);
    }
    const double most = std::min(p_.door_shift_m, 0.5 * part - 0.05 - reach.x);
    return rectangle({middle + draw * std::max(most, 0.0), high}, half, roll);
  }

  [[noreturn]] static void does_not_fit(const std::string& what, double needs, double has) {
    throw InputError(what + " of " + std::to_string(needs) + " m does not fit where there are " +
                     std::to_string(has) + " m; rooms must be larger, or doors smaller or fewer");
  }

  void add_outer_wall(const Divider& wall, double length) {
    std::vector<BoardOpening> openings;
    if (p_.windows != Windows::none) {
      const double width = std::min(window_width_m, length - 0.4);
      const double height = std::min(window_height_m, p_.height_m - window_sill_m - 0.2);
      if (width <= 0.0 || height <= 0.0) does_not_fit("a window", window_width_m, length);
      openings.push_back(
          rectangle({0.0, window_sill_m + 0.5 * height}, {0.5 * width, 0.5 * height}, 0.0));
      if (p_.windows == Windows::outside) {
        join(wall, openings.back());
      } else {
        const CellId room = wall.front == none_id ? wall.back : wall.front;
        scene_.cells[room].regions.push_back(
            prism_region(shifted(wall, openings.back(), -0.5 * p_.wall_m), p_.wall_m));
      }
    }
    add_board(wall, openings);
  }

  // Floors --------------------------------------------------------------------------------------

  void add_floors(std::uint32_t f) {
    const double top = f < p_.storeys ? storeys_[f].low : storeys_[f - 1].high + p_.wall_m;
    for (std::uint32_t row = 0; row < p_.rows; ++row) {
      for (std::uint32_t column = 0; column < p_.columns; ++column) {
        const Span x = columns_[column];
        const Span z = rows_[row];
        const auto beyond = [&](bool outer) { return outer ? 0.0 : 0.5 * p_.wall_m; };
        Divider floor;
        floor.axes = {{1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}};
        floor.center = {x.middle(), top - 0.5 * p_.wall_m, z.middle()};
        floor.x = {-0.5 * x.length() - beyond(column == 0),
                   0.5 * x.length() + beyond(column + 1 == p_.columns)};
        floor.y = {-0.5 * z.length() - beyond(row == 0),
                   0.5 * z.length() + beyond(row + 1 == p_.rows)};
        floor.front = f < p_.storeys ? cell(column, row, f) : none_id;
        floor.back = f > 0 ? cell(column, row, f - 1) : none_id;
        std::vector<BoardOpening> openings;
        if (f > 0 && f < p_.storeys && stairs_[f - 1] == row * p_.columns + column) {
          if (stair_m > std::min(x.length(), z.length()) - 0.2) {
            does_not_fit("stairs", stair_m, std::min(x.length(), z.length()));
          }
          openings.push_back(rectangle({0.0, 0.0}, {0.5 * stair_m, 0.5 * stair_m}, 0.0));
          join(floor, openings.back());
        }
        add_board(floor, openings);
      }
    }
  }

  // Openings ------------------------------------------------------------------------------------

  /// Counter-clockwise seen from the front.
  static ConvexPolygon shifted(const Divider& divider, const BoardOpening& opening,
                               double forward) {
    ConvexPolygon polygon;
    for (const glm::dvec2& p : opening) {
      polygon.push_back(divider.world(p) + divider.axes[2] * forward);
    }
    return polygon;
  }

  /// Two portals, and each cell's half of the opening.
  void join(const Divider& divider, const BoardOpening& opening) {
    const ConvexPolygon polygon = shifted(divider, opening, 0.0);
    scene_.portals.push_back(make_portal(polygon, divider.front, divider.back));
    scene_.portals.push_back(
        make_portal({polygon.rbegin(), polygon.rend()}, divider.back, divider.front));
    add_halves(divider, opening, 0.5 * p_.overlap_m);
  }

  void add_halves(const Divider& divider, const BoardOpening& opening, double beyond) {
    const double reach = 0.5 * p_.wall_m + beyond;
    scene_.cells[divider.front].regions.push_back(
        prism_region(shifted(divider, opening, -beyond), reach));
    scene_.cells[divider.back].regions.push_back(
        prism_region(shifted(divider, opening, beyond), -reach));
  }

  /// A leaf fills the door and reaches a little into the wall all round.
  void close(const Divider& wall, const BoardOpening& opening) {
    constexpr double into_wall_m = 0.01;  // not as far as to the floor's plane
    add_halves(wall, opening, 0.0);
    const glm::dvec2 right = 0.5 * (opening[1] - opening[0]);
    const glm::dvec2 up = 0.5 * (opening[3] - opening[0]);
    const glm::dvec2 middle = 0.5 * (opening[0] + opening[2]);
    const auto axis = [&](const glm::dvec2& half) {
      const glm::dvec2 longer = half * (1.0 + into_wall_m / glm::length(half));
      return wall.axes[0] * longer.x + wall.axes[1] * longer.y;
    };
    scene_.objects.push_back(
        {0,
         {axis(right), axis(up), wall.axes[2] * (0.15 * p_.wall_m), wall.world(middle)},
         none_id});
  }

  void add_board(const Divider& divider, const std::vector<BoardOpening>& openings) {
    Mesh mesh = pierced_board_mesh({divider.x.low, divider.y.low}, {divider.x.high, divider.y.high},
                                   0.5 * p_.wall_m, openings);
    mesh.name = "board " + std::to_string(scene_.meshes.size());
    scene_.objects.push_back({static_cast<MeshId>(scene_.meshes.size()),
                              {divider.axes[0], divider.axes[1], divider.axes[2], divider.center},
                              none_id});
    scene_.meshes.push_back(std::move(mesh));
  }

  // What stands about ---------------------------------------------------------------------------

  /// One above the other in the rooms' corners, out of the way from door to door.
  void add_furniture() {
    for (std::uint32_t s = 0; s < p_.storeys; ++s) {
      for (std::uint32_t row = 0; row < p_.rows; ++row) {
        for (std::uint32_t column = 0; column < p_.columns; ++column) {
          for (std::uint32_t i = 0; i < p_.boxes_per_room; ++i) {
            const glm::dvec3 half(things_.uniform(0.1, 0.35), things_.uniform(0.1, 0.25),
                                  things_.uniform(0.1, 0.35));
            const Span x = columns_[column];
            const Span z = rows_[row];
            const double aside = half.x + 0.05;
            const double along = half.z + 0.05;
            const glm::dvec3 center((i & 1U) != 0 ? x.high - aside : x.low + aside,
                                    storeys_[s].low + 0.55 * (i / 4) + half.y + 0.01,
                                    (i & 2U) != 0 ? z.high - along : z.low + along);
            scene_.objects.push_back({0, box_transform(center, half), cell(column, row, s)});
          }
        }
      }
    }
  }

  /// Between the corners, where the boxes are.
  void add_small_things() {
    constexpr double widest_corner = 0.9, aside = 0.15;
    const auto mesh = static_cast<MeshId>(scene_.meshes.size());
    scene_.meshes.push_back(cube_mesh());
    for (std::uint32_t room = 0; room < p_.storeys * p_.rows * p_.columns; ++room) {
      const std::uint32_t column = room % p_.columns;
      const std::uint32_t row = room / p_.columns % p_.rows;
      const std::uint32_t storey = room / p_.columns / p_.rows;
      const Span x = columns_[column];
      const Span z = rows_[row];
      const double corner = std::min(widest_corner, 0.5 * (x.high - x.low));
      for (std::uint32_t i = 0; i < p_.small_things_per_room; ++i) {
        const glm::dvec3 half(things_.uniform(0.01, 0.03), things_.uniform(0.01, 0.03),
                              things_.uniform(0.01, 0.03));
        const glm::dvec3 center(things_.uniform(x.low + corner, x.high - corner),
                                storeys_[storey].low + half.y + 0.01,
                                (i & 1U) != 0 ? z.high - aside : z.low + aside);
        scene_.objects.push_back({mesh, box_transform(center, half), cell(column, row, storey)});
      }
    }
  }

  glm::dvec3 house_min() const {
    return {columns_.front().low - p_.wall_m, -0.5 * p_.wall_m, rows_.back().low - p_.wall_m};
  }
  glm::dvec3 house_max() const {
    return {columns_.back().high + p_.wall_m, storeys_.back().high + p_.wall_m,
            rows_.front().high + p_.wall_m};
  }

  /// A cell of five boxes round the house and above it, over the ground.
  void add_outside() {
    outside_ = static_cast<CellId>(scene_.cells.size());
    const glm::dvec3 low = house_min();
    const glm::dvec3 high = house_max();
    const glm::dvec3 first = {low.x - around_m, low.y, low.z - around_m};
    const glm::dvec3 last = high + glm::dvec3(around_m);
    Cell cell;
    cell.regions.push_back(box_region(first, {low.x, high.y, last.z}));
    cell.regions.push_back(box_region({high.x, low.y, first.z}, {last.x, high.y, last.z}));
    cell.regions.push_back(box_region({low.x, low.y, first.z}, {high.x, high.y, low.z}));
    cell.regions.push_back(box_region({low.x, low.y, high.z}, {high.x, high.y, last.z}));
    cell.regions.push_back(box_region({first.x, high.y, first.z}, last));
    scene_.cells.push_back(std::move(cell));
  }

  void add_things_outside() {
    const glm::dvec3 low = house_min();
    const glm::dvec3 high = house_max();
    const glm::dvec3 middle = 0.5 * (low + high);
    const glm::dvec3 half = 0.5 * (high - low);
    scene_.objects.push_back({0,
                              box_transform({middle.x, low.y - 0.5, middle.z},
                                            {half.x + around_m, 0.5, half.z + around_m}),
                              outside_});
    for (std::uint32_t i = 0; i < 8 * (p_.columns + p_.rows); ++i) {
      const double angle = things_.uniform(0.0, 2.0 * std::numbers::pi);
      const double distance = things_.uniform(4.0, 25.0);
      const glm::dvec3 size(things_.uniform(0.3, 1.5), things_.uniform(0.3, 2.5),
                            things_.uniform(0.3, 1.5));
      // On a rectangle round the house.
      const glm::dvec2 onward(std::cos(angle), std::sin(angle));
      const double scale = 1.0 / std::max(std::abs(onward.x), std::abs(onward.y));
      scene_.objects.push_back(
          {0,
           box_transform({middle.x + onward.x * scale * (half.x + distance), low.y + size.y - 0.01,
                          middle.z + onward.y * scale * (half.z + distance)},
                         size),
           outside_});
    }
  }

  RoomsParameters p_;
  Random random_;  // of the house
  Random things_;  // of what stands about
  std::vector<Span> columns_, rows_, storeys_;
  std::vector<std::uint32_t> stairs_;  // by storey: the room whose ceiling is open
  CellId outside_ = none_id;
  Scene scene_;
};

}  // namespace

Scene make_rooms(const RoomsParameters& parameters) { return Building(parameters).make(); }

}  // namespace vislab
