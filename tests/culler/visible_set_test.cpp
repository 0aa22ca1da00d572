#include "common/culler/visible_set.h"

#include <gtest/gtest.h>

#include <set>

#include "common/culler/stamps.h"
#include "common/geometry/random.h"
#include "experiments/contract/offer.h"

namespace vislab {
namespace {

using TriangleRun = VisibleSet::Run;

std::set<TriangleId> members(const VisibleSet& set) {
  std::set<TriangleId> all;
  for (const TriangleRun& run : set.runs()) {
    for (TriangleId i = 0; i < run.count; ++i) all.insert(run.first + i);
  }
  return all;
}

TEST(VisibleSet, SortsAndMergesItsRuns) {
  const VisibleSet set({{7, 2}, {0, 3}, {3, 1}, {20, 0}, {9, 1}});
  EXPECT_EQ(set.runs(), (std::vector<TriangleRun>{{0, 4}, {7, 3}}));
  EXPECT_EQ(set.triangle_count(), 7U);
}

TEST(VisibleSet, IsTheSameForEveryOrderOfDrawing) {
  const VisibleSet a({{0, 3}, {5, 2}});
  const VisibleSet b({{6, 1}, {2, 1}, {5, 1}, {0, 2}});
  EXPECT_EQ(a, b);
  EXPECT_EQ(a.hash(), b.hash());
  EXPECT_EQ(a.hash().size(), 32U);
  EXPECT_NE(a.hash(), VisibleSet({{0, 3}, {5, 3}}).hash());
  EXPECT_NE(a.hash(), VisibleSet().hash());
}

TEST(VisibleSet, RefusesATriangleThatIsThereTwice) {
  EXPECT_THROW(VisibleSet({{0, 3}, {2, 1}}), std::logic_error);
  EXPECT_THROW(VisibleSet({{4, 1}, {4, 1}}), std::logic_error);
  EXPECT_THROW(VisibleSet({{0, 10}, {3, 2}}), std::logic_error);
}

TEST(VisibleSet, AnswersQuestionsAboutMembership) {
  const VisibleSet set({{2, 3}, {8, 1}});
  for (TriangleId i = 0; i < 12; ++i) {
    EXPECT_EQ(set.contains(i), (i >= 2 && i < 5) || i == 8) << i;
  }
  EXPECT_TRUE(set.intersects(0, 3));
  EXPECT_FALSE(set.intersects(0, 2));
  EXPECT_FALSE(set.intersects(5, 3));
  EXPECT_TRUE(set.intersects(5, 4));
  EXPECT_FALSE(set.intersects(9, 100));
  EXPECT_FALSE(VisibleSet().contains(0));
}

TEST(VisibleSet, DifferencesAndUnionsAreThoseOfSets) {
  Random random(17);
  for (int round = 0; round < 300; ++round) {
    std::vector<TriangleRun> runs_a, runs_b;
    for (TriangleId at = 0; at < 60;) {
      const auto count = static_cast<std::uint32_t>(1 + random.below(7));
      if (random.below(2) == 0) runs_a.push_back({at, count});
      at += count;
    }
    for (TriangleId at = 0; at < 60;) {
      const auto count = static_cast<std::uint32_t>(1 + random.below(7));
      if (random.below(2) == 0) runs_b.push_back({at, count});
      at += count;
    }
    const VisibleSet a(runs_a), b(runs_b);
    std::set<TriangleId> expected = members(a);
    for (const TriangleId id : members(b)) expected.erase(id);
    EXPECT_EQ(members(without(a, b)), expected);
    EXPECT_EQ(members(united(without(a, b), b)).size(), expected.size() + b.triangle_count());
  }
}

TEST(ObjectStamps, AreEmptyAfterClearHoweverOftenTheyAreUsed) {
  ObjectStamps stamps;
  stamps.resize(3);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(stamps.contains(1));
    EXPECT_TRUE(stamps.insert(1));
    EXPECT_FALSE(stamps.insert(1));
    EXPECT_TRUE(stamps.contains(1));
    EXPECT_FALSE(stamps.contains(2));
    stamps.clear();
  }
}

}  // namespace
}  // namespace vislab
