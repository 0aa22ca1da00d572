#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/geometry/random.h"
#include "common/scene/error.h"
#include "experiments/results/files.h"
#include "experiments/results/store.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

ResultCell sample_cell() {
  ResultCell cell;
  cell.key = {"none", "scene hash", "path hash", {64, 32}, 7, "osmesa", 2, "baseline", "src", 0};
  cell.culler = "none";
  cell.scene = "a \"quoted\" scene";
  cell.path = "orbit";
  cell.status = ResultCell::Status::done;
  cell.guarantee = Guarantee::image_exact;
  cell.granularity = Granularity::triangle;
  cell.frames = {{"set0", "truth0", 12, {{"plane_tests", 3}}, 4, 5, "set2"},
                 {"set1", "truth1", 24, {}, 6, 7, ""}};
  cell.rounds = {{"session", 0, {0.1, 0.2}, {1.0, 2.0}, {3.0, 4.0}, {5.0, 1.0 / 3.0}}};
  cell.anchors["oracle"] = {{"session", 0, {2.0, 2.5}}};
  cell.context = {{"cpu", "a processor"}};
  cell.costs = CostTable::typical();
  cell.costs->triangle = {1.0 / 3.0, 0.25, 0.5};
  return cell;
}

TEST(ResultCell, ComesBackFromItsFileAsItWas) {
  const ResultCell cell = sample_cell();
  const ResultCell back = parse_cell(to_json(cell), "test").value();
  EXPECT_EQ(to_json(back), to_json(cell));
  EXPECT_EQ(back.key.id(), cell.key.id());
  EXPECT_EQ(back.rounds[0].frame_ms[1], 1.0 / 3.0);
  EXPECT_EQ(back.costs, cell.costs);
}

TEST(ResultCell, IsReadWithoutCostsIfItIsFromBeforeTheyWereMeasured) {
  nlohmann::json old = nlohmann::json::parse(to_json(sample_cell()));
  old.erase("costs");
  for (nlohmann::json& frame : old.at("frames")) {
    for (const char* name : {"draws", "pieces", "one_sided", "surface"}) frame.erase(name);
  }
  const ResultCell back = parse_cell(old.dump(), "test").value();
  EXPECT_FALSE(back.costs.has_value());
  EXPECT_EQ(back.frames[0].submitted_triangles, 12U);
  EXPECT_EQ(back.frames[0].draws, 0U);
}

TEST(ResultCell, KeepsTheDialsOfAModelledDevice) {
  ResultCell cell = sample_cell();
  EXPECT_FALSE(parse_cell(to_json(cell), "test").value().device_model.has_value());
  cell.device_model = gpu_preset("modern").model;
  cell.device_model->latency_us = 1.0 / 3.0;
  cell.device_model->serial = true;
  EXPECT_EQ(parse_cell(to_json(cell), "test").value().device_model, cell.device_model);
}

TEST(ResultCell, KeepsTheVerdictOnTheSetsOfCells) {
  ResultCell cell = sample_cell();
  EXPECT_FALSE(parse_cell(to_json(cell), "test").value().regions.has_value());
  cell.regions.emplace();
  cell.regions->rays = 700;
  cell.regions->misses = 3;
  cell.regions->unseen = 2;
  cell.regions->seen = 8;
  const ResultCell back = parse_cell(to_json(cell), "test").value();
  ASSERT_TRUE(back.regions.has_value());
  EXPECT_EQ(back.regions->rays, 700U);
  EXPECT_EQ(back.regions->misses, 3U);
  EXPECT_EQ(back.regions->over(), 0.25);
}

TEST(ResultCell, KeepsEveryCostWithItsUnitAndSpread) {
  const nlohmann::json costs = nlohmann::json::parse(to_json(sample_cell())).at("costs");
  EXPECT_EQ(costs.size(), cost_quantities().size());
  EXPECT_EQ(costs.at(0), nlohmann::json({{"quantity", "triangle"},
                                         {"value", 1.0 / 3.0},
                                         {"unit", "ns"},
                                         {"low", 0.25},
                                         {"high", 0.5}}));
}

TEST(ResultCell, IsJudgedAnewIfTheDeviceLeavesOutOtherBacks) {
  const ResultCell cell = sample_cell();
  ResultCell other = cell;
  other.frames[0].one_sided = "set3";
  EXPECT_NE(answer_hash(cell), answer_hash(other));
}

TEST(ResultCell, IsJudgedAnewIfAnotherImageWasPainted) {
  const ResultCell cell = sample_cell();
  ResultCell other = cell;
  other.frames[0].surface = "image";
  EXPECT_NE(answer_hash(cell), answer_hash(other));
  EXPECT_EQ(parse_cell(to_json(other), "test").value().frames[0].surface, "image");
}

TEST(ResultCell, EveryPartOfTheKeyChangesTheName) {
  const CellKey key = sample_cell().key;
  std::vector<CellKey> others(11, key);
  others[0].chain = "other";
  others[1].scene_hash = "other";
  others[2].path_hash = "other";
  others[3].viewport.width = 65;
  others[4].viewport.height = 33;
  others[5].seed = 8;
  others[6].device = "none";
  others[7].threads = 1;
  others[8].simd = "other";
  others[9].sources = "other";
  others[10].replicate = 1;
  for (const CellKey& other : others) EXPECT_NE(other.id(), key.id());
}

