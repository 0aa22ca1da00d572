#include "report/family_stability.h"

#include <algorithm>
#include <functional>
#include <map>
#include <tuple>

#include "report/family_measures.h"
#include "report/format.h"

namespace vislab {
namespace {

constexpr std::size_t most_rows = 12;

struct Most {
  double figure = 0.0;
  const CellSummary* cell = nullptr;

  void take(double other, const CellSummary& of) {
    if (!(other > figure)) return;
    figure = other;
    cell = &of;
  }
};

struct Place {
  bool is_held_to_it = false;  // a sweep of one of these figures
  std::size_t runs = 0;
  std::size_t moved = 0;  // runs with any of the three
  Most flicker, pop, latency;
};

bool is_over_time(const std::string& metric) {
  return metric == "flicker" || metric == "pop" || metric == "latency";
}

/// The sweep that made the block: its scenes and paths bear its name. The longest name counts, for
/// one sweep's may begin as another's.
const Sweep* sweep_of(const std::vector<SweepResult>& sweeps, const BlockSummary& block) {
  const auto bears = [](const std::string& text, const std::string& name) {
    return text == name || text.starts_with(name + "-");
  };
  const Sweep* found = nullptr;
  for (const SweepResult& result : sweeps) {
    const std::string& name = result.sweep.name;
    if (!bears(block.scene, name) && !bears(block.path, name)) continue;
    if (found == nullptr || name.size() > found->name.size()) found = &result.sweep;
  }
  return found;
}

std::string most_text(const Most& most) {
  if (most.cell == nullptr) return "0";
  return format_rounded(most.figure) + ", " + markdown_code(most.cell->culler);
}

void add_block(const BlockSummary& block, const FamilyOn& on, Place& place) {
  if (block.frames < 2) return;
  for (const FamilyMethod& method : on.methods) {
    const CellSummary& cell = *method.cell;
    if (cell.guarantee == Guarantee::erroneous) continue;
    ++place.runs;
    const double flicker = cell.metric("flicker");
    const double pop = cell.metric("pop");
    const double latency = cell.metric("latency");
    if (flicker > 0.0 || pop > 0.0 || latency > 0.0) ++place.moved;
    place.flicker.take(flicker, cell);
    place.pop.take(pop, cell);
    place.latency.take(latency, cell);
  }
}

}  // namespace

void add_stability_fields(const ReportInput& input,
                          const std::vector<const BlockSummary*>& in_diagrams,
                          const std::string& family, Fields& fields) {
  std::map<std::string, Place> places;
  for (const BlockSummary& block : input.blocks) {
    if (std::ranges::count(in_diagrams, &block) > 0) continue;
    add_block(block, family_on(block, family, input.cullers),
              places[markdown_text(block.scene + ", " + block.path)]);
  }
  for (const BlockSummary& block : input.sweep_blocks) {
    const Sweep* const sweep = sweep_of(input.sweeps, block);
    if (sweep == nullptr) continue;
    Place& place = places["sweep of " + markdown_text(sweep->dial.name) + " (" +
                          markdown_code(sweep->name) + ")"];
    place.is_held_to_it = is_over_time(sweep->limit.metric);
    add_block(block, family_on(block, family, input.cullers), place);
  }
  std::size_t runs = 0;
  std::size_t moved = 0;
  std::vector<const std::pair<const std::string, Place>*> told;
  for (const auto& entry : places) {
    runs += entry.second.runs;
    moved += entry.second.moved;
    if (entry.second.moved > 0) told.push_back(&entry);
  }
  std::ranges::stable_sort(told, std::greater<>(), [](const auto* entry) {
    const Place& place = entry->second;
    return std::tuple(place.is_held_to_it, place.pop.figure, place.flicker.figure);
  });
  const std::size_t more = told.size() - std::min(told.size(), most_rows);
  told.resize(told.size() - more);
  auto& rows = fields.lists["over_time"];
  for (const auto* entry : told) {
    const Place& place = entry->second;
    rows.emplace_back();
    rows.back().values["place"] = entry->first;
    rows.back().values["moved"] = std::to_string(place.moved) + " of " + std::to_string(place.runs);
    rows.back().values["flicker"] = most_text(place.flicker);
    rows.back().values["pop"] = most_text(place.pop);
    rows.back().values["latency"] = most_text(place.latency);
  }
  fields.flag("has_runs_over_time", runs > 0);
  fields.flag("has_over_time", !rows.empty());
  fields.flag("has_more_over_time", more > 0);
  fields.values["over_time_runs"] = format_count(runs);
  fields.values["over_time_quiet"] = format_count(runs - moved);
  fields.values["over_time_more"] = format_count(more);
}

}  // namespace vislab
