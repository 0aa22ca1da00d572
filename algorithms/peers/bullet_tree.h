// The dynamic bounding-volume tree of Bullet behind a small interface, so that its headers stay in
// one file.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/geometry/frustum.h"
#include "common/scene/scene.h"

namespace vislab::peers {

/// Boxes by object id in a btDbvt. Objects whose boxes are not valid are kept apart: the tree is
/// not made for them.
class BulletTree {
 public:
  BulletTree();
  ~BulletTree();
  BulletTree(const BulletTree&) = delete;
  BulletTree& operator=(const BulletTree&) = delete;

  /// All boxes, and the tree optimised as Bullet does it top down.
  void build(std::span<const Aabb> boxes);
  void insert(ObjectId object, const Aabb& box);
  void remove(ObjectId object);
  void move(ObjectId object, const Aabb& box);

  /// Appends what no plane excludes, and all objects without a valid box.
  void cull(const Frustum& frustum, std::vector<ObjectId>& kept) const;

  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vislab::peers
