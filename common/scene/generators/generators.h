// Scenes made from a few numbers and a seed; the same everywhere for the same parameters. All are y
// up and in metres, and none is finished yet (Scene::finish).
#pragma once

#include <cstdint>

#include "common/scene/scene.h"

namespace vislab {

/// A closed cube from -1 to 1 on each axis, 12 triangles.
Mesh cube_mesh();

/// The same cube, its sides cut into squares: at least so many triangles, 12 n^2. Closed.
Mesh dense_cube_mesh(std::uint32_t min_triangles);

/// A building in the cube from -1 to 1: a flat roof, and n by n windows in each of four walls, sunk
/// into it by 0.04. Closed, free of self-intersection; at least so many triangles, 64 n^2 + 48 n +
/// 16.
Mesh facade_mesh(std::uint32_t min_triangles);

/// Places cube_mesh() as the axis-aligned box around `center`.
glm::dmat4x3 box_transform(const glm::dvec3& center, const glm::dvec3& half_size);

struct BoxFieldParameters {
  std::uint32_t count = 1000;
  double extent_m = 500.0;  // centres lie in the cube from -extent to extent
  double min_half_size_m = 0.2, max_half_size_m = 2.0;
  double clear_radius_m = 5.0;  // no box comes as near to the origin, where cameras stand
  bool rotated = false;         // each box in a random orientation of its own
  // The boxes' shape before it is scaled: half sizes elongation, thickness and 1 / elongation.
  double elongation = 1.0;         // 2 gives 2 : 1 : 0.5
  double thickness = 1.0;          // 0 gives a rectangle that faces up
  std::uint32_t subdivisions = 1;  // of each edge
  double density_ratio =
      1.0;                // vertices per area at the corner (-, -, -) to those at the opposite one
  double mirrored = 0.0;  // share of the instances that are mirrored: a negative determinant
  double shear = 0.0;     // each instance's x goes along with its y by this factor
  std::uint64_t seed = 1;
};

/// Boxes, uniform in a cube, that share one mesh; axis-aligned unless `rotated` or sheared. Needs
/// half diagonals and clear_radius well below the extent. Where and which they are does not depend
/// on how many are mirrored, and a larger share mirrors more of the same.
Scene make_box_field(const BoxFieldParameters& parameters);

/// The same of a mesh: `half sizes` are then half of the longest side of its box, one number for
/// each instance, and the boxes' shape and tessellation do not count. `mesh` must have triangles.
Scene make_mesh_field(Mesh mesh, const BoxFieldParameters& parameters);

/// The surface of a box about the origin, each edge cut into `subdivisions`. The cuts lie so that
/// the number of vertices per area of a face's corner nearest to (-, -, -) is `density_ratio` times
/// that of the opposite one, about. Closed; a box of no height is only its upper face.
Mesh box_mesh(const glm::dvec3& half_size, std::uint32_t subdivisions, double density_ratio);

struct HaresParameters {
  std::uint32_t count = 14;
  double size_m = 1.0;     // the longest side of a hare's box
  double spacing_m = 2.0;  // between neighbours on an axis, and from the origin to the first
};

/// `count` instances of a mesh outward along the six half-axes, dealt out in the order +x, -x, +y,
/// -y, +z, -z; the series of Kowalka's thesis (HAW Hamburg, 2016). `hare` must have triangles.
Scene make_hares(Mesh hare, const HaresParameters& parameters);

struct CityParameters {
  std::uint32_t blocks_x = 50, blocks_z = 40;  // one building a block
  double roof_share = 0.0;                     // buildings with a gable roof instead of a flat one
  std::uint32_t street_boxes = 0;              // small boxes between the buildings
  std::uint32_t indoor_boxes = 0;              // as large, inside the buildings: nobody sees them
  std::uint32_t bridges = 0;                   // over the middle streets that run along x
  double bridge_clearance = 0.5;               // below a deck, in building heights of 20 m
  // Of a building with a flat roof: above 12 its walls have windows (facade_mesh).
  std::uint32_t min_triangles = 12;
  std::uint64_t seed = 1;
};

/// Random houses on a grid of streets with a pitch of 25 m, centred at the origin on the plane y =
/// 0: half widths 6 to 10 m, heights 8 to 30 m, one in ten 40 to 80 m. Street boxes have half sizes
/// of 0.3 to 2 m; they rest on the ground, or, one in ten, hover at 5 to 60 m. They lie along the
/// streets and keep 1 m from the middle of every street, so that a camera can walk there. Buildings
/// come first, then street boxes, indoor boxes and bridges, and none of these changes those before
/// it. A bridge is one deck, 4.8 m wide and 1.5 m thick, along a whole street; bridges are two
/// streets apart.
Scene make_city(const CityParameters& parameters);

struct RoomRingParameters {
  std::uint32_t rooms = 12;
  std::uint32_t boxes_per_room = 4;
  std::uint64_t seed = 1;
};

/// Rooms in a ring, each a cell, joined by door openings, each two portals (one for each
/// direction). The walls of a room are one object and face inward; boxes stand in the rooms'
/// corners. Rooms are 5 m high and 10 m deep, doors 2.5 m by 2 m in the middle of the walls; the
/// ring grows with the number of rooms (at least 3), so that a room is about 10 m long in its
/// middle.
Scene make_room_ring(const RoomRingParameters& parameters);

struct AsteroidBeltParameters {
  std::uint32_t count = 600;
  std::uint32_t detail = 64;                   // a power of two from 4 on
  std::uint32_t shapes = 12;                   // different meshes, dealt out at random
  double radius_m = 1000.0;                    // of the belt's middle circle
  double width_m = 300.0;                      // from its inner to its outer edge
  double thickness_m = 60.0;                   // of its middle circle's heights
  double height_m = 0.0;                       // of its mid-plane above the world's origin
  double min_size_m = 4.0, max_size_m = 20.0;  // mean radius of an asteroid
  double relief = 0.3;  // how far its surface goes up and down, in its mean radius, below 1
  double beacon_height_m = 0.0;  // 0: no beacons
  std::uint64_t seed = 1;
};

/// Asteroids that lie at random in a flat ring round the vertical through the world's origin, as in
/// Gschwantner and Hebart's
/// engine report (2007): spheres of (detail + 1)^2 vertices, displaced by a
/// fractal; orientations are random. Needs width below twice the radius. Two beacons, cubes of 1 m
/// half size, stand on the ring's axis at +/- `beacon_height_m` and make the scene's box symmetric
/// about y = 0, so that `height_m` says where in the box, and hence in an octree, the belt lies.
Scene make_asteroid_belt(const AsteroidBeltParameters& parameters);

/// An asteroid with a mean radius of about 1: closed, (detail + 1)^2 vertices, 2 detail (detail -
/// 1) triangles. The two ends of each circle of latitude are vertices of their own at equal
/// positions, and so are those of a pole.
Mesh asteroid_mesh(std::uint32_t detail, double relief, std::uint64_t seed);

struct HousesParameters {
  std::uint32_t count = 100;
  std::uint32_t min_triangles = 8, max_triangles = 2000;  // of a house; even numbers are drawn
  std::uint64_t seed = 1;
};

/// Houses, each a mesh of its own, on a square of streets with a pitch of 25 m about the origin, on
/// the plane y = 0, turned and shifted a little at random. Needs an even number from 8 on between
/// min_triangles and max_triangles.
Scene make_houses(const HousesParameters& parameters);

/// A house on the plane y = 0, at most 17 m by 14 m: a tent or a box below 18 triangles, above that
/// with a gable roof, and windows above about 80. Closed; `triangles` must be even and at least 8.
Mesh house_mesh(std::uint32_t triangles, std::uint64_t seed);

enum class Bumps { none, low, high };

struct BumpySphereParameters {
  std::uint32_t subdivisions = 96;  // n, of each edge of the cube
  Bumps bumps = Bumps::none;
  double hole = 0.0;            // share of the surface that is left out, below 1
  glm::dvec3 mesh_offset{0.0};  // of the sphere's middle from the mesh's own origin, metres

