#include "experiments/verbs/sweep_results.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "common/scene/error.h"
#include "experiments/results/files.h"
#include "experiments/results/json_reader.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;
using Notes = std::map<std::string, std::set<std::string>>;  // ids by the dial's value in digits

fs::path notes_file(const fs::path& results, const std::string& sweep) {
  return results / "stress" / sweep / "cells.json";
}

Notes read_notes(const fs::path& file) {
  if (!fs::exists(file)) return {};
  const nlohmann::json j = parse_json(read_file(file), file.string());
  return read_json(file.string(), [&] { return j.at("values").get<Notes>(); });
}

std::set<std::string> noted_ids(const fs::path& results) {
  std::set<std::string> ids;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(results / "stress", code)) {
    for (const auto& [value, noted] : read_notes(entry.path() / "cells.json")) {
      ids.insert(noted.begin(), noted.end());
    }
  }
  return ids;
}

}  // namespace

void note_sweep_cells(const Sweep& sweep, const RunOutcome& outcome, std::size_t first_block,
                      const fs::path& results) {
  const fs::path file = notes_file(results, sweep.name);
  Notes notes = read_notes(file);
  for (std::size_t i = 0; i < sweep.block_of_value.size(); ++i) {
    const auto& cells = outcome.cells_of_block.at(first_block + sweep.block_of_value[i]);
    notes[sweep.dial.texts[i]].insert(cells.begin(), cells.end());
  }
  const nlohmann::json j = {{"dial", sweep.dial.name}, {"values", notes}};
  write_file(file, j.dump(1) + "\n");
}

std::vector<SweepResult> sweep_results(const Lab& lab, const fs::path& results,
                                       const std::vector<JudgedCell>& cells) {
  const std::set<std::string> ids = noted_ids(results);
  std::vector<JudgedCell> of_sweeps;
  std::ranges::copy_if(cells, std::back_inserter(of_sweeps), [&](const JudgedCell& judged) {
    return ids.contains(judged.cell.key.id());
  });
  const std::vector<BlockSummary> blocks = summarise(of_sweeps);
  std::map<std::string, const CellSummary*> by_id;
  for (const BlockSummary& block : blocks) {
    for (const CellSummary& cell : block.cells) by_id[cell.id] = &cell;
  }
  std::vector<SweepResult> found;
  for (const Sweep& sweep : load_sweeps(lab.sweeps, results, lab.cullers)) {
    const Notes notes = read_notes(notes_file(results, sweep.name));
    found.push_back(find_break_points(
        sweep, [&](std::size_t value, const std::string& chain) -> const CellSummary* {
          const auto noted = notes.find(sweep.dial.texts[value]);
          if (noted == notes.end()) return nullptr;
          for (const std::string& id : noted->second) {
            const auto cell = by_id.find(id);
            if (cell != by_id.end() && cell->second->canonical == chain &&
                cell->second->replicate == 0) {
              return cell->second;
            }
          }
          return nullptr;
        }));
  }
  return found;
}

std::pair<std::vector<BlockSummary>, std::vector<BlockSummary>> split_sweeps(
    std::vector<BlockSummary> blocks, const fs::path& results) {
  const std::set<std::string> ids = noted_ids(results);
  const auto sweeps = std::ranges::stable_partition(blocks, [&](const BlockSummary& block) {
    return !std::ranges::all_of(block.cells,
                                [&](const CellSummary& cell) { return ids.contains(cell.id); });
  });
  std::vector<BlockSummary> of_sweeps(std::make_move_iterator(sweeps.begin()),
                                      std::make_move_iterator(sweeps.end()));
  blocks.erase(sweeps.begin(), sweeps.end());
  return {std::move(blocks), std::move(of_sweeps)};
}

}  // namespace vislab
