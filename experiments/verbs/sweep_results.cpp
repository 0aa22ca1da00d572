#include "experiments/verbs/sweep_results.h"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "common/scene/error.h"
#include "experiments/results/files.h"
#include "experiments/results/json_reader.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

/// What is noted of one value of the dial.
struct ValueNote {
  std::string conditions;                    // as Sweep::conditions when the cells were measured
  std::map<std::string, std::string> cells;  // ids by member_name()
};

struct Notes {
  std::map<std::string, ValueNote> values;  // by the dial's value in digits
  std::set<std::string> former;             // ids that were noted once
};

/// The A/A control has the chain of another cell.
std::string member_name(const std::string& chain, int replicate) {
  return chain + (replicate > 0 ? " (again)" : "");
}

fs::path notes_file(const fs::path& results, const std::string& sweep) {
  return results / "stress" / sweep / "cells.json";
}

Notes read_notes(const fs::path& file) {
  Notes notes;
  if (!fs::exists(file)) return notes;
  const std::string text = read_file(file);
  try {
    const nlohmann::json j = parse_json(text, file.string());
    return read_json(file.string(), [&] {
      for (const auto& [value, noted] : j.at("values").items()) {
        notes.values[value] = {noted.at("conditions").get<std::string>(),
                               noted.at("cells").get<std::map<std::string, std::string>>()};
      }
      notes.former = j.at("former").get<std::set<std::string>>();
      return notes;
    });
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + "; delete the file and run the sweep again");
  }
}

void write_notes(const Notes& notes, const fs::path& file) {
  nlohmann::json values = nlohmann::json::object();
  for (const auto& [value, noted] : notes.values) {
    values[value] = {{"conditions", noted.conditions}, {"cells", noted.cells}};
  }
  write_file(file, nlohmann::json{{"values", values}, {"former", notes.former}}.dump(1) + "\n");
}

void forget(const ValueNote& noted, Notes& notes) {
  for (const auto& [member, id] : noted.cells) notes.former.insert(id);
}

/// The note of a value if it was made of what the sweep says now; else null.
const ValueNote* note_of(const Notes& notes, const Sweep& sweep, std::size_t value) {
  const auto found = notes.values.find(sweep.dial.texts[value]);
  if (found == notes.values.end()) return nullptr;
  return found->second.conditions == sweep.conditions[value] ? &found->second : nullptr;
}

/// "F9" before "F10", as load_sweeps() has them.
bool failure_comes_before(const Sweep& a, const Sweep& b) {
  const auto order = [](const Sweep& sweep) {
    std::string number;
    for (const char c : sweep.failure) {
      if (c >= '0' && c <= '9') number += c;
    }
    return std::tuple(number.size(), number, sweep.failure, sweep.name);
  };
  return order(a) < order(b);
}

/// Sweeps that cannot be read are left out: each says why in a message.
std::vector<Sweep> known_sweeps(const Lab& lab, const fs::path& results,
                                std::vector<std::string>& messages) {
  std::vector<Sweep> sweeps;
  for (const auto& [name, description] : list_sweeps(lab.sweeps)) {
    try {
      sweeps.push_back(load_sweep(name, lab.sweeps, results, lab.cullers));
    } catch (const InputError& error) {
      messages.emplace_back(error.what());
    }
  }
  std::ranges::stable_sort(sweeps, failure_comes_before);
  try {
    for (Sweep& sweep : load_kept_sweeps(lab.sweeps, results, lab.cullers)) {
      sweeps.push_back(std::move(sweep));
    }
  } catch (const InputError& error) {
    messages.emplace_back(error.what());
  }
  return sweeps;
}

/// All ids that were ever noted.
std::set<std::string> noted_ids(const fs::path& results) {
  std::set<std::string> ids;
  std::error_code code;  // no such folder: no sweep was run
  for (const auto& entry : fs::directory_iterator(results / "stress", code)) {
    Notes notes = read_notes(entry.path() / "cells.json");
    for (const auto& [value, noted] : notes.values) forget(noted, notes);
    ids.merge(notes.former);
  }
  return ids;
}

/// The ids of cells that the sweeps as they are now ask for.
std::set<std::string> present_ids(const std::vector<Sweep>& sweeps, const fs::path& results) {
  std::set<std::string> ids;
  for (const Sweep& sweep : sweeps) {
    const Notes notes = read_notes(notes_file(results, sweep.name));
    for (std::size_t i = 0; i < sweep.dial.texts.size(); ++i) {
      const ValueNote* const noted = note_of(notes, sweep, i);
      if (noted == nullptr) continue;
      for (const BlockCuller& culler : sweep.blocks[sweep.block_of_value[i]].cullers) {
        const auto id = noted->cells.find(member_name(culler.chain, culler.replicate));
        if (id != noted->cells.end()) ids.insert(id->second);
      }
    }
  }
  return ids;
}

}  // namespace