  friend bool operator==(const BumpySphereParameters&, const BumpySphereParameters&) = default;
};

/// A sphere of radius 1 about `mesh_offset`, tessellated as a cube whose sides are grids of n x n
/// squares, taken to the sphere by normalising: 12 n^2 triangles, row by row; 1,002,252 for n =
/// 289. By the unit vector (x, y, z) of a vertex its radius is
///   low   1 + 0.05 (sin 9x sin(8y + 1) sin(7z + 2) + 0.4 sin(23x + 3) sin 21y)
///   high  1 + 0.02 sin 60x sin(60y + 1) sin(60z + 2)
/// A hole leaves out the triangles whose middles lie in a cap about +x, of that share of all
/// directions; the mesh is then open. Without a hole it is closed. O(n^2).
Mesh bumpy_sphere_mesh(const BumpySphereParameters& parameters);

/// The same as a scene. Its object's transform takes `mesh_offset` back: the sphere is about the
/// world's origin whatever the offset, which only costs the vertices precision.
Scene make_bumpy_sphere(const BumpySphereParameters& parameters);

struct GrazingSlabsParameters {
  std::uint32_t count = 200;
  double tilt_rad = 1e-3;     // between a large face and the line from its middle to the origin
  double distance_m = 10.0;   // of those middles from the origin
  double half_width_m = 1.0;  // of the square faces
  double thickness_m = 0.05;
  std::uint32_t subdivisions = 4;  // of each edge
  std::uint64_t seed = 1;
};

/// Thin boxes all around the origin that are seen edge-on from there but for a tilt: the planes of
/// their upper faces pass it at distance_m * sin(tilt_rad), but for rounding in double. Every
/// second one turns that face to the origin, the others turn it away. Directions and orientations
/// are random and do not depend on the tilt. Boxes may overlap.
Scene make_grazing_slabs(const GrazingSlabsParameters& parameters);

/// A flattened sphere of radius 1 with ribs from pole to pole, like a pumpkin: 2 * meridians *
/// parallels triangles, meridians * parallels + 2 vertices; closed. Needs 3 meridians and 1
/// parallel.
Mesh ribbed_sphere_mesh(std::uint32_t meridians, std::uint32_t parallels, std::uint32_t ribs);

}  // namespace vislab
