// The mistakes of frustum.wrong: one rule each. What each gets wrong stands in the table of
// wrong.cpp.
#pragma once

#include <memory>

#include "common/culler/culler.h"

namespace vislab::frustum_culling {

/// Decides about single objects, wrongly.
class WrongRule {
 public:
  virtual ~WrongRule() = default;
  virtual void build(const Scene& /*scene*/) {}
  virtual void reset() {}
  virtual void update(const Frame& /*frame*/, const Changes& /*changes*/) {}
  /// Once a call of cull().
  virtual void start(const Frame& frame) = 0;
  virtual bool culls(ObjectId object, const Frame& frame) = 0;
};

/// All take the parameter `amount`; most do without.
using MakeWrongRule = std::unique_ptr<WrongRule> (*)(double amount);

// Wrong frusta (wrong_planes.cpp).
std::unique_ptr<WrongRule> tangent_of_degrees(double amount);
std::unique_ptr<WrongRule> direction_not_normalised(double amount);
std::unique_ptr<WrongRule> up_as_given(double amount);
std::unique_ptr<WrongRule> symmetric_lens(double amount);
std::unique_ptr<WrongRule> one_eye(double amount);  // metres between the eyes
std::unique_ptr<WrongRule> float_planes(double amount);

// Wrong tests of a box against the right frustum (wrong_boxes.cpp).
std::unique_ptr<WrongRule> behind_all_planes(double amount);
std::unique_ptr<WrongRule> all_corners_inside(double amount);
std::unique_ptr<WrongRule> any_corner_inside(double amount);
std::unique_ptr<WrongRule> outward_vertex(double amount);
std::unique_ptr<WrongRule> nan_outside(double amount);

// Right tests on wrong books (wrong_books.cpp).
std::unique_ptr<WrongRule> half_turn(double amount);
std::unique_ptr<WrongRule> fixed_root(double amount);
std::unique_ptr<WrongRule> stale_bounds(double amount);
std::unique_ptr<WrongRule> small_parents(double amount);  // share of their size
std::unique_ptr<WrongRule> drops_on_remove(double amount);

}  // namespace vislab::frustum_culling
