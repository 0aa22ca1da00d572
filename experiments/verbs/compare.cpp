#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "common/scene/error.h"
#include "experiments/analysis/errors.h"
#include "experiments/matrix/matrix.h"
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
/// measured beside it. Nothing if they share no round.
Estimate paired_frames(const ResultCell& a, const ResultCell& b) {
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

/// A logarithm and its standard error, as if the interval were that of a normal distribution.
struct LogRatio {
  double value = 0.0, error = 0.0;
};

constexpr double normal_95 = 1.959964;

LogRatio log_of(const Estimate& ratio) {
  return {std::log(ratio.value), (std::log(ratio.high) - std::log(ratio.low)) / (2.0 * normal_95)};
}

Estimate estimate_of(const LogRatio& log) {
  return {std::exp(log.value), std::exp(log.value - normal_95 * log.error),
          std::exp(log.value + normal_95 * log.error)};
}

/// The ratio of two that were measured in different runs, each paired with "none" in its own: the
/// errors of both ratios add up.
Estimate ratio_through_none(const CellSummary& a, const CellSummary& b) {
  if (!a.against_none.measured() || !b.against_none.measured()) return Estimate::none();
  const LogRatio of_a = log_of(a.against_none);
  const LogRatio of_b = log_of(b.against_none);
  return estimate_of({of_a.value - of_b.value, std::hypot(of_a.error, of_b.error)});
}

/// Slower or faster only if the interval says so, and lies farther from 1 than "none" against
/// itself does; undecided without that control.
std::string speed_verdict(const Estimate& ratio, const Estimate& noise) {
  if (!ratio.measured()) return "undecided";
  const Estimate band = noise_band(noise);
  if (ratio.high < band.low) return "faster";
  if (ratio.low > band.high) return "slower";
  return "undecided";
}

/// Errors of a cell, or of several. Empty where a kind does not apply to any of them.
using Errors = std::array<std::optional<std::uint64_t>, error_kinds.size()>;

Errors errors_of(const CellSummary& cell) {
  Errors errors;
  const ErrorCounts counts = error_counts(cell);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (cell.judged && !std::isnan(cell.metric(error_kinds[i].metric))) errors[i] = counts[i];
  }
  return errors;
}

void add(Errors& sum, const Errors& errors) {
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (errors[i]) sum[i] = sum[i].value_or(0) + *errors[i];
  }
}

/// Of a against b: "mixed" if some counts are more and others fewer.
std::string error_verdict(const Errors& a, const Errors& b, bool between_pixels) {
  bool more = false;
  bool fewer = false;
  for (std::size_t i = 0; i < error_kinds.size(); ++i) {
    if (error_kinds[i].between_pixels && !between_pixels) continue;
    more |= a[i].value_or(0) > b[i].value_or(0);
    fewer |= a[i].value_or(0) < b[i].value_or(0);
  }
  if (more && fewer) return "mixed";
  return more ? "more" : fewer ? "fewer" : "same";
}

void add_columns(std::vector<TableValue>& row, const Errors& a, const Errors& b) {
  for (std::size_t i = 0; i < error_kinds.size(); ++i) {
    for (const auto& count : {a[i], b[i]}) {
      row.emplace_back();
      if (count) row.back() = *count;
    }
  }
}

const CellSummary* find_cell(const BlockSummary& block, const std::string& chain) {
  const auto cell = std::ranges::find_if(
      block.cells, [&](const CellSummary& c) { return c.canonical == chain && c.replicate == 0; });
  return cell == block.cells.end() ? nullptr : &*cell;
}

bool has_failed(const CellSummary& cell) { return cell.status == ResultCell::Status::failed; }

/// Why a block has no ratio, or what is to be known of it.
std::string note_on(const BlockSummary& block, const CellSummary& a, const CellSummary& b,
                    bool paired, bool measured) {
  for (const CellSummary* cell : {&a, &b}) {
    if (has_failed(*cell)) return cell->culler + " failed: " + cell->reason;
  }
  if (!is_of_one_machine(block)) {
    return "measured on " + std::to_string(block.machines.size()) + " machines: no common times";
  }
  if (!measured) return "no round has both";
  if (!block.noise.measured()) return "no control: none was not measured against itself";
  if (!paired) return "measured in different runs: through none";
  if (!a.judged || !b.judged) return "errors are not judged yet";
  return "";
}

