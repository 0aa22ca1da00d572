// Stored results as the verbs look at them: only cells whose sources are those of this program.
#pragma once

#include <filesystem>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/summary.h"
#include "experiments/results/store.h"

namespace vislab {

/// Cells of the folder that were measured with the sources as they are now, with their verdicts.
/// Says on stderr how many are of another format, and which files are damaged; `damaged`, if it is
/// not null, gets these. Throws InputError if there is no such folder or it cannot be read.
std::vector<JudgedCell> present_cells(const std::filesystem::path& results, const Registry& cullers,
                                      std::vector<DamagedCell>* damaged = nullptr);

/// The same for verbs that need some: throws InputError that says why if there are none.
std::vector<JudgedCell> require_present_cells(const std::filesystem::path& results,
                                              const Registry& cullers,
                                              std::vector<DamagedCell>* damaged = nullptr);

}  // namespace vislab
