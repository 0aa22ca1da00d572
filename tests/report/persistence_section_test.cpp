#include "report/persistence_section.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/scene/error.h"
#include "tests/report/fabricated.h"

namespace vislab {
namespace {

PersistenceCounts counts_of(double share) {
  PersistenceCounts counts;
  counts.after.assign(PersistenceCounter::last_time + 1, {});
  counts.after_seen = counts.after;
  for (std::size_t t = 1; t <= 20; ++t) {
    counts.after[t] = {1000, static_cast<std::uint64_t>(1000.0 * share)};
  }
  counts.after[2] = {5, 0};  // too few to conclude from
  counts.turn_deg = 3.25;
  counts.step_m = 0.5;
  counts.hidden_share = 0.9;
  return counts;
}

std::vector<PersistenceRow> rows() {
  return {{"city", "city_slow", {64, 64}, 40, counts_of(0.999)},
          {"city", "city_fast", {64, 64}, 40, counts_of(0.74)},
          {"plant", "plant_fast", {64, 64}, 40, counts_of(0.9)}};
}

std::string text_of(const std::vector<PersistenceRow>& rows) {
  Fields fields;
  add_persistence_fields(rows, fields);
  const std::string file = VISLAB_SOURCE_DIR "/report/templates/persistence.md";
  std::ifstream stream(file, std::ios::binary);
  return fill_template(std::string(std::istreambuf_iterator<char>(stream), {}), fields, file);
}

TEST(PersistenceSection, SaysTheExtremesAndHowManyPathsAgreeWithTheFormula) {
  const std::string text = text_of(rows());
  EXPECT_NE(text.find("| 1 | 0.732 | 0.740 (`city_fast`) | 0.999 (`city_slow`) | 1 of 3 |"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| 2 | 0.895 | – | – | 0 of 0 |"), std::string::npos);
  EXPECT_NE(text.find("| plant | `plant_fast` | 3.25 | 0.500 |"), std::string::npos);
  EXPECT_NE(text.find("| 0.267 [t = 1]{.interval} |"), std::string::npos);  // of city_slow
}

TEST(PersistenceSection, SaysFromTheCountsWhetherTheSceneMatters) {
  std::vector<PersistenceRow> found = rows();
  found[2].counts = counts_of(0.95);  // of 1,000; the city's: 0.8695 of 2,000
  const std::string apart = text_of(found);
  EXPECT_NE(apart.find("**for objects**"), std::string::npos);
  EXPECT_NE(apart.find("**No**: at t = 1, 4, 8, 16 the intervals"), std::string::npos) << apart;
  EXPECT_NE(apart.find("At t = 1, p goes from 0.870 (city) to 0.950 (plant): in the first, hidden "
                       "things appear 2.61 times as often."),
            std::string::npos)
      << apart;
  EXPECT_NE(apart.find("with 0.740 (`city_fast`) and 0.999 (`city_slow`)"), std::string::npos);
  std::vector<PersistenceRow> alike = rows();
  for (PersistenceRow& row : alike) row.counts = counts_of(0.9);
  EXPECT_NE(text_of(alike).find("**Nothing speaks against it here**"), std::string::npos);
  EXPECT_EQ(text_of(alike).find("How the camera moves"), std::string::npos);
  alike.pop_back();
  EXPECT_NE(text_of(alike).find("**It cannot be told**"), std::string::npos);
}

TEST(PersistenceSection, StaysAwayWithoutRows) {
  EXPECT_EQ(text_of({}).find_first_not_of("\n "), std::string::npos);
}

TEST(PersistenceSection, CountsEachSceneAndPathWithAMethodThatBuildsOnThePastOnce) {
  ReportInput input;
  for (const char* scene : {"city", "city", "plain", "gone"}) {
    BlockSummary block = fabricated_block(scene);
    if (block.scene != "plain") {
      CellSummary remembers = fabricated_cell("occlusion.chcpp[batch=20]", 0.5, 0, 0.1);
      remembers.asks_device = true;
      remembers.repeatability = Repeatability::path;
      block.cells.push_back(remembers);
    }
    input.blocks.push_back(block);
  }
  EXPECT_TRUE(persistence_rows(input, {}).empty());
  input.persistence = [](const BlockSummary& block) {
    if (block.scene == "gone") throw InputError("gone");
    return counts_of(0.9);
  };
  const std::vector<PersistenceRow> found = persistence_rows(input, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].scene, "city");
  input.blocks[1].frames = 2 * input.blocks[0].frames;
  EXPECT_EQ(persistence_rows(input, {})[0].frames, input.blocks[1].frames);
  EXPECT_TRUE(persistence_rows(input, {&input.blocks[0], &input.blocks[1]}).empty());
}

TEST(PersistenceSection, TheChartHasAPanelASceneAndOneLookAPathOfAllScenes) {
  const std::string script = persistence_chart_script(rows(), "p.svg");
  const auto count = [&](const std::string& text) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = script.find(text, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  EXPECT_EQ(count("\nset title \""), 2U);
  EXPECT_EQ(count("with yerrorlines"), 3U);
  EXPECT_EQ(count("set label \"fast\""), 1U);
  EXPECT_EQ(count("set label \"slow\""), 1U);
  // 0.9 lies one decade up; times of too few cases are left out.
  EXPECT_NE(script.find(" 1 0.9"), std::string::npos);
  EXPECT_EQ(count("plot $formula"), 2U);
}

}  // namespace
}  // namespace vislab