/// What is known of two chains in all blocks of one device.
struct Overall {
  std::vector<Estimate> ratios;
  std::vector<Estimate> noises;
  Errors a, b;
  bool between_pixels = false;  // what is lost there counts
  std::size_t blocks = 0, judged = 0;
  std::size_t failed_a = 0, failed_b = 0;
  std::size_t mixed = 0;         // blocks of several machines
  std::size_t uncontrolled = 0;  // with a ratio, but without a control

  void count(const BlockSummary& block, const CellSummary& in_a, const CellSummary& in_b,
             const Estimate& ratio) {
    ++blocks;
    failed_a += has_failed(in_a) ? 1 : 0;
    failed_b += has_failed(in_b) ? 1 : 0;
    mixed += is_of_one_machine(block) ? 0 : 1;
    if (!ratio.measured() || !(ratio.low > 0.0)) return;
    ratios.push_back(ratio);
    if (block.noise.measured() && block.noise.low > 0.0) {
      noises.push_back(block.noise);
    } else {
      ++uncontrolled;
    }
  }

  /// Of the blocks whose ratios count; not known if one of them has no control.
  Estimate noise() const { return uncontrolled > 0 ? Estimate::none() : mean(noises); }

  /// "a failed in 2; 1 block of several machines left out": what the ratio is not of.
  std::string left_out(const std::string& name_a, const std::string& name_b) const {
    std::string text;
    const auto add_part = [&](std::size_t number, const std::string& part) {
      if (number > 0) text += (text.empty() ? "" : "; ") + part;
    };
    const auto blocks_text = [](std::size_t number) {
      return std::to_string(number) + (number == 1 ? " block" : " blocks");
    };
    add_part(failed_a, name_a + " failed in " + std::to_string(failed_a));
    add_part(failed_b, name_b + " failed in " + std::to_string(failed_b));
    add_part(mixed, blocks_text(mixed) + " of several machines left out");
    add_part(uncontrolled, blocks_text(uncontrolled) + " without a control");
    return text;
  }

  /// The geometric mean of the blocks' ratios: of these blocks, not of scenes at large.
  static Estimate mean(const std::vector<Estimate>& ratios) {
    if (ratios.empty()) return Estimate::none();
    if (ratios.size() == 1) return ratios.front();
    LogRatio sum;
    for (const Estimate& ratio : ratios) {
      const LogRatio log = log_of(ratio);
      sum.value += log.value;
      sum.error = std::hypot(sum.error, log.error);
    }
    const auto count = static_cast<double>(ratios.size());
    return estimate_of({sum.value / count, sum.error / count});
  }
};

std::string quoted(const std::string& text) {
  return text.find_first_of(" []>()&;*?$") == std::string::npos ? text : "'" + text + "'";
}

/// The calls that measure `chain` where `cell` was measured.
std::string command_beside(const ResultCell& cell, const std::string& chain, int frames,
                           const std::filesystem::path& results) {
  std::ostringstream call;
  call << "vislab run --culler " << quoted(chain) << " --scene " << quoted(cell.scene_source);
  if (!cell.path_source.empty()) call << " --path " << quoted(cell.path_source);
  call << " --resolution " << cell.key.viewport.width << "x" << cell.key.viewport.height
       << " --frames " << frames << " --draw " << quoted(cell.key.device) << " --threads "
       << cell.key.threads << " --results " << quoted(results.string());
  return call.str();
}

/// The smallest matrix with a block that has both chains; "" if there is none.
std::string matrix_with(const Lab& lab, const std::string& a, const std::string& b) {
  std::string best;
  std::size_t cells_of_best = 0;
  for (const auto& [name, text] : list_matrices(lab.matrices)) {
    std::size_t cells = 0;
    bool both = false;
    try {
      for (const Block& block : load_matrix(name, lab.matrices, lab.cullers).blocks) {
        std::set<std::string> chains;
        for (const BlockCuller& culler : block.cullers) chains.insert(culler.chain);
        both |= chains.contains(a) && chains.contains(b);
        cells += block.cullers.size();
      }
    } catch (const InputError&) {
      continue;  // a broken matrix is no advice
    }
    if (both && (best.empty() || cells < cells_of_best)) {
      best = name;
      cells_of_best = cells;
    }
  }
  return best;
}

