#include <map>

#include "common/scene/error.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {
namespace {

/// What a wrong method does at its worst.
struct Damage {
  const BlockSummary* false_block = nullptr;
  const CellSummary* false_cell = nullptr;  // with the largest share of false pixels
  const BlockSummary* over_block = nullptr;
  const CellSummary* over_cell = nullptr;  // with the most over beside a right method
  double right_over = 0.0;                 // the least over of a right method there
};

double false_share(const CellSummary& cell) {
  return cell.pixels == 0 ? 0.0
                          : static_cast<double>(cell.false_px) / static_cast<double>(cell.pixels);
}

std::string family_of(const std::string& chain) {
  return chain.substr(0, chain.find_first_of(".["));
}

/// The least over of a method of the same family that promises to be right, and is so on the block;
/// none: null.
const CellSummary* right_one(const BlockSummary& block, const CellSummary& wrong) {
  const CellSummary* best = nullptr;
  for (const CellSummary& cell : block.cells) {
    if (cell.anchor || !is_free_of_errors(cell)) continue;
    if (cell.guarantee > Guarantee::image_exact) continue;
    if (family_of(cell.canonical) != family_of(wrong.canonical)) continue;
    if (cell.canonical.find('>') != std::string::npos) continue;
    if (best == nullptr || cell.over < best->over) best = &cell;
  }
  return best;
}

/// What is wrong with it, in its own words; empty if this program does not know it.
std::string summary_of(const Registry* cullers, const std::string& chain) {
  if (cullers == nullptr) return {};
  try {
    return cullers->make(chain)->info().summary;
  } catch (const InputError&) {
    return {};
  }
}

/// By what is wrong: the same mistake in several sizes stands there once.
std::map<std::string, Damage> damages_of(const std::vector<const BlockSummary*>& blocks,
                                         const Registry* cullers) {
  std::map<std::string, Damage> damages;
  for (const BlockSummary* block : blocks) {
    for (const CellSummary& cell : block->cells) {
      if (cell.guarantee != Guarantee::erroneous || !cell.judged) continue;
      const std::string wrong = summary_of(cullers, cell.canonical);
      Damage& damage = damages[wrong.empty() ? cell.canonical : wrong];
      if (damage.false_cell == nullptr || false_share(cell) > false_share(*damage.false_cell)) {
        damage.false_cell = &cell;
        damage.false_block = block;
      }
      const CellSummary* const right = right_one(*block, cell);
      if (right == nullptr) continue;
      if (damage.over_cell == nullptr ||
          cell.over - right->over > damage.over_cell->over - damage.right_over) {
        damage.over_cell = &cell;
        damage.over_block = block;
        damage.right_over = right->over;
      }
    }
  }
  return damages;
}

}  // namespace

std::vector<Fields> control_fields(const ReportInput& input) {
  std::vector<const BlockSummary*> blocks;
  for (const BlockSummary& block : input.blocks) blocks.push_back(&block);
  for (const BlockSummary& block : input.sweep_blocks) blocks.push_back(&block);
  std::vector<Fields> rows;
  for (const auto& [key, damage] : damages_of(blocks, input.cullers)) {
    Fields row;
    const CellSummary& worst = *damage.false_cell;
    const std::string wrong = summary_of(input.cullers, worst.canonical);
    row.values["method"] = markdown_code(worst.culler);
    row.values["wrong"] = wrong.empty() ? "–" : markdown_text(wrong);
    row.values["false_px"] = worst.false_px == 0
                                 ? "0 everywhere"
                                 : format_of(worst.false_px, worst.pixels) + " (" +
                                       format_percent(false_share(worst)) + "), " +
                                       format_count(worst.false_objects) + " objects, on " +
                                       markdown_text(damage.false_block->scene);
    row.values["over"] = damage.over_cell == nullptr
                             ? "–"
                             : format_number(damage.over_cell->over) + " against " +
                                   format_number(damage.right_over) + ", on " +
                                   markdown_text(damage.over_block->scene);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace vislab
