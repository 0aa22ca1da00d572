#include "common/scene/settings.h"

#include <gtest/gtest.h>

#include "tests/input_error.h"

namespace vislab {
namespace {

Settings from(const std::string& text) { return Settings::from_text(text, "here.toml"); }

TEST(Settings, GivesWhatIsThereAndFallbacksForTheRest) {
  const Settings settings =
      from("name = \"n\"\ncount = 3\nratio = 0.5\nyes = true\np = [1, 2.5, 3]\nps = [[1, 2, 3]]\n");
  EXPECT_EQ(settings.text("name"), "n");
  EXPECT_EQ(settings.whole("count", 0, 10), 3);
  EXPECT_EQ(settings.number("ratio", 0.0, 1.0), 0.5);
  EXPECT_EQ(settings.number("count", 0.0, 10.0), 3.0);
  EXPECT_TRUE(settings.flag("yes", false));
  EXPECT_EQ(settings.point("p"), glm::dvec3(1.0, 2.5, 3.0));
  EXPECT_EQ(settings.points("ps").size(), 1U);
  EXPECT_EQ(settings.whole("absent", 0, 10, 7), 7);
  EXPECT_EQ(settings.text("absent too", "x"), "x");
  EXPECT_NO_THROW(settings.done());
}

TEST(Settings, RefusesKeysThatNobodyAskedForAndNamesTheKnown) {
  const Settings settings = from("count = 1\ncuont = 2\n");
  settings.whole("count", 0, 10);
  const std::string message = input_error([&]() { settings.done(); });
  EXPECT_TRUE(says(message, "`cuont` is not a key; known: count"));
  EXPECT_TRUE(says(message, "here.toml"));
}

TEST(Settings, SaysWhatAValueMustBe) {
  const Settings settings = from("a = \"x\"\nb = 11\nc = [1, 2]\nd = nan\n");
  EXPECT_TRUE(
      says(input_error([&]() { settings.whole("a", 0, 10); }), "whole number from 0 to 10"));
  EXPECT_TRUE(says(input_error([&]() { settings.whole("b", 0, 10); }), "`b` is wrong"));
  EXPECT_TRUE(says(input_error([&]() { settings.point("c"); }), "three finite numbers"));
  EXPECT_TRUE(says(input_error([&]() { settings.number("d", 0, 1); }), "`d` is wrong"));
  EXPECT_TRUE(says(input_error([&]() { settings.text("e"); }), "`e` is missing"));
  EXPECT_TRUE(says(input_error([&]() { settings.table("b"); }), "a table"));
}

TEST(Settings, NamesTheTableOfAnError) {
  const Settings table = from("[outer]\nx = 1\n").table("outer");
  EXPECT_TRUE(says(input_error([&]() { table.done(); }), "here.toml, outer"));
}

TEST(Settings, NamesTheLineOfMalformedText) {
  EXPECT_TRUE(says(input_error([]() { from("a = 1\nb = = 2\n"); }), "here.toml, line 2"));
}

TEST(Settings, GiveEachTableOfAListAndSayWhichIsWrong) {
  const Settings settings = from("[[part]]\nsize = 1\n[[part]]\nsize = 2\nsiez = 3\n");
  const std::vector<Settings> parts = settings.tables("part");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[1].whole("size", 0, 9), 2);
  EXPECT_TRUE(says(input_error([&]() { parts[1].done(); }), "part 1: `siez` is not a key"));
  EXPECT_TRUE(says(input_error([&]() { settings.tables("absent"); }), "`absent` is missing"));
  EXPECT_TRUE(says(input_error([&]() { from("part = [1, 2]\n").tables("part"); }),
                   "`part` is wrong; it must be a list of tables"));
}

}  // namespace
}  // namespace vislab
