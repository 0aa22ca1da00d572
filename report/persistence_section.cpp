#include "report/persistence_section.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "algorithms/occlusion/persistence.h"
#include "common/scene/error.h"
#include "report/format.h"
#include "report/parallel.h"

namespace vislab {
namespace {

using occlusion_culling::Persistence;

bool builds_on_the_past(const CellSummary& cell) {
  return cell.asks_device && cell.repeatability == Repeatability::path;
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

/// A scene's counts at one time, over all its paths.
struct SceneShare {
  std::string scene;
  StillHidden still;
};

std::vector<SceneShare> shares_at(const std::vector<PersistenceRow>& rows, std::size_t t) {
  std::map<std::string, StillHidden> sums;
  for (const PersistenceRow& row : rows) {
    sums[row.scene].cases += row.counts.after[t].cases;
    sums[row.scene].hidden += row.counts.after[t].hidden;
  }
  std::vector<SceneShare> shares;
  for (const auto& [scene, still] : sums) {
    if (still.cases >= least_persistence_cases) shares.push_back({scene, still});
  }
  std::ranges::stable_sort(shares, {},
                           [](const SceneShare& share) { return share.still.share().value; });
  return shares;
}

/// "0.740 (city)".
std::string text_of(const SceneShare& share) {
  return format_number(share.still.share().value) + " (" + markdown_text(share.scene) + ")";
}

/// The two paths of one scene that differ most at a time, of those whose intervals lie apart, as
/// text; empty if there are none.
std::string spread_of_paths(const std::vector<PersistenceRow>& rows, std::size_t t) {
  std::string widest;
  double most = -1.0;
  for (const PersistenceRow& low : rows) {
    for (const PersistenceRow& high : rows) {
      if (low.scene != high.scene || low.path == high.path) continue;
      if (low.counts.after[t].cases < least_persistence_cases) continue;
      if (high.counts.after[t].cases < least_persistence_cases) continue;
      const Estimate least = low.counts.after[t].share();
      const Estimate greatest = high.counts.after[t].share();
      if (least.high >= greatest.low || greatest.value - least.value <= most) continue;
      most = greatest.value - least.value;
      widest = format_number(least.value) + " (" + markdown_code(low.path) + ") and " +
               format_number(greatest.value) + " (" + markdown_code(high.path) + ")";
    }
  }
  return widest;
}

constexpr std::size_t told_times[] = {1, 2, 4, 8, 16};

/// Is p(t) independent of the scene? Not where the intervals of two scenes lie apart.
void add_answer(const std::vector<PersistenceRow>& rows, Fields& fields) {
  std::string apart;
  std::size_t compared = 0;
  std::size_t first = 0;
  for (const std::size_t t : told_times) {
    const std::vector<SceneShare> shares = shares_at(rows, t);
    if (shares.size() < 2) continue;
    ++compared;
    if (first == 0) first = t;
    if (shares.front().still.share().high >= shares.back().still.share().low) continue;
    if (apart.empty()) first = t;
    apart += (apart.empty() ? "" : ", ") + std::to_string(t);
  }
  fields.flag("p_differs", !apart.empty());
  fields.flag("p_alike", apart.empty() && compared > 0);
  fields.flag("p_untold", compared == 0);
  fields.values["p_apart"] = apart;
  fields.values["p_time"] = std::to_string(first);
  const std::vector<SceneShare> shares = shares_at(rows, std::max<std::size_t>(first, 1));
  const bool several = shares.size() > 1;
  fields.values["p_least"] = several ? text_of(shares.front()) : "–";
  fields.values["p_most"] = several ? text_of(shares.back()) : "–";
  const double most_appear = several ? 1.0 - shares.front().still.share().value : 0.0;
  const double least_appear = several ? 1.0 - shares.back().still.share().value : 0.0;
  fields.flag("p_has_factor", least_appear > 0.0);
  fields.values["p_factor"] = format_number(most_appear / least_appear);
  const std::string paths = spread_of_paths(rows, std::max<std::size_t>(first, 1));
  fields.flag("p_has_paths", !paths.empty());
  fields.values["p_paths"] = paths;
}

}  // namespace

std::vector<PersistenceRow> persistence_rows(const ReportInput& input,
                                             const std::vector<const BlockSummary*>& left_out) {
  std::vector<PersistenceRow> rows;
  if (!input.persistence) return rows;
  using Place = std::pair<std::string, std::string>;  // scene and path
  std::map<Place, std::vector<const BlockSummary*>> blocks;
  std::vector<Place> places;  // in the blocks' order
  for (const BlockSummary& block : input.blocks) {
    if (std::ranges::none_of(block.cells, builds_on_the_past)) continue;
    if (std::ranges::count(left_out, &block) > 0) continue;
    const Place place{block.scene, block.path};
    if (blocks[place].empty()) places.push_back(place);
    blocks[place].push_back(&block);
  }
  std::vector<std::optional<PersistenceRow>> found(places.size());
  for_each_index(places.size(), [&](std::size_t i) {
    std::vector<const BlockSummary*> measured = blocks.at(places[i]);
    std::ranges::stable_sort(measured, std::ranges::greater(), [](const BlockSummary* block) {
      return std::pair(block->frames, block->viewport.width * block->viewport.height);
    });
    for (const BlockSummary* block : measured) {
      try {
        found[i] = {block->scene, block->path, block->viewport, block->frames,
                    input.persistence(*block)};
        break;
      } catch (const InputError&) {
        continue;  // the scene's own section says why it cannot be had
      }
    }
  });
  for (std::optional<PersistenceRow>& row : found) {
    if (row) rows.push_back(std::move(*row));
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
  for (const std::size_t t : told_times) spreads.push_back(spread_at(rows, t));
  add_answer(rows, fields);
}

}  // namespace vislab