void note_sweep_cells(const Sweep& sweep, const RunOutcome& outcome, std::size_t first_block,
                      const fs::path& results) {
  const ResultStore store = ResultStore::open(results);
  std::map<std::string, std::string> member_of_id;
  for (std::size_t i = 0; i < sweep.blocks.size(); ++i) {
    for (const std::string& id : outcome.cells_of_block.at(first_block + i)) {
      const auto cell = store.load_cell(id);
      if (cell) member_of_id[id] = member_name(cell->key.chain, cell->key.replicate);
    }
  }
  const fs::path file = notes_file(results, sweep.name);
  const Notes before = read_notes(file);
  Notes notes;
  notes.former = before.former;
  for (const auto& [value, noted] : before.values) forget(noted, notes);
  for (std::size_t i = 0; i < sweep.block_of_value.size(); ++i) {
    const std::size_t block = sweep.block_of_value[i];
    ValueNote now{sweep.conditions[i], {}};
    if (const ValueNote* const noted = note_of(before, sweep, i)) {
      for (const BlockCuller& culler : sweep.blocks[block].cullers) {
        const auto kept = noted->cells.find(member_name(culler.chain, culler.replicate));
        if (kept != noted->cells.end()) now.cells.insert(*kept);
      }
    }
    for (const std::string& id : outcome.cells_of_block.at(first_block + block)) {
      const auto member = member_of_id.find(id);
      if (member != member_of_id.end()) now.cells[member->second] = id;
    }
    if (!now.cells.empty()) notes.values[sweep.dial.texts[i]] = std::move(now);
  }
  for (const auto& [value, noted] : notes.values) {
    for (const auto& [member, id] : noted.cells) notes.former.erase(id);
  }
  write_notes(notes, file);
}

std::vector<SweepResult> sweep_results(const Lab& lab, const fs::path& results,
                                       const std::vector<JudgedCell>& cells) {
  std::vector<std::string> messages;
  const std::vector<Sweep> sweeps = known_sweeps(lab, results, messages);
  for (const std::string& message : messages) {
    std::cerr << "vislab: sweep left out: " << message << '\n';
  }
  const std::set<std::string> ids = present_ids(sweeps, results);
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
  for (const Sweep& sweep : sweeps) {
    const Notes notes = read_notes(notes_file(results, sweep.name));
    found.push_back(find_break_points(
        sweep, [&](std::size_t value, const std::string& chain) -> const CellSummary* {
          const ValueNote* const noted = note_of(notes, sweep, value);
          if (noted == nullptr) return nullptr;
          const auto id = noted->cells.find(member_name(chain, 0));
          if (id == noted->cells.end()) return nullptr;
          const auto cell = by_id.find(id->second);
          return cell == by_id.end() ? nullptr : cell->second;
        }));
    if (const std::string wrong = missing_counter(found.back()); !wrong.empty()) {
      throw InputError(wrong);
    }
  }
  return found;
}

std::pair<std::vector<BlockSummary>, std::vector<BlockSummary>> split_sweeps(
    const Lab& lab, std::vector<BlockSummary> blocks, const fs::path& results) {
  const std::set<std::string> noted = noted_ids(results);
  std::vector<std::string> told_elsewhere;  // by sweep_results()
  const std::set<std::string> present =
      present_ids(known_sweeps(lab, results, told_elsewhere), results);
  const auto sweeps = std::ranges::stable_partition(blocks, [&](const BlockSummary& block) {
    return !std::ranges::all_of(block.cells,
                                [&](const CellSummary& cell) { return noted.contains(cell.id); });
  });
  std::vector<BlockSummary> of_sweeps(std::make_move_iterator(sweeps.begin()),
                                      std::make_move_iterator(sweeps.end()));
  blocks.erase(sweeps.begin(), sweeps.end());
  for (BlockSummary& block : of_sweeps) {
    std::erase_if(block.cells, [&](const CellSummary& cell) { return !present.contains(cell.id); });
  }
  std::erase_if(of_sweeps, [](const BlockSummary& block) { return block.cells.empty(); });
  return {std::move(blocks), std::move(of_sweeps)};
}

}  // namespace vislab
