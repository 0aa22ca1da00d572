#include <algorithm>
#include <iostream>
#include <map>

#include "common/scene/error.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

/// Frame times by session and round.
using RoundTimes = std::map<std::pair<std::string, int>, std::vector<double>>;

/// Of the other chain in the same rounds as this cell: as its anchor, or as a cell of its own.
RoundTimes beside(const ResultCell& cell, const ResultCell& other) {
  RoundTimes times;
  for (const Round& round : other.rounds) times[{round.session, round.number}] = round.frame_ms;
  if (const auto anchor = cell.anchors.find(other.key.chain); anchor != cell.anchors.end()) {
    for (const AnchorRound& round : anchor->second) {
      times[{round.session, round.number}] = round.frame_ms;
    }
  }
  return times;
}

/// Frame times of a over those of b, paired by round. The one that is no anchor leads: anchors are
/// measured beside it.
Estimate frame_ratio(const ResultCell& a, const ResultCell& b) {
  const bool b_leads = a.anchors.find(b.key.chain) == a.anchors.end();
  const ResultCell& leading = b_leads ? b : a;
  const RoundTimes others = beside(leading, b_leads ? a : b);
  SampleGrid of_leading;
  SampleGrid of_other;
  for (const Round& round : leading.rounds) {
    const auto other = others.find({round.session, round.number});
    if (other == others.end()) continue;
    of_leading.push_back(round.frame_ms);
    of_other.push_back(other->second);
  }
  return b_leads ? paired_ratio(of_other, of_leading) : paired_ratio(of_leading, of_other);
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
               "frame_ms_p99_a", "frame_ms_b", "frame_ms_p99_b", "device", "false_px_a",
               "false_px_b", "over_a", "over_b"});
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
               ratio.high, in_a->frame_ms.median.value, in_a->frame_ms.p99,
               in_b->frame_ms.median.value, in_b->frame_ms.p99, block.device,
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