/// What to call so that both chains are in one block.
std::string advice(const Lab& lab, const std::string& a, const std::string& b,
                   const std::vector<BlockSummary>& blocks,
                   const std::map<std::string, const ResultCell*>& by_id,
                   const std::filesystem::path& results) {
  const std::string name_a = lab.cullers.short_name(a);
  const std::string name_b = lab.cullers.short_name(b);
  for (const auto& [there, other] : {std::pair(a, name_b), std::pair(b, name_a)}) {
    for (const BlockSummary& block : blocks) {
      const CellSummary* const cell = find_cell(block, there);
      // The lab's own anchors are everywhere: only a matrix says where the other is worth a look.
      if (cell == nullptr || cell->anchor) continue;
      return command_beside(*by_id.at(cell->id), other, block.frames, results);
    }
  }
  const std::string to = " --results " + quoted(results.string());
  if (const std::string matrix = matrix_with(lab, a, b); !matrix.empty()) {
    return "vislab run " + matrix + to;
  }
  const std::vector<std::string> anchors = anchor_chains(lab.cullers);
  const auto is_anchor = [&](const std::string& chain) {
    return std::ranges::find(anchors, chain) != anchors.end();
  };
  const std::string call =
      "vislab run --culler " + quoted(is_anchor(a) ? name_b : name_a) + " --scene SCENE" + to;
  if (is_anchor(a) || is_anchor(b)) return call;
  return call + ", and the same with --culler " + quoted(name_b);
}

/// "a is faster than b: 0.62 of its time (0.60 to 0.64) in 3 of 4 blocks, drawn by osmesa; b failed
/// in 1; the same errors in 3 judged blocks".
std::string sentence(const std::string& a, const std::string& b, const std::string& device,
                     const Overall& overall, const Estimate& ratio, const std::string& speed) {
  std::ostringstream text;
  if (speed == "undecided") {
    text << "undecided whether " << a << " is faster than " << b;
  } else {
    text << a << " is " << speed << " than " << b;
  }
  if (ratio.measured()) {
    text << ": " << to_text(ratio.value) << " of its time (" << to_text(ratio.low) << " to "
         << to_text(ratio.high) << ")";
  }
  text << " in ";
  if (overall.ratios.size() < overall.blocks) text << overall.ratios.size() << " of ";
  text << overall.blocks << (overall.blocks == 1 ? " block" : " blocks") << ", "
       << (device == "none" ? "nothing drawn" : "drawn by " + device) << "; ";
  if (const std::string left_out = overall.left_out(a, b); !left_out.empty()) {
    text << left_out << "; ";
  }
  if (overall.judged == 0) {
    text << "errors are not judged";
  } else {
    const std::string errors = error_verdict(overall.a, overall.b, overall.between_pixels);
    text << (errors == "same"    ? "the same errors"
             : errors == "mixed" ? "more errors of one kind, fewer of another"
                                 : errors + " errors");
    text << " in " << overall.judged << " judged " << (overall.judged == 1 ? "block" : "blocks");
  }
  return text.str();
}

TableValue judged_text(bool judged, const std::string& text) {
  return judged ? TableValue(text) : TableValue();
}

}  // namespace

