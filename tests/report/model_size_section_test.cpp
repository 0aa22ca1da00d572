#include "report/model_size_section.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace vislab {
namespace {

SizeResult fabricated_sizes() {
  SizeResult result;
  result.sweep.name = "leaf_sizes";
  result.sweep.description = "Leaves get smaller";
  result.sweep.dial = "leaf size";
  result.sweep.unit = "objects";
  result.sweep.because = "it says most";
  result.sweep.values = {"64", "8", "1"};
  SizeVerdict verdict;
  verdict.method.culler = "test.tree";
  verdict.method.parameter = "leaf_size";
  verdict.method.chains = {"a", "b", "c"};
  verdict.method.default_value = 0;
  verdict.method.off_knee = "The tree is small beside the rest";
  verdict.method.note = "The paper takes 64";
  const auto point = [](double relative, std::uint64_t bytes) {
    SizePoint made;
    made.bytes = bytes;
    made.build_ms = 0.5 * static_cast<double>(bytes);
    made.relative = relative;
    made.efficiency = {relative, relative, relative};
    made.over = 1.0 - relative;
    return made;
  };
  for (const char* scene : {"plain", "hill"}) {
    SizeCurve curve;
    curve.scene = scene;
    curve.points = {point(0.8, 100), point(0.97, 200), point(1.0, 400)};
    curve.best = 2;
    curve.knee = 1;
    curve.may_be_knee = {1};
    verdict.scenes.push_back(curve);
  }
  verdict.common = verdict.scenes.front();
  result.verdicts.push_back(verdict);
  return result;
}

std::string section_of(const std::vector<SizeResult>& sizes) {
  std::ifstream stream(VISLAB_SOURCE_DIR "/report/templates/model_size.md");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  Fields fields;
  add_model_size_fields(sizes, fields);
  return fill_template(text, fields, "model_size.md");
}

TEST(ModelSizeSection, ShowsCurveAndKneeBesideTheDefault) {
  const std::string text = section_of({fabricated_sizes()});
  EXPECT_NE(text.find("| leaf size | `test.tree` | 8 · 8 | 8 | 64 |"), std::string::npos) << text;
  EXPECT_NE(text.find("has 80"), std::string::npos) << text;
  EXPECT_NE(text.find("of the best, with the **knee at 8** (The tree is small beside the rest)"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| **8** (knee) |"), std::string::npos) << text;
  EXPECT_NE(text.find("| 64 (default) |"), std::string::npos) << text;
  EXPECT_NE(text.find("The paper takes 64"), std::string::npos) << text;
  EXPECT_NE(text.find("model-size-1-1.svg"), std::string::npos) << text;
}

TEST(ModelSizeSection, ADefaultThatMayBeTheKneeIsSaidToBeSoBesideTheOthers) {
  SizeResult result = fabricated_sizes();
  SizeVerdict& verdict = result.verdicts[0];
  verdict.method.default_value = 2;
  verdict.common.may_be_knee = {1, 2};
  const std::string text = section_of({result});
  EXPECT_NE(text.find("| leaf size | `test.tree` | 8 · 8 | 8 or 1 | 1 |"), std::string::npos)
      << text;
  EXPECT_NE(text.find("| **1** (may be the knee) (default) |"), std::string::npos) << text;
  EXPECT_NE(text.find("may be the knee |"), std::string::npos) << text;
}

TEST(ModelSizeSection, AMissingCellIsAGapWithItsReason) {
  SizeResult result = fabricated_sizes();
  result.verdicts[0].scenes[1].points[1].gap = "not run";
  result.verdicts[0].common.points[1].gap = "hill: not run";
  const std::string text = section_of({result});
  EXPECT_NE(text.find("hill\\: not run"), std::string::npos) << text;
  EXPECT_FALSE(size_charts_script({result}).empty());
}

TEST(ModelSizeSection, SaysIfValuesWereMeasuredInDifferentRuns) {
  SizeResult result = fabricated_sizes();
  EXPECT_EQ(section_of({result}).find("in the same rounds"), std::string::npos);
  result.verdicts[0].common.same_rounds = false;
  EXPECT_NE(section_of({result}).find("in the same rounds"), std::string::npos);
}

TEST(ModelSizeSection, OfAMethodThatWasNotMeasuredThereIsNoCurve) {
  SizeResult result = fabricated_sizes();
  result.verdicts.push_back(result.verdicts[0]);
  result.verdicts[1].method.culler = "test.other";
  result.verdicts[1].common.knee.reset();
  const std::string text = section_of({result});
  EXPECT_NE(text.find("`test.other`"), std::string::npos) << "it stands in the summary";
  EXPECT_EQ(text.find("of `test.other`:"), std::string::npos) << text;
}

TEST(ModelSizeSection, IsEmptyWithoutASweepThatWasMeasured) {
  SizeResult result = fabricated_sizes();
  for (SizeCurve& scene : result.verdicts[0].scenes) {
    for (SizePoint& point : scene.points) point.gap = "not run";
  }
  EXPECT_TRUE(section_of({result}).find_first_not_of('\n') == std::string::npos);
  EXPECT_TRUE(size_charts_script({result}).empty());
}

TEST(ModelSizeSection, ChartsAreAgainstTheDialWhereItChangesNoBytes) {
  SizeResult result = fabricated_sizes();
  EXPECT_NE(size_charts_script({result}).find("memory of the model (kB)"), std::string::npos);
  for (SizeCurve& scene : result.verdicts[0].scenes) {
    for (SizePoint& point : scene.points) point.bytes = 64;
  }
  const std::string script = size_charts_script({result});
  EXPECT_EQ(script.find("memory of the model (kB)"), std::string::npos);
  EXPECT_NE(script.find("leaf size (objects)"), std::string::npos);
}

}  // namespace
}  // namespace vislab
