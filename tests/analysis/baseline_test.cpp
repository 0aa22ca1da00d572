#include "experiments/analysis/baseline.h"

#include <gtest/gtest.h>

#include "common/scene/error.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

/// Two frames of a chain on a scene, as a run would leave them.
ResultCell cell_of(const std::string& culler) {
  ResultCell cell;
  cell.culler = culler;
  cell.key.chain = culler + "[all=parameters]";
  cell.scene = "city_tiny";
  cell.path = "city_street";
  cell.key.viewport = {128, 96};
  cell.status = ResultCell::Status::done;
  cell.frames = {{"a1", "truth", 120, {{"nodes_tested", 7}}, 3, 4, "", ""},
                 {"b2", "truth", 100, {{"nodes_tested", 5}}, 2, 2, "", ""}};
  cell.rounds = {{"session", 1, {1.0, 1.0}, {2.0, 2.0}, {3.0, 3.0}, {6.25, 6.5}}};
  return cell;
}

const BaselineName flat{"city_tiny, city_street, 128x96, osmesa", "frustum.flat"};

TEST(Baseline, SumsCountersAndHashesTheSetsOfAllFrames) {
  const std::vector<ResultCell> cells{cell_of("frustum.flat")};
  const Baseline baseline = baseline_of(cells);
  ASSERT_EQ(baseline.size(), 1U);
  ASSERT_TRUE(baseline.contains(flat)) << baseline.begin()->first.block;
  const BaselineFacts& facts = baseline.at(flat);
  EXPECT_EQ(facts.at("submitted_triangles"), "220");
  EXPECT_EQ(facts.at("nodes_tested"), "12");
  EXPECT_EQ(facts.at("draws"), "5");
  EXPECT_EQ(facts.at("pieces"), "6");
  EXPECT_EQ(facts.at("sets").size(), 16U);
  EXPECT_FALSE(facts.contains("clock_ms")) << "real times are no part of it";
  EXPECT_FALSE(facts.contains("one_sided"));
}

TEST(Baseline, FindsAChangedCounterAndAChangedSet) {
  std::vector<ResultCell> cells{cell_of("frustum.flat"), cell_of("frustum.bvh")};
  const Baseline before = baseline_of(cells);
  EXPECT_TRUE(changes(before, before).empty());
  cells[0].frames[1].counters["nodes_tested"] = 6;
  std::vector<BaselineChange> found = changes(before, baseline_of(cells));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, flat);
  EXPECT_EQ(found[0].fact, "nodes_tested");
  EXPECT_EQ(found[0].before, "12");
  EXPECT_EQ(found[0].now, "13");
  cells[0] = cell_of("frustum.flat");
  std::swap(cells[0].frames[0].set, cells[0].frames[1].set);
  found = changes(before, baseline_of(cells));
  ASSERT_EQ(found.size(), 1U) << "the same sets in other frames";
  EXPECT_EQ(found[0].fact, "sets");
}

TEST(Baseline, FindsCellsAndFactsThatAreNewOrGone) {
  std::vector<ResultCell> cells{cell_of("frustum.flat"), cell_of("frustum.bvh")};
  const Baseline before = baseline_of(cells);
  cells[1].culler = "frustum.bsp";
  cells[0].frames[0].counters["planes_tested"] = 0;
  const std::vector<BaselineChange> found = changes(before, baseline_of(cells));
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].name.culler, "frustum.bsp");
  EXPECT_EQ(found[0].before, "");
  EXPECT_EQ(found[1].name.culler, "frustum.bvh");
  EXPECT_EQ(found[1].now, "");
  EXPECT_EQ(found[2].fact, "planes_tested");
  EXPECT_EQ(found[2].before, "");
  EXPECT_EQ(found[2].now, "0");
}

