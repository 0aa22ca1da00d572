#include <algorithm>
#include <iostream>
#include <map>

#include "common/scene/error.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

/// The rounds that both cells have, of the same run of their block.
Estimate frame_ratio(const ResultCell& a, const ResultCell& b) {
  SampleGrid of_a;
  SampleGrid of_b;
  for (const Round& x : a.rounds) {
    for (const Round& y : b.rounds) {
      if (x.session != y.session || x.number != y.number) continue;
      of_a.push_back(x.frame_ms);
      of_b.push_back(y.frame_ms);
    }
  }
  return paired_ratio(of_a, of_b);
}

const CellSummary* find_cell(const BlockSummary& block, const std::string& chain) {
  const auto cell = std::ranges::find_if(
      block.cells, [&](const CellSummary& c) { return c.canonical == chain && c.replicate == 0; });
  return cell == block.cells.end() ? nullptr : &*cell;
}

}  // namespace

int compare(const Lab& lab, const std::string& a, const std::string& b,
            const std::filesystem::path& results, bool json) {
  const std::string chain_a = lab.cullers.canonical(a);
  const std::string chain_b = lab.cullers.canonical(b);
  const std::vector<JudgedCell> cells = require_present_cells(results, lab.cullers);
  std::map<std::string, const ResultCell*> by_id;
  for (const JudgedCell& judged : cells) by_id[judged.cell.key.id()] = &judged.cell;

  Table table({"scene", "path", "a", "b", "ratio", "ratio_low", "ratio_high", "frame_ms_a",
               "frame_ms_b", "false_px_a", "false_px_b", "over_a", "over_b"});
  bool any = false;
  for (const BlockSummary& block : summarise(cells)) {
    const CellSummary* const in_a = find_cell(block, chain_a);
    const CellSummary* const in_b = find_cell(block, chain_b);
    if (in_a == nullptr || in_b == nullptr) continue;
    any = true;
    const Estimate ratio = frame_ratio(*by_id.at(in_a->id), *by_id.at(in_b->id));
    const auto judged = [](const CellSummary& cell, auto value) {
      return cell.judged ? TableValue(value) : TableValue();
    };
    table.add({block.scene, block.path, in_a->culler, in_b->culler, ratio.value, ratio.low,
               ratio.high, in_a->frame_ms.median.value, in_b->frame_ms.median.value,
               judged(*in_a, in_a->false_px), judged(*in_b, in_b->false_px),
               judged(*in_a, in_a->over), judged(*in_b, in_b->over)});
  }
  if (!any) {
    throw InputError("no block in " + results.string() + " has both " + lab.cullers.short_name(a) +
                     " and " + lab.cullers.short_name(b));
  }
  table.print(std::cout, json);
  return 0;
}

}  // namespace vislab
