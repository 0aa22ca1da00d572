// What the cullers answer in the matrix smoke, against what is committed.
#include "experiments/analysis/baseline.h"

#include <algorithm>
#include <iostream>
#include <set>

#include "common/scene/error.h"
#include "experiments/matrix/matrix.h"
#include "experiments/matrix/own_paths.h"
#include "experiments/results/files.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

constexpr const char* matrix_name = "smoke";

bool is_of(const ResultCell& cell, const Block& block, const OwnPaths& paths) {
  return paths.is_on(cell, block) && cell.key.viewport == block.viewport &&
         cell.key.device == block.device && cell.key.seed == block.seed &&
         static_cast<int>(cell.frames.size()) == block.frames &&
         std::ranges::any_of(block.cullers, [&](const BlockCuller& culler) {
           return culler.chain == cell.key.chain && culler.replicate == cell.key.replicate;
         });
}

/// The stored cells of the matrix.
std::vector<ResultCell> cells_of(const Matrix& matrix, const Lab& lab,
                                 const std::filesystem::path& results) {
  std::vector<ResultCell> cells;
  const OwnPaths paths(lab.data);
  for (JudgedCell& judged : require_present_cells(results, lab.cullers)) {
    if (std::ranges::any_of(matrix.blocks,
                            [&](const Block& block) { return is_of(judged.cell, block, paths); })) {
      cells.push_back(std::move(judged.cell));
    }
  }
  return cells;
}

/// Cells of cullers that this build does not have, and of scenes that are not fetched, are no
/// change; says so.
Baseline comparable(const Baseline& committed, const Matrix& matrix,
                    const std::vector<UnfetchedScene>& unfetched) {
  std::vector<std::string> scenes;
  for (const UnfetchedScene& left_out : unfetched) scenes.push_back(left_out.scene);
  std::vector<BaselineName> left_out;
  Baseline rest = without(committed, matrix.absent, scenes, left_out);
  for (const BaselineName& name : left_out) {
    std::cerr << "vislab: not compared: " << name.culler << " (" << name.block << "): ";
    if (std::ranges::find(matrix.absent, name.culler) != matrix.absent.end()) {
      std::cerr << "not in this build\n";
      continue;
    }
    const auto why = std::ranges::find_if(unfetched, [&](const UnfetchedScene& scene) {
      return name.block.starts_with(scene.scene + ", ");
    });
    std::cerr << "package " << why->package << " has not been fetched\n";
  }
  return rest;
}

}  // namespace

int baseline(const Lab& lab, const std::filesystem::path& results, bool write, bool json) {
  const std::filesystem::path file = lab.repository / "tests" / "baseline.toml";
  Matrix matrix = load_matrix(matrix_name, lab.matrices, lab.cullers);
  const std::vector<UnfetchedScene> unfetched = leave_out_unfetched(matrix, lab.data);
  const std::vector<ResultCell> cells = cells_of(matrix, lab, results);
  const Baseline now = baseline_of(cells);
  const std::string run = std::string("vislab run ") + matrix_name;
  if (now.empty()) {
    throw InputError("no cell of " + std::string(matrix_name) + " is in " + results.string() +
                     "; measure them with: " + run + " --results " + results.string());
  }
  if (write) {
    if (!matrix.absent.empty()) {
      throw InputError("the baseline is written by a build with all cullers; this one lacks " +
                       matrix.absent.front() + " (README.md: Peers)");
    }
    if (!unfetched.empty()) {
      throw InputError("the baseline is written where all scenes are; package " +
                       unfetched.front().package + " has not been fetched: `./lab setup`");
    }
    write_file(file, to_toml(now, origin_of(cells)));
    std::cout << now.size() << " cells written to " << file.string() << '\n';
    return 0;
  }
  const Baseline committed = comparable(load_baseline(file), matrix, unfetched);
  const std::vector<BaselineChange> found = changes(committed, now);
  Table table({"block", "culler", "fact", "committed", "now"});
  std::set<BaselineName> names;
  for (const BaselineChange& change : found) {
    names.insert(change.name);
    const auto text = [](const std::string& value) {
      return value.empty() ? TableValue() : TableValue(value);
    };
    table.add({change.name.block, change.name.culler, text(change.fact), text(change.before),
               text(change.now)});
  }
  if (json || !found.empty()) table.print(std::cout, json);
  if (found.empty()) {
    std::cerr << "vislab: " << now.size() << " cells answer as in " << file.string() << '\n';
    return 0;
  }
  std::cerr << "vislab: " << names.size() << " of " << committed.size()
            << " cells answer otherwise than in " << file.string() << ". Those were measured with "
            << load_origin(file) << "; these with " << origin_of(cells)
            << ". If that is meant, write it anew: " << run << " && vislab baseline --write\n";
  return 1;
}

}  // namespace vislab
