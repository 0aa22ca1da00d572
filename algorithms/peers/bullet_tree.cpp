#include "algorithms/peers/bullet_tree.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <algorithm>
#include <cstdint>

namespace vislab::peers {
namespace {

/// An object's id in the pointer that a leaf carries.
void* leaf_data(ObjectId object) {
  return reinterpret_cast<void*>(static_cast<std::uintptr_t>(object));
}

btDbvtVolume volume_of(const Aabb& box) {
  return btDbvtVolume::FromMM({box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z});
}

struct Collector : btDbvt::ICollide {
  std::vector<ObjectId>* kept = nullptr;

  void Process(const btDbvtNode* leaf) override {
    kept->push_back(static_cast<ObjectId>(reinterpret_cast<std::uintptr_t>(leaf->data)));
  }
  /// Leaves below a node that is inside of all planes are enumerated.
  bool AllLeaves(const btDbvtNode* /*node*/) override { return true; }
};

}  // namespace

struct BulletTree::State {
  btDbvt tree;
  std::vector<btDbvtNode*> leaves;  // by object; null if it is not in the tree
  std::vector<ObjectId> apart;      // objects without a valid box
};

BulletTree::BulletTree() : state_(std::make_unique<State>()) {}
BulletTree::~BulletTree() = default;

void BulletTree::build(std::span<const Aabb> boxes) {
  state_->tree.clear();
  state_->apart.clear();
  state_->leaves.assign(boxes.size(), nullptr);
  for (ObjectId object = 0; object < boxes.size(); ++object) insert(object, boxes[object]);
  state_->tree.optimizeTopDown();
}

void BulletTree::insert(ObjectId object, const Aabb& box) {
  if (box.valid()) {
    state_->leaves[object] = state_->tree.insert(volume_of(box), leaf_data(object));
  } else {
    state_->apart.push_back(object);
  }
}

void BulletTree::remove(ObjectId object) {
  if (state_->leaves[object] != nullptr) {
    state_->tree.remove(state_->leaves[object]);
    state_->leaves[object] = nullptr;
  } else {
    std::erase(state_->apart, object);
  }
}

void BulletTree::move(ObjectId object, const Aabb& box) {
  if (state_->leaves[object] != nullptr && box.valid()) {
    btDbvtVolume volume = volume_of(box);
    state_->tree.update(state_->leaves[object], volume);
  } else {
    remove(object);
    insert(object, box);
  }
}

void BulletTree::cull(const Frustum& frustum, std::vector<ObjectId>& kept) const {
  std::array<btVector3, 6> normals;
  std::array<btScalar, 6> offsets{};
  for (std::size_t i = 0; i < frustum.span().size(); ++i) {
    const Plane& plane = frustum.planes[i];
    const glm::vec3 normal(plane.normal);
    normals[i] = {normal.x, normal.y, normal.z};
    offsets[i] = static_cast<btScalar>(plane.d);
  }
  Collector collector;
  collector.kept = &kept;
  btDbvt::collideKDOP(state_->tree.m_root, normals.data(), offsets.data(), frustum.plane_count,
                      collector);
  kept.insert(kept.end(), state_->apart.begin(), state_->apart.end());
}

std::size_t BulletTree::bytes() const {
  const auto leaves = static_cast<std::size_t>(state_->tree.m_leaves);
  const std::size_t nodes = leaves > 0 ? 2 * leaves - 1 : 0;
  return nodes * sizeof(btDbvtNode) + state_->leaves.capacity() * sizeof(btDbvtNode*) +
         state_->apart.capacity() * sizeof(ObjectId);
}

}  // namespace vislab::peers