TEST(Baseline, LeavesOutWhatDoesNotRepeat) {
  ResultCell timing = cell_of("occlusion.chc");
  timing.repeatability = Repeatability::timing;
  ResultCell failed = cell_of("depth.masked");
  failed.status = ResultCell::Status::failed;
  ResultCell control = cell_of("none");
  control.key.replicate = 1;
  const std::vector<ResultCell> out{timing, failed, control};
  EXPECT_TRUE(baseline_of(out).empty());
  timing.key.device = "osmesa[synchronous=true]";
  EXPECT_EQ(baseline_of({&timing, 1}).size(), 1U);
  timing.key.device = "modelled[preset=gpu]";
  const Baseline modelled = baseline_of({&timing, 1});
  ASSERT_EQ(modelled.size(), 1U);
  EXPECT_EQ(modelled.begin()->second.at("clock_ms"), "12.75") << "its clock repeats";
}

TEST(Baseline, ComesBackFromItsText) {
  std::vector<ResultCell> cells{cell_of("frustum.flat"), cell_of("backface.gl > frustum.flat"),
                                cell_of("occlusion.chc"), cell_of("surface.bsp")};
  cells[1].frames[0].one_sided = "0011";
  cells[2].key.device = "modelled[preset=gpu]";
  cells[3].frames[1].surface = "77";
  const Baseline baseline = baseline_of(cells);
  const TemporaryFolder folder;
  const Baseline again = load_baseline(folder.write("baseline.toml", to_toml(baseline, "AVX2")));
  EXPECT_EQ(again, baseline);
}

TEST(Baseline, RefusesWhatIsNoneWithFileAndLine) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    return input_error([&] { load_baseline(folder.write("baseline.toml", text)); });
  };
  EXPECT_NE(refusal("a = 1\n").find("baseline.toml:1"), std::string::npos);
  EXPECT_NE(refusal("[\"a\"]\nb = 3\n").find("baseline.toml:2"), std::string::npos);
  EXPECT_NE(refusal("[\"a\"]\nb = { c = 1.5 }\n").find("c must be"), std::string::npos);
  EXPECT_NE(refusal("[[[\n").find("baseline.toml:1"), std::string::npos);
  EXPECT_THROW(load_baseline(folder.path() / "none.toml"), InputError);
}

TEST(Baseline, WhatCannotBeComparedHereIsNamedAndIsNoChange) {
  ResultCell elsewhere = cell_of("frustum.flat");
  elsewhere.scene = "city";
  const Baseline committed = baseline_of(
      std::vector<ResultCell>{cell_of("frustum.flat"), cell_of("peer.bullet"), elsewhere});
  std::vector<BaselineName> left_out;
  const Baseline rest = without(committed, {"peer.bullet"}, {"city"}, left_out);
  ASSERT_EQ(left_out.size(), 2U);
  EXPECT_EQ(left_out[0].block, "city, city_street, 128x96, osmesa");
  EXPECT_EQ(left_out[1].culler, "peer.bullet");
  ASSERT_EQ(rest.size(), 1U) << "city_tiny is another scene than city";
  EXPECT_TRUE(changes(rest, baseline_of(std::vector<ResultCell>{cell_of("frustum.flat")})).empty());
}

TEST(Baseline, SaysWhatItWasMeasuredWithAndDoesNotCompareThat) {
  ResultCell cell = cell_of("frustum.flat");
  cell.key.simd = "AVX2";
  cell.context["embree"] = "embree 3";
  cell.context["device"] = "Mesa 22";
  const std::vector<ResultCell> cells{cell, cell};
  EXPECT_EQ(origin_of(cells), "AVX2; embree 3; Mesa 22");
  const TemporaryFolder folder;
  const std::string file = folder.write("b.toml", to_toml(baseline_of(cells), origin_of(cells)));
  EXPECT_EQ(load_origin(file), "AVX2; embree 3; Mesa 22");
  cell.key.simd = "SSE4";
  EXPECT_TRUE(changes(load_baseline(file), baseline_of(std::vector<ResultCell>{cell})).empty());
  EXPECT_EQ(load_origin(folder.write("old.toml", "# A baseline\n[\"a\"]\n")), "unknown");
}

}  // namespace
}  // namespace vislab
