#include "report/summary_section.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "experiments/analysis/break_points.h"
#include "experiments/analysis/chains.h"
#include "report/format.h"
#include "report/main_chart.h"

namespace vislab {
namespace {

constexpr std::size_t most_scenes = 9;
constexpr std::size_t most_failures = 4;

/// One for each scene: of its blocks the one with the most frames, then with the most pixels. The
/// scenes with most triangles first.
std::vector<const ChainChoice*> by_scene(const std::vector<ChainChoice>& choices) {
  const auto weight = [](const BlockSummary& block) {
    return std::pair(block.frames, block.viewport.width * block.viewport.height);
  };
  std::map<std::string, const ChainChoice*> scenes;
  for (const ChainChoice& choice : choices) {
    const ChainChoice*& known = scenes[choice.block->scene];
    if (known == nullptr || weight(*choice.block) > weight(*known->block)) known = &choice;
  }
  std::vector<const ChainChoice*> sorted;
  for (const auto& [scene, choice] : scenes) sorted.push_back(choice);
  std::ranges::stable_sort(sorted, std::greater<>(),
                           [](const ChainChoice* choice) { return choice->block->triangles; });
  return sorted;
}

Fields scene_fields(const ChainChoice& choice) {
  Fields row;
  row.values["scene"] = markdown_text(choice.block->scene);
  row.values["triangles"] = format_rounded(static_cast<double>(choice.block->triangles));
  row.values["best"] = "none without an error";
  row.values["ratio"] = "–";
  row.values["told"] = "–";
  if (choice.best == nullptr) return row;
  const Estimate& ratio = choice.best->against_none;
  row.values["best"] = markdown_code(choice.best->culler);
  row.values["ratio"] = choice.worth == ChainChoice::Worth::saves
                            ? format_percents(1.0 - ratio.high, 1.0 - ratio.low)
                        : choice.worth == ChainChoice::Worth::loses
                            ? "nothing: loses " + format_percents(ratio.low - 1.0, ratio.high - 1.0)
                            : "nothing that can be told";
  row.values["told"] = choice.undecided.empty()
                           ? "decided"
                           : "undecided among " + std::to_string(choice.undecided.size() + 1);
  return row;
}

std::vector<const BlockSummary*> all_blocks(const ReportInput& input) {
  std::vector<const BlockSummary*> blocks;
  for (const BlockSummary& block : input.blocks) blocks.push_back(&block);
  for (const BlockSummary& block : input.sweep_blocks) blocks.push_back(&block);
  return blocks;
}

struct Failure {
  const BlockSummary* block = nullptr;
  const CellSummary* cell = nullptr;
};

/// The worst of each method that is not wrong on purpose, the largest share of wrong pixels first.
std::vector<Failure> failures_of(const std::vector<const BlockSummary*>& blocks) {
  std::map<std::string, Failure> worst;
  for (const BlockSummary* block : blocks) {
    for (const CellSummary& cell : block->cells) {
      if (cell.anchor || !cell.judged || cell.pixels == 0 || cell.wrong_px() == 0) continue;
      if (cell.guarantee == Guarantee::erroneous) continue;
      // Sizes of one method stand there once.
      Failure& known = worst[cell.canonical.substr(0, cell.canonical.find('['))];
      if (known.cell == nullptr || wrong_share(cell) > wrong_share(*known.cell))
        known = {block, &cell};
    }
  }
  std::vector<Failure> failures;
  for (const auto& [method, failure] : worst) failures.push_back(failure);
  std::ranges::stable_sort(failures, std::greater<>(),
                           [](const Failure& failure) { return wrong_share(*failure.cell); });
  return failures;
}

void add_failures(const ReportInput& input, Fields& fields) {
  const std::vector<const BlockSummary*> blocks = all_blocks(input);
  std::size_t judged = 0;
  std::set<std::string> broken;
  for (const BlockSummary* block : blocks) {
    for (const CellSummary& cell : block->cells) {
      judged += cell.judged ? 1 : 0;
      if (!cell.anchor && breaks_its_promise(cell)) broken.insert(cell.culler);
    }
  }
  fields.values["judged_cells"] = format_count(judged);
  std::string names;
  for (const std::string& name : broken) {
    names += (names.empty() ? "" : ", ") + markdown_code(name);
  }
  fields.values["broken_promises"] = names;
  fields.values["broken_count"] = std::to_string(broken.size());
  fields.flag("has_broken_promises", !broken.empty());
  const std::vector<Failure> failures = failures_of(blocks);
  auto& rows = fields.lists["failures"];
  for (std::size_t i = 0; i < std::min(failures.size(), most_failures); ++i) {
    const auto& [block, cell] = failures[i];
    Fields row;
    row.values["method"] = markdown_code(cell->culler);
    row.values["share"] = format_percent(wrong_share(*cell));
    row.values["place"] = markdown_text(block->scene);
    row.values["promise"] = markdown_text(to_string(cell->guarantee));
    row.values["separator"] = i + 1 < std::min(failures.size(), most_failures) ? "; " : ".";
    rows.push_back(std::move(row));
  }
  fields.flag("has_failures", !rows.empty());
}

/// The wrong variant with the largest share of wrong pixels, and the one with most over.
void add_errata_line(const ReportInput& input, Fields& fields) {
  const std::vector<const BlockSummary*> blocks = all_blocks(input);
  std::vector<WrongVariant> variants;
  if (input.cullers != nullptr) {
    variants = find_wrong_variants(blocks, input.errata, *input.cullers);
  }
  const WrongVariant* worst = nullptr;
  std::size_t measured = 0;
  std::size_t damaging = 0;
  for (const WrongVariant& variant : variants) {
    if (variant.judged == 0) continue;
    ++measured;
    if (variant.pixels.wrong->wrong_px() == 0) continue;
    ++damaging;
    if (worst == nullptr ||
        wrong_share(*variant.pixels.wrong) > wrong_share(*worst->pixels.wrong)) {
      worst = &variant;
    }
  }
  fields.flag("has_wrong", worst != nullptr);
  fields.values["errata_known"] = std::to_string(input.errata.size());
  fields.values["wrong_known"] = std::to_string(variants.size());
  fields.values["wrong_run"] = std::to_string(measured);
  fields.values["wrong_damaging"] = std::to_string(damaging);
  if (worst == nullptr) return;
  fields.values["worst_wrong"] = markdown_code(worst->name);
  fields.values["worst_wrong_share"] = format_percent(wrong_share(*worst->pixels.wrong));
  fields.values["worst_wrong_place"] = markdown_text(worst->pixels.block->scene);
}

void add_floor(const ReportInput& input, Fields& fields) {
  std::uint64_t pixels = 0;
  std::uint64_t disputed = 0;
  std::uint64_t undisputed = 0;
  for (const BlockSummary& block : input.blocks) {
    pixels += block.floor_pixels;
    disputed += block.floor_disputed_px;
    undisputed += block.floor_undisputed_px;
  }
  fields.flag("has_error_floor", pixels > 0);
  fields.values["error_floor"] = format_of(disputed, pixels);
  fields.values["error_floor_share"] =
      format_percent(static_cast<double>(disputed) / static_cast<double>(pixels));
  fields.values["error_floor_undisputed"] = format_count(undisputed);
}

}  // namespace

void add_summary_fields(const ReportInput& input, Fields& fields) {
  fields.flag("has_main_chart", has_main_chart(input.blocks));
  fields.values["main_chart"] = main_chart_file;
  const std::vector<ChainChoice> choices = choose_chains(input.blocks);
  const std::vector<const ChainChoice*> scenes = by_scene(choices);
  auto& rows = fields.lists["best_chains"];
  for (std::size_t i = 0; i < std::min(scenes.size(), most_scenes); ++i) {
    rows.push_back(scene_fields(*scenes[i]));
  }
  fields.flag("has_best_chains", !rows.empty());
  fields.flag("has_more_scenes", scenes.size() > most_scenes);
  fields.values["more_scenes"] = std::to_string(scenes.size() - rows.size());
  add_failures(input, fields);
  add_errata_line(input, fields);
  add_floor(input, fields);
}

}  // namespace vislab
