#include "common/culler/parameters.h"

#include <gtest/gtest.h>

#include "tests/input_error.h"

namespace vislab {
namespace {

using Stage = ParameterSpec::Stage;

std::vector<ParameterSpec> specs() {
  return {ParameterSpec::boolean("exact", true, Stage::build, "Asks exactly."),
          ParameterSpec::integer("batch", 50, 1, 1000, "queries", Stage::query, "Asks at once."),
          ParameterSpec::real("sigma", 1.4, 0.5, 8.0, "", Stage::query, "Splits boxes."),
          ParameterSpec::choice("test", "box", {"box", "sphere"}, Stage::build, "Tests volumes.")};
}

ParameterValues values(const std::map<std::string, std::string>& given) {
  return ParameterValues("family.variant", specs(), given);
}

std::string refusal(const std::map<std::string, std::string>& given) {
  return input_error([&] { values(given); });
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Parameters, HaveTheirDefaultsUnlessTheyAreGiven) {
  const ParameterValues defaults = values({});
  EXPECT_TRUE(defaults.boolean("exact"));
  EXPECT_EQ(defaults.integer("batch"), 50);
  EXPECT_EQ(defaults.real("sigma"), 1.4);
  EXPECT_EQ(defaults.choice("test"), "box");
  const ParameterValues given =
      values({{"exact", "off"}, {"batch", "1000"}, {"sigma", "0.5"}, {"test", "sphere"}});
  EXPECT_FALSE(given.boolean("exact"));
  EXPECT_EQ(given.integer("batch"), 1000);
  EXPECT_EQ(given.real("sigma"), 0.5);
  EXPECT_EQ(given.choice("test"), "sphere");
}

TEST(Parameters, AreKeptInOneCanonicalForm) {
  EXPECT_EQ(values({{"sigma", "2.50"}}).all(), values({{"sigma", "2.5e0"}}).all());
  EXPECT_EQ(values({{"sigma", "2"}}).choice("sigma"), "2");
  EXPECT_EQ(values({{"batch", "007"}}).choice("batch"), "7");
  EXPECT_EQ(values({{"exact", "1"}}).choice("exact"), "true");
}

TEST(Parameters, OutOfRangeAreRefusedWithWhatIsAllowed) {
  for (const char* wrong : {"0", "1001", "5.5", "five", "", "5 ", "99999999999999999999"}) {
    const std::string message = refusal({{"batch", wrong}});
    EXPECT_TRUE(has(message, "family.variant")) << wrong << ": " << message;
    EXPECT_TRUE(has(message, "batch")) << message;
    EXPECT_TRUE(has(message, "1 to 1000")) << message;
    EXPECT_TRUE(has(message, "queries")) << message;
  }
  for (const char* wrong : {"0.49", "8.01", "nan", "inf", "-inf", "1,4", "0x1p0"}) {
    EXPECT_TRUE(has(refusal({{"sigma", wrong}}), "0.5 to 8")) << wrong;
  }
  EXPECT_TRUE(has(refusal({{"test", "obb"}}), "box, sphere"));
  EXPECT_TRUE(has(refusal({{"exact", "maybe"}}), "true or false"));
}

TEST(Parameters, UnknownAreRefusedWithTheKnownNames) {
  const std::string message = refusal({{"bacth", "5"}});
  EXPECT_TRUE(has(message, "bacth")) << message;
  for (const ParameterSpec& spec : specs()) EXPECT_TRUE(has(message, spec.name)) << message;
}

TEST(Parameters, ThatWereNeverDeclaredAreAMistakeOfTheProgram) {
  EXPECT_THROW(values({}).integer("depth"), std::logic_error);
}

}  // namespace
}  // namespace vislab
