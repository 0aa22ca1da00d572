// The cells of octrees: cubes that are halved by planes which neighbours share to the last bit.
#pragma once

#include <array>

#include "common/geometry/bounds.h"

namespace vislab {

/// The cube around a box with the same centre: from centre - longest edge / 2 (Kowalka 2016, 4.1).
/// Rounded outward, and cut off at the largest float. Holds the box; that of an empty box is empty.
Aabb root_cube(const Aabb& box);

/// The planes that halve a cell. They are among its own bounds where float cannot halve it.
glm::vec3 middle_of(const Aabb& cell);

/// Does float have a number between the cell's bounds on every axis?
bool can_halve(const Aabb& cell);

/// Octant i of a cell; bit 0, 1, 2 of i: the upper half in x, y, z. The eight are closed and
/// together are the cell.
Aabb octant(const Aabb& cell, unsigned i);

/// A float box around [min - by, max + by]; the box itself for 0.
Aabb enlarged(const Aabb& box, double by);

}  // namespace vislab
