#include "report/persistence_section.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "algorithms/occlusion/persistence.h"
#include "common/scene/error.h"
#include "report/format.h"

namespace vislab {
namespace {

using occlusion_culling::Persistence;

bool builds_on_the_past(const CellSummary& cell) {
  return cell.canonical.find("occlusion.chc") != std::string::npos;
}

/// The time at which the counted share is farthest from the formula, from 1; 0 if nothing was
/// counted often enough.
std::size_t farthest_time(const PersistenceCounts& counts) {
  std::size_t farthest = 0;
  double most = -1.0;
  for (std::size_t t = 1; t < counts.after.size(); ++t) {
    if (counts.after[t].cases < least_persistence_cases) continue;
    const double difference = std::abs(counts.after[t].share().value -
                                       Persistence::formula(static_cast<std::uint32_t>(t)));
    if (difference > most) {
      most = difference;
      farthest = t;
    }
  }
  return farthest;
}

std::string with_cases(const StillHidden& still) {
  if (still.cases == 0) return "–";
  return format_number(still.share().value) + " [of " + format_count(still.cases) + "]{.interval}";
}

std::string text_of(const PersistenceFit& fit) {
  if (std::isnan(fit.level)) return "–";
  if (fit.drop == 0.0) return format_number(fit.level);
  return format_number(fit.level) + " − " + format_number(fit.drop) + " e^−t/" +
         format_number(fit.time) + "^";
}

Fields row_of(const PersistenceRow& row) {
  const PersistenceCounts& counts = row.counts;
  Fields fields;
  fields.values["scene"] = markdown_text(row.scene);
  fields.values["path"] = markdown_code(row.path);
  fields.values["turn"] = format_number(counts.turn_deg);
  fields.values["step"] = format_number(counts.step_m);
  fields.values["hidden"] = format_percent(counts.hidden_share);
  for (const std::size_t t : {1, 2, 4, 8, 16}) {
    fields.values["p" + std::to_string(t)] = with_cases(counts.after[t]);
  }
  fields.values["seen1"] = with_cases(counts.after_seen[1]);
  const std::size_t t = farthest_time(counts);
  fields.values["farthest"] =
      t == 0 ? "–"
             : format_number(std::abs(counts.after[t].share().value -
                                      Persistence::formula(static_cast<std::uint32_t>(t)))) +
                   " [t = " + std::to_string(t) + "]{.interval}";
  fields.values["fit"] = text_of(counts.fit());
  return fields;
}

/// What is said of one time: the formula, the extremes among the rows, and how many rows' intervals
/// hold the formula.
Fields spread_at(const std::vector<PersistenceRow>& rows, std::size_t t) {
  const double formula = Persistence::formula(static_cast<std::uint32_t>(t));
  const PersistenceRow* least = nullptr;
  const PersistenceRow* most = nullptr;
  std::uint64_t counted = 0;
  std::uint64_t agree = 0;
  const auto share = [t](const PersistenceRow& row) { return row.counts.after[t].share().value; };
  for (const PersistenceRow& row : rows) {
    if (row.counts.after[t].cases < least_persistence_cases) continue;
    ++counted;
    const Estimate p = row.counts.after[t].share();
    if (p.low <= formula && formula <= p.high) ++agree;
    if (least == nullptr || share(row) < share(*least)) least = &row;
    if (most == nullptr || share(row) > share(*most)) most = &row;
  }
  Fields fields;
  fields.values["t"] = std::to_string(t);
  fields.values["formula"] = format_number(formula);
  fields.values["agree"] = format_of(agree, counted);
  for (const auto& [name, row] : {std::pair{"least", least}, std::pair{"most", most}}) {
    fields.values[name] =
        row == nullptr ? "–" : format_number(share(*row)) + " (" + markdown_code(row->path) + ")";
  }
  return fields;
}

}  // namespace

std::vector<PersistenceRow> persistence_rows(const ReportInput& input) {
  std::vector<PersistenceRow> rows;
  if (!input.persistence) return rows;
  std::set<std::tuple<std::string, std::string, int, int>> known;
  for (const BlockSummary& block : input.blocks) {
    if (std::ranges::none_of(block.cells, builds_on_the_past)) continue;
    if (!known
             .emplace(block.scene_hash, block.path_hash, block.viewport.width,
                      block.viewport.height)
             .second) {
      continue;
    }
    try {
      rows.push_back(
          {block.scene, block.path, block.viewport, block.frames, input.persistence(block)});
    } catch (const InputError&) {
      continue;  // the scene's own section says why it cannot be had
    }
  }
  return rows;
}

void add_persistence_fields(const std::vector<PersistenceRow>& rows, Fields& fields) {
  fields.flag("has_persistence", !rows.empty());
  fields.values["least_cases"] = format_count(least_persistence_cases);
  fields.values["persistence_chart"] = persistence_chart_file;
  auto& entries = fields.lists["persistences"];
  for (const PersistenceRow& row : rows) entries.push_back(row_of(row));
  auto& spreads = fields.lists["persistence_spreads"];
  for (const std::size_t t : {1, 2, 4, 8, 16}) spreads.push_back(spread_at(rows, t));
}

}  // namespace vislab
