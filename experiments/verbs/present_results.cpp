#include "experiments/verbs/present_results.h"

#include <tbb/parallel_for.h>

#include <iostream>

#include "common/scene/error.h"
#include "experiments/context/sources.h"
#include "experiments/results/store.h"

namespace vislab {

std::vector<JudgedCell> present_cells(const std::filesystem::path& results, const Registry& cullers,
                                      std::vector<DamagedCell>* damaged) {
  const ResultStore store = ResultStore::open(results);
  std::vector<JudgedCell> present;
  LeftOut left_out;
  std::vector<ResultCell> stored = store.load_all(&left_out);
  for (const DamagedCell& cell : left_out.damaged) {
    std::cerr << "vislab: left out: " << cell.what() << '\n';
  }
  if (damaged != nullptr) *damaged = left_out.damaged;
  for (const auto& [format, count] : left_out.other_formats) {
    std::cerr << "vislab: " << count << (count == 1 ? " cell" : " cells") << " in "
              << (results / "cells").string() << (count == 1 ? " is" : " are") << " of format "
              << format << ", of " << (format < cell_format_version ? "an older" : "a newer")
              << " version of vislab: left alone; run the matrices again\n";
  }
  for (ResultCell& cell : stored) {
    try {
      // Parameters may have been added since: the canonical name is another then.
      if (cullers.canonical(cell.key.chain) != cell.key.chain) continue;
    } catch (const InputError&) {
      continue;  // a culler that no longer exists
    }
    if (chain_source_hash(cell.key.chain) != cell.key.sources) continue;
    present.push_back({std::move(cell), std::nullopt});
  }
  tbb::parallel_for(std::size_t{0}, present.size(), [&](std::size_t i) {
    present[i].verdicts = store.load_verdicts(present[i].cell, judge_source_hash());
  });
  return present;
}

std::vector<JudgedCell> require_present_cells(const std::filesystem::path& results,
                                              const Registry& cullers,
                                              std::vector<DamagedCell>* damaged) {
  std::vector<JudgedCell> present = present_cells(results, cullers, damaged);
  if (present.empty()) {
    throw InputError("no results in " + results.string() +
                     " were measured with the sources of this program; run the matrices again");
  }
  return present;
}

}  // namespace vislab
