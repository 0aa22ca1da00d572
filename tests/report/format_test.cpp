#include "report/format.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vislab {
namespace {

TEST(Format, CountsHaveTheirThousandsSeparated) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(1000), "1,000");
  EXPECT_EQ(format_count(15728640), "15,728,640");
}

TEST(Format, NumbersHaveThreeSignificantDigits) {
  EXPECT_EQ(format_number(4.2), "4.20");
  EXPECT_EQ(format_number(0.01234), "0.0123");
  EXPECT_EQ(format_number(1234.5), "1,234");
  EXPECT_EQ(format_rounded(12345.6), "12,300");
  EXPECT_EQ(format_rounded(4.2), "4.20");
  EXPECT_EQ(format_number(0.0), "0");
  EXPECT_EQ(format_number(0.000417), "0.0004");
  EXPECT_EQ(format_number(0.00001), "<\u202F0.0001");
  EXPECT_EQ(format_number(-12.34), "-12.3");
  EXPECT_EQ(format_number(std::nan("")), "–");
}

TEST(Format, IntervalsAreNotRoundedAway) {
  EXPECT_EQ(format_estimate({1.001, 0.9961, 1.0059}), "1.001 (0.996–1.006)");
  EXPECT_EQ(format_estimate({8.0, 7.84, 8.16}), "8.00 (7.84–8.16)");
  EXPECT_EQ(format_estimate(Estimate::none()), "–");
}

TEST(Format, PercentagesKeepWhatMatters) {
  EXPECT_EQ(format_percent(0.714), "71\u202F%");
  EXPECT_EQ(format_percent(0.0312), "3.1\u202F%");
  EXPECT_EQ(format_percent(0.00042), "0.042\u202F%");
  EXPECT_EQ(format_percent(0.0), "0\u202F%");
  EXPECT_EQ(format_percents(0.7062, 0.7189), "70.6–71.9\u202F%");
}

TEST(Format, BytesHaveAUnit) {
  EXPECT_EQ(format_bytes(512), "512\u202FB");
  EXPECT_EQ(format_bytes(20'100'000), "20.1\u202FMB");
}

TEST(Format, TextOfResultsIsNoMarkup) {
  EXPECT_EQ(markdown_text("a*b [c]\n@d"), "a\\*b \\[c\\] \\@d");
  EXPECT_EQ(markdown_text("a `b*c` `d"), "a `b*c` \\`d") << "names in backticks are code";
  EXPECT_EQ(markdown_code("a`b"), "`a b`");
}

TEST(Format, NumbersThatAreNearAnotherHaveTheDigitsThatTellThemApart) {
  EXPECT_EQ(format_apart(0.99991, 1.0), "0.9999");
  EXPECT_EQ(format_apart(1.0004, 1.0), "1.0004");
  EXPECT_EQ(format_apart(1.0, 1.0004), "1.0000");
  EXPECT_EQ(format_apart(1.5, 1.0), "1.50");
  EXPECT_EQ(format_apart(1.0, 1.0), "1.00");
}

TEST(Format, NumbersWithAnExponentAreWrittenAsPowersOfTen) {
  EXPECT_EQ(format_written("1e-06"), "10⁻⁶");
  EXPECT_EQ(format_written("3e-04"), "3\u202F×\u202F10⁻⁴");
  EXPECT_EQ(format_written("1e+20"), "10²⁰");
  EXPECT_EQ(format_written("0.01"), "0.01");
  EXPECT_EQ(format_written("level"), "level");
}

}  // namespace
}  // namespace vislab