int compare(const Lab& lab, const std::string& a, const std::string& b,
            const std::filesystem::path& results, bool json) {
  const std::string chain_a = lab.cullers.canonical(a);
  const std::string chain_b = lab.cullers.canonical(b);
  if (chain_a == chain_b) {
    throw InputError("'" + a + "' and '" + b + "' are the same chain, " + chain_a +
                     "; compare takes two that differ");
  }
  const std::string name_a = lab.cullers.short_name(a);
  const std::string name_b = lab.cullers.short_name(b);
  const std::vector<JudgedCell> cells = require_present_cells(results, lab.cullers);
  std::map<std::string, const ResultCell*> by_id;
  for (const JudgedCell& judged : cells) by_id[judged.cell.key.id()] = &judged.cell;

  std::vector<std::string> columns{"scene",      "path",           "resolution", "device",
                                   "blocks",     "judged",         "a",          "b",
                                   "speed",      "ratio",          "ratio_low",  "ratio_high",
                                   "noise_low",  "noise_high",     "frame_ms_a", "frame_ms_p99_a",
                                   "frame_ms_b", "frame_ms_p99_b", "errors"};
  for (const ErrorKind& kind : error_kinds) {
    for (const char* side : {"_a", "_b"}) columns.push_back(kind.metric + std::string(side));
  }
  columns.insert(columns.end(), {"over_a", "over_b", "note"});
  Table table(columns);
  std::map<std::string, Overall> by_device;
  const std::vector<BlockSummary> blocks = summarise(cells);
  for (const BlockSummary& block : blocks) {
    const CellSummary* const in_a = find_cell(block, chain_a);
    const CellSummary* const in_b = find_cell(block, chain_b);
    if (in_a == nullptr || in_b == nullptr) continue;
    const bool both_done = !has_failed(*in_a) && !has_failed(*in_b);
    Estimate ratio = Estimate::none();
    bool paired = false;
    if (both_done && is_of_one_machine(block)) {
      ratio = paired_frames(*by_id.at(in_a->id), *by_id.at(in_b->id));
      paired = ratio.measured();
      if (!paired) ratio = ratio_through_none(*in_a, *in_b);
    }
    const bool both_judged = both_done && in_a->judged && in_b->judged;
    const bool between_pixels = counts_between_pixels(std::array{in_a->guarantee, in_b->guarantee});
    const Errors of_a = errors_of(*in_a);
    const Errors of_b = errors_of(*in_b);

    Overall& overall = by_device[block.device];
    overall.count(block, *in_a, *in_b, ratio);
    if (both_judged) {
      ++overall.judged;
      add(overall.a, of_a);
      add(overall.b, of_b);
      overall.between_pixels |= between_pixels;
    }
    const auto over = [](const CellSummary& cell) {
      return cell.judged ? TableValue(cell.over) : TableValue();
    };
    std::vector<TableValue> row{
        block.scene,
        block.path,
        std::to_string(block.viewport.width) + "x" + std::to_string(block.viewport.height),
        block.device,
        std::uint64_t{1},
        std::uint64_t{both_judged ? 1U : 0U},
        in_a->culler,
        in_b->culler,
        speed_verdict(ratio, block.noise),
        ratio.value,
        ratio.low,
        ratio.high,
        block.noise.low,
        block.noise.high,
        in_a->frame_ms.median.value,
        in_a->frame_ms.p99,
        in_b->frame_ms.median.value,
        in_b->frame_ms.p99,
        judged_text(both_judged, error_verdict(of_a, of_b, between_pixels))};
    add_columns(row, of_a, of_b);
    row.insert(row.end(),
               {over(*in_a), over(*in_b), note_on(block, *in_a, *in_b, paired, ratio.measured())});
    table.add(std::move(row));
  }
  if (by_device.empty()) {
    throw InputError(
        "no block in " + results.string() + " has both " + name_a + " and " + name_b +
        "; measure them with: " + advice(lab, chain_a, chain_b, blocks, by_id, results));
  }
  std::string answer;
  for (const auto& [device, overall] : by_device) {
    const Estimate ratio = Overall::mean(overall.ratios);
    const Estimate noise = overall.noise();
    const std::string speed = speed_verdict(ratio, noise);
    std::vector<TableValue> row{
        {},
        {},
        {},
        device,
        std::uint64_t{overall.ratios.size()},
        std::uint64_t{overall.judged},
        name_a,
        name_b,
        speed,
        ratio.value,
        ratio.low,
        ratio.high,
        noise.low,
        noise.high,
        {},
        {},
        {},
        {},
        judged_text(overall.judged > 0,
                    error_verdict(overall.a, overall.b, overall.between_pixels))};
    add_columns(row, overall.a, overall.b);
    const std::string left_out = overall.left_out(name_a, name_b);
    row.insert(row.end(), {{}, {}, "all blocks" + (left_out.empty() ? "" : ": " + left_out)});
    table.add(std::move(row));
    answer += sentence(name_a, name_b, device, overall, ratio, speed) + "\n";
  }
  table.print(std::cout, json);
  if (!json) std::cout << '\n' << answer;
  return 0;
}

}  // namespace vislab
