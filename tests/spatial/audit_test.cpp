#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/spatial/spatial_structure.h"

namespace vislab {
namespace {

Aabb box(float low, float high) { return {glm::vec3(low), glm::vec3(high)}; }

/// A root with two leaves, written by hand so that it can be broken by hand.
class HandMade : public SpatialStructure {
 public:
  void build(std::span<const Aabb>) override {}
  void insert(ObjectId, const Aabb&) override {}
  void remove(ObjectId) override {}
  void move(ObjectId, const Aabb&) override {}
  void finish_changes() override {}
  std::span<const SpatialNode> nodes() const override { return nodes_; }
  std::span<const ObjectId> objects_at(NodeIndex node) const override { return objects_[node]; }
  std::span<const ObjectId> objects_below(NodeIndex node) const override {
    return node == root ? std::span<const ObjectId>(run_) : std::span<const ObjectId>();
  }
  std::span<const ObjectId> unplaced() const override { return unplaced_; }
  bool repeats_objects() const override { return repeats_; }
  std::size_t bytes() const override { return 0; }

  std::vector<SpatialNode> nodes_{{box(0, 10), 1, 2}, {box(0, 5), 0, 0}, {box(5, 10), 0, 0}};
  std::vector<std::vector<ObjectId>> objects_{{}, {0, 1}, {2}};
  std::vector<ObjectId> run_{2, 0, 1};
  std::vector<ObjectId> unplaced_{3};
  bool repeats_ = false;
};

const float nan = std::numeric_limits<float>::quiet_NaN();
const std::vector<Aabb> boxes{box(0, 1), box(4, 5), box(6, 7), box(nan, nan)};

/// What the audit says; "" if nothing is broken.
std::string verdict(const HandMade& structure, std::span<const Aabb> objects = boxes,
                    std::size_t count = 4) {
  try {
    structure.audit(objects, count);
    return "";
  } catch (const std::logic_error& error) {
    return error.what();
  }
}

TEST(Audit, PassesWhatIsWhole) { EXPECT_EQ(verdict(HandMade()), ""); }

TEST(Audit, FindsAnObjectThatIsLost) {
  HandMade structure;
  structure.unplaced_.clear();
  EXPECT_NE(verdict(structure).find("3 objects are found, but 4 are in"), std::string::npos);
}

TEST(Audit, FindsAnObjectAtTwoNodes) {
  HandMade structure;
  structure.nodes_[2].box = box(0, 10);
  structure.objects_[2].push_back(0);
  EXPECT_NE(verdict(structure).find("object 0 is at several nodes"), std::string::npos);
}

TEST(Audit, FindsAnObjectThatIsPlacedAndUnplaced) {
  HandMade structure;
  structure.unplaced_.push_back(2);
  EXPECT_NE(verdict(structure).find("object 2 is unplaced, and elsewhere too"), std::string::npos);
}

TEST(Audit, FindsANodeAndAnAncestorThatDoNotHoldABox) {
  HandMade structure;
  structure.nodes_[2].box = box(6.5F, 10);
  EXPECT_NE(verdict(structure).find("node 2 does not hold the box of object 2"), std::string::npos);
  structure.nodes_[2].box = box(5, 10);
  structure.nodes_[0].box = box(0, 6);
  EXPECT_NE(verdict(structure).find("node 0 does not hold the box of object 2"), std::string::npos);
}

TEST(Audit, FindsAnObjectWithoutAValidBoxInANode) {
  HandMade structure;
  structure.unplaced_.clear();
  structure.objects_[1].push_back(3);
  EXPECT_NE(verdict(structure).find("object 3 has no valid box"), std::string::npos);
}

TEST(Audit, FindsNodesThatAreSharedOrMissing) {
  HandMade structure;
  structure.nodes_[1].child_count = 1;
  structure.nodes_[1].first_child = 2;
  EXPECT_NE(verdict(structure).find("does not hold"), std::string::npos);
  structure.objects_[2].clear();
  EXPECT_NE(verdict(structure).find("node 2 is reached twice"), std::string::npos);
  structure = HandMade();
  structure.nodes_[0].child_count = 3;
  EXPECT_NE(verdict(structure).find("node 3 does not exist"), std::string::npos);
}

TEST(Audit, FindsARunThatIsNotWhatLiesBelow) {
  HandMade structure;
  structure.run_ = {0, 1};
  EXPECT_NE(verdict(structure).find("the run of node 0"), std::string::npos);
}

TEST(Audit, FindsAnIdThatWasNeverPutIn) {
  HandMade structure;
  structure.objects_[1].push_back(17);
  EXPECT_NE(verdict(structure).find("object 17 is in, but has no box"), std::string::npos);
}

TEST(Audit, LetsRepeatedObjectsBeHeldByTheirNodesTogether) {
  HandMade structure;
  structure.repeats_ = true;
  structure.run_.clear();
  // Three leaves that fill the root: one half, and the other half in two quarters.
  structure.nodes_ = {{box(0, 10), 1, 3},
                      {{glm::vec3(0), glm::vec3(5, 10, 10)}, 0, 0},
                      {{glm::vec3(5, 0, 0), glm::vec3(10, 5, 10)}, 0, 0},
                      {{glm::vec3(5, 5, 0), glm::vec3(10, 10, 10)}, 0, 0}};
  structure.objects_ = {{}, {0}, {0}, {0}};
  structure.unplaced_.clear();
  const std::vector<Aabb> one{box(4, 6)};
  EXPECT_EQ(verdict(structure, one, 1), "");
  structure.objects_[2].clear();
  EXPECT_NE(verdict(structure, one, 1).find("do not hold its box together"), std::string::npos);
  // A box of no thickness on the border of two leaves may be at either of them.
  const std::vector<Aabb> flat{{glm::vec3(5, 1, 1), glm::vec3(5, 2, 2)}};
  structure.objects_ = {{}, {0}, {}, {}};
  EXPECT_EQ(verdict(structure, flat, 1), "");
}

}  // namespace
}  // namespace vislab
