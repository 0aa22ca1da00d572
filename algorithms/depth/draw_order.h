// In which order candidates are looked at: the dial that all methods of this family have.
//
// Idea: near things hide far ones, so near first is what the methods are made for; a random order
//   and far first show what that is worth. Keys are floats, smaller first; lists are sorted by
//   their bits, stable, without allocation.
// Guarantee: none of the orders changes what is right, only how much is found hidden.
// Cost: a key 20 operations; sorting O(n).
// Sources: Zachmann slide 59 (order matters).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/culler/parameters.h"
#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"
#include "common/scene/scene.h"

namespace vislab::depth_culling {

enum class DrawOrder { near_first, random, far_first };

ParameterSpec draw_order_parameter();
DrawOrder read_draw_order(const ParameterValues& values);

/// What a list or a queue is sorted by.
class DrawKeys {
 public:
  explicit DrawKeys(DrawOrder order) : order_(order) {}

  DrawOrder order() const { return order_; }

  /// Of random orders; the same seed gives the same keys.
  void reset(std::uint64_t seed) { seed_ = seed; }
  /// Once a frame or a call of cull().
  void start(const Camera& camera) { camera_ = camera; }

  /// Never NaN. Squared distance of the box from the eye, or for orthographic cameras its least
  /// depth; negated distances of the farthest point for far_first; a number that depends on the
  /// seed and `salt` alone for random. But for random, no box in this box has a smaller key, up to
  /// rounding. Boxes that are not valid come first.
  float of(const Aabb& box, std::uint32_t salt) const;

 private:
  DrawOrder order_;
  std::uint64_t seed_ = 1;
  Camera camera_;
};

/// A list of objects that is filled and sorted again in every call.
class ObjectOrder {
 public:
  struct Place {
    float key = 0.0F;
    ObjectId object = 0;
  };

  void reserve(std::size_t objects) {
    places_.reserve(objects);
    scratch_.reserve(objects);
  }
  void clear() { places_.clear(); }
  /// The key is not NaN.
  void add(float key, ObjectId object) { places_.push_back({key, object}); }
  /// By ascending key; equal keys as they were added.
  void sort();
  std::span<const Place> places() const { return places_; }
  std::size_t bytes() const { return (places_.capacity() + scratch_.capacity()) * sizeof(Place); }

 private:
  std::vector<Place> places_;
  std::vector<Place> scratch_;
};

}  // namespace vislab::depth_culling
