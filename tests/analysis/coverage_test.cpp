#include "experiments/analysis/coverage.h"

#include <gtest/gtest.h>

#include "common/scene/error.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

std::vector<Sweep> sweeps_of(const std::vector<std::string>& failures) {
  std::vector<Sweep> sweeps;
  for (const std::string& failure : failures) {
    sweeps.emplace_back();
    sweeps.back().failure = failure;
  }
  return sweeps;
}

constexpr const char* second_without =
    "entries = 3\n[[without]]\nfailure = \"F2\"\nbecause = \"no lights\"\n";

TEST(Coverage, CountsRowsOnceAndNamesTheOthersWithTheirReasons) {
  const TemporaryFolder folder;
  const auto file = folder.write("entries.toml", second_without);
  const AtlasCoverage coverage = atlas_coverage(sweeps_of({"F1", "F3", "F3", "X9"}), file);
  EXPECT_EQ(coverage.with_sweep, 2U);
  EXPECT_EQ(coverage.text(),
            "2 of 3 entries of the failure atlas have a sweep; without: F2 (no lights)");
}

TEST(Coverage, RefusesRowsWithNeitherSweepNorReasonWithBothAndBeyondTheEnd) {
  const TemporaryFolder folder;
  const auto file = folder.write("entries.toml", second_without);
  const auto message = [&](const std::vector<std::string>& failures) {
    return input_error([&] { atlas_coverage(sweeps_of(failures), file); });
  };
  EXPECT_NE(message({"F1"}).find("F3 has no sweep"), std::string::npos) << message({"F1"});
  EXPECT_NE(message({"F1", "F2", "F3"}).find("F2 has a sweep"), std::string::npos);
  EXPECT_NE(message({"F1", "F3", "F4"}).find("no row F4"), std::string::npos);
}

TEST(Coverage, NamesCullersThatStandInNoSweepAndRefusesReasonsForOthers) {
  const TemporaryFolder folder;
  const auto file = folder.write("entries.toml", std::string(second_without) +
                                                     "[[culler]]\nname = \"portal.map_pvs\"\n"
                                                     "because = \"no worlds\"\n");
  std::vector<Sweep> sweeps = sweeps_of({"F1", "F3"});
  const AtlasCoverage coverage = atlas_coverage(sweeps, file);
  ASSERT_EQ(coverage.cullers_without.size(), 1U);
  EXPECT_NE(coverage.text().find("; cullers without: portal.map_pvs (no worlds)"),
            std::string::npos)
      << coverage.text();
  sweeps[1].blocks.emplace_back();
  sweeps[1].blocks[0].cullers = {{"frustum.flat > portal.map_pvs", 0}};
  EXPECT_THROW(atlas_coverage(sweeps, file), InputError);
}

}  // namespace
}  // namespace vislab
