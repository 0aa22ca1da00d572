#include "experiments/show/stored_depth_complexity.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "common/scene/error.h"
#include "experiments/context/sources.h"
#include "experiments/results/files.h"
#include "experiments/run/path_run.h"

namespace vislab {
namespace {

using Json = nlohmann::json;

std::string text_of(const DepthComplexityTable& table) {
  Json all = Json::array();
  for (const DepthComplexityFigures& figures : table) {
    all.push_back({{"mean", figures.mean}, {"p95", figures.p95}, {"max", figures.max}});
  }
  return Json{{"judge", judge_source_hash()}, {"definitions", std::move(all)}}.dump();
}

/// Empty if there is none, or if another judge counted it.
std::optional<DepthComplexityTable> read_table(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  try {
    const Json kept = Json::parse(read_file(file));
    if (kept.at("judge") != judge_source_hash()) return {};
    DepthComplexityTable table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const Json& figures = kept.at("definitions").at(i);
      table[i] = {figures.at("mean"), figures.at("p95"), figures.at("max")};
    }
    return table;
  } catch (const Json::exception&) {
    return {};  // damaged: it is counted again
  }
}

void keep(const DepthComplexityTable& table, const std::filesystem::path& file) {
  try {
    std::error_code code;  // write_file() says what is wrong with the folder
    std::filesystem::create_directories(file.parent_path(), code);
    write_file(file, text_of(table));
  } catch (const WriteError&) {
    return;  // results that can only be read: the next report counts again
  }
}

}  // namespace

DepthComplexityTable stored_depth_complexity(const std::filesystem::path& results,
                                             StoredScenes& scenes, const BlockSummary& block,
                                             const std::filesystem::path& picture) {
  if (block.cells.empty()) throw InputError("block " + block.scene + " has no cell");
  const std::string& id = block.cells.front().id;
  const std::filesystem::path kept = results / "depths" / (id + ".json");
  if (picture.empty()) {
    if (const auto table = read_table(kept)) return *table;
  }
  const StoredScene stored = scenes.of(block, id);
  const auto third = static_cast<std::size_t>(block.frames) / 3;
  DepthComplexityTable table{};
  SceneState state(stored.scene);
  for_each_frame(stored.path, state, block.viewport,
                 [&](std::size_t index, const Frame& frame, const Changes&) {
                   if (index != third) return;
                   table = measure_depth_complexity(
                       stored.scene, frame, DepthComplexity::rays,
                       block.scene + ", depth complexity (rays), frame " + std::to_string(third),
                       picture);
                 });
  keep(table, kept);
  return table;
}

}  // namespace vislab
