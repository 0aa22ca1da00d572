#include "experiments/verbs/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace vislab {
namespace {

Table sample() {
  Table table({"name", "frame_ms", "false_px"});
  table.add({std::string("a, \"b\""), 1234.5678, std::uint64_t{12}});
  table.add({std::string("späť"), std::nan(""), {}});
  return table;
}

TEST(Table, TextIsAlignedAndRounded) {
  std::ostringstream out;
  sample().print_text(out);
  EXPECT_EQ(out.str(),
            "name    frame_ms  false_px\n"
            "a, \"b\"      1235        12\n"
            "späť           -         -\n");
}

TEST(Table, JsonKeepsEveryDigitAndWritesNullForWhatDoesNotApply) {
  std::ostringstream out;
  sample().print_json(out);
  EXPECT_EQ(out.str(),
            "{\"name\":\"a, \\\"b\\\"\",\"frame_ms\":1234.5678,\"false_px\":12}\n"
            "{\"name\":\"späť\",\"frame_ms\":null,\"false_px\":null}\n");
}

TEST(Table, CsvQuotesWhatNeedsIt) {
  std::ostringstream out;
  sample().print_csv(out);
  EXPECT_EQ(out.str(), "name,frame_ms,false_px\n\"a, \"\"b\"\"\",1234.5678,12\nspäť,,\n");
}

TEST(Table, NumbersKeepFourSignificantDigits) {
  EXPECT_EQ(to_text(0.123456), "0.123");
  EXPECT_EQ(to_text(1.0), "1.000");
  EXPECT_EQ(to_text(98.7654), "98.77");
  EXPECT_EQ(to_text(1e7), "1e+07");
  EXPECT_EQ(to_text(0.00001234), "1.23e-05");
  EXPECT_EQ(to_text(0.0), "0.000");
}

}  // namespace
}  // namespace vislab