TEST(ResultCell, DamagedTextIsRefusedAndNamed) {
  const std::string text = to_json(sample_cell());
  for (std::size_t length = 0; length + 2 < text.size(); length += 37) {
    EXPECT_TRUE(says(input_error([&] { parse_cell(text.substr(0, length), "cells/x.json"); }),
                     "cells/x.json"))
        << length << " bytes of " << text.size();
  }
  std::string newer = text;
  newer.replace(newer.find("\"format\":"), 9, "\"format\":9");
  EXPECT_FALSE(parse_cell(newer, "x").has_value()) << "of another format: not there";
  std::string other = text;
  other.replace(other.find("\"chain\":\"none\""), 14, "\"chain\":\"nope\"");
  EXPECT_THROW(parse_cell(other, "x"), InputError) << "the id no longer fits the key";
}

TEST(ResultStore, ASetComesBackAsItWas) {
  const TemporaryFolder folder;
  const ResultStore store = ResultStore::create(folder.path() / "results");
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<VisibleSet::Run> runs;
    TriangleId at = 0;
    for (std::uint64_t i = random.below(200); i > 0; --i) {
      at += 1 + static_cast<std::uint32_t>(random.below(1U << (1 + random.below(20))));
      const auto count = static_cast<std::uint32_t>(1 + random.below(300));
      runs.push_back({at, count});
      at += count;
    }
    const VisibleSet set(runs);
    store.save_set(set.hash(), set);
    EXPECT_EQ(store.load_set(set.hash()), set);
  }
}

TEST(ResultStore, APaintedImageComesBackAsItWasAndADamagedOneIsRefused) {
  const TemporaryFolder folder;
  const ResultStore store = ResultStore::create(folder.path());
  std::vector<TriangleId> owners(100, none_id);
  owners[3] = 0;
  owners[99] = 70'000;
  const std::string hash = surface_hash(owners);
  store.save_surface(hash, owners);
  EXPECT_EQ(store.load_surface(hash), owners);
  owners[3] = 1;
  EXPECT_NE(surface_hash(owners), hash);
  std::filesystem::rename(folder.path() / "images" / (hash + ".ids"),
                          folder.path() / "images" / (surface_hash(owners) + ".ids"));
  EXPECT_THROW(store.load_surface(surface_hash(owners)), InputError);
}

TEST(ResultStore, ADamagedSetIsRefused) {
  const TemporaryFolder folder;
  const ResultStore store = ResultStore::create(folder.path());
  const VisibleSet set({{5, 100}, {1000, 3}});
  store.save_set(set.hash(), set);
  const fs::path file = folder.path() / "sets" / (set.hash() + ".set");
  const std::string whole = read_file(file);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    write_file(file, whole.substr(0, i));
    EXPECT_THROW(store.load_set(set.hash()), InputError) << i << " bytes";
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x20);
    write_file(file, flipped);
    // The last byte of the packed data has bits that mean nothing.
    try {
      EXPECT_EQ(store.load_set(set.hash()), set) << "byte " << i;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(set.hash()), std::string::npos);
    }
  }
}

TEST(ResultStore, VerdictsOfAnotherJudgeOrDamagedOnesDoNotCount) {
  const TemporaryFolder folder;
  const ResultStore store = ResultStore::create(folder.path());
  CellVerdicts verdicts;
  const ResultCell cell = sample_cell();
  verdicts.judge = "judge";
  verdicts.answers = answer_hash(cell);
  verdicts.frames.resize(2);
  verdicts.frames[1].false_px = 4;
  verdicts.frames[1].wrong_px = {{3, 9}};
  verdicts.images = {{1, 2}, {3, 4}};
  verdicts.floor_disputed_px = 5;
  store.save_verdicts(cell.key.id(), verdicts);
  const auto back = store.load_verdicts(cell, "judge");
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->frames, verdicts.frames);
  EXPECT_EQ(back->images, verdicts.images);
  EXPECT_EQ(back->floor_disputed_px, 5U);
  EXPECT_FALSE(store.load_verdicts(cell, "another judge").has_value());
  ResultCell other = cell;
  other.key.seed = 99;
  EXPECT_FALSE(store.load_verdicts(other, "judge").has_value());
  ResultCell changed = cell;
  changed.frames[1].set = "another set";
  EXPECT_FALSE(store.load_verdicts(changed, "judge").has_value()) << "verdicts on other answers";
  write_file(folder.path() / "verdicts" / (cell.key.id() + ".json"), "{\"judge\":\"jud");
  EXPECT_FALSE(store.load_verdicts(cell, "judge").has_value());
}

TEST(ResultStore, KnowsWhichMatricesWereRunInIt) {
  const TemporaryFolder folder;
  const ResultStore store = ResultStore::create(folder.path());
  EXPECT_TRUE(store.noted_matrices().empty());
  store.note_matrix("smoke");
  store.note_matrix("smoke");
  store.note_matrix("default");
  EXPECT_EQ(ResultStore::open(folder.path()).noted_matrices(),
            (std::set<std::string>{"default", "smoke"}));
  std::filesystem::remove_all(folder.path() / "matrices");  // as of an older version
  EXPECT_TRUE(store.noted_matrices().empty());
}

TEST(Files, AFileThatCannotBeWrittenLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_file(folder.path() / "no" / "such" / "file", "text"), InputError);
  fs::create_directories(folder.path() / "taken");
  EXPECT_THROW(write_file(folder.path() / "taken", "text"), InputError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(Files, AFileIsReplacedWhole) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "file";
  write_file(file, "first");
  write_file(file, "");
  EXPECT_EQ(read_file(file), "");
  write_file(file, "third");
  EXPECT_EQ(read_file(file), "third");
  EXPECT_THROW(read_file(folder.path()), InputError);
  EXPECT_THROW(read_file(folder.path() / "missing"), InputError);
}

}  // namespace
}  // namespace vislab
