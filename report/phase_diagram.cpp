#include "report/phase_diagram.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "common/scene/error.h"
#include "experiments/devices/device_spec.h"
#include "report/chart_legend.h"
#include "report/chart_parts.h"
#include "report/format.h"

namespace vislab {
namespace {

using namespace chart;

constexpr double panel_left = 112.0, panel_right = 672.0;
constexpr double row_height = 46.0, axis_height = 50.0, top_margin = 10.0;
constexpr double y_title_left = 12.0;
constexpr double decided_lead = 1.01;

/// As it was given: "0", "2.5", "1000".
std::string plain(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// A device's text without its latency, and the latency.
struct Place {
  std::string device;
  double latency_us = 0.0;
};

std::optional<Place> place_of(const std::string& device) {
  const DeviceSpec spec = parse_device(device);
  // A fitted device has the latency of the machine at hand.
  if (spec.kind != DeviceSpec::Kind::modelled) return std::nullopt;
  if (spec.is_fitted() && !spec.given.contains("latency_us")) return std::nullopt;
  Place place;
  place.device = "modelled[preset=" + spec.preset;
  for (const auto& [dial, value] : spec.given) {
    if (dial != "latency_us") place.device += ", " + dial + "=" + plain(value);
  }
  place.device += "]";
  place.latency_us = spec.model(gpu_preset(spec.preset).model).latency_us;
  return place;
}

/// A scene's name with a star for every word that is a number: "phase_hidden_*_heavy" of
/// phase_hidden_60_heavy. Of box_field_100k no word is.
std::string family_of(const std::string& scene) {
  std::string family;
  for (std::size_t at = 0; at <= scene.size();) {
    const std::size_t end = std::min(scene.find('_', at), scene.size());
    const std::string word = scene.substr(at, end - at);
    const bool is_number =
        !word.empty() && word.find_first_not_of("0123456789") == std::string::npos;
    family += (at == 0 ? "" : "_") + (is_number ? "*" : word);
    at = end + 1;
  }
  return family;
}

bool culls_by_frustum(const CellSummary& cell) {
  return cell.culls == Culls::outside_frustum && !cell.asks_device &&
         cell.canonical.find(" > ") == std::string::npos;
}

std::optional<PhaseCell> cell_of(const BlockSummary& block) {
  std::vector<const CellSummary*> cells = phase_contestants(block);
  if (cells.size() < 2) return std::nullopt;
  const auto time = [](const CellSummary* cell) { return cell->frame_ms.median.value; };
  std::ranges::stable_sort(cells, {}, time);
  PhaseCell result;
  result.winner = cells[0]->culler;
  result.next = cells[1]->culler;
  result.lead = time(cells[1]) / time(cells[0]);
  result.decided = result.lead >= decided_lead;
  const auto baseline =
      std::ranges::find_if(cells, [](const CellSummary* cell) { return culls_by_frustum(*cell); });
  if (baseline != cells.end()) result.over_frustum = time(*baseline) / time(cells[0]);
  return result;
}

/// Blocks of one diagram.
struct Group {
  std::string title;
  /// What blocks of different diagrams may differ in while they share their title, as it is added
  /// to that then.
  std::vector<std::string> facts;
  std::vector<std::pair<double, const BlockSummary*>> blocks;  // with their latency
};

/// Dials but for the latency, as text; two fits of the same preset differ in it.
std::string dials_of(const BlockSummary& block) {
  if (block.device_models.empty()) return {};
  GpuModel model = block.device_models.front();
  model.latency_us = 0.0;
  return to_text(model);
}

/// Adds to titles that several groups share what the groups differ in.
void tell_apart(std::vector<Group>& groups) {
  std::map<std::string, std::vector<Group*>> same;
  for (Group& group : groups) same[group.title].push_back(&group);
  for (const auto& [title, members] : same) {
    for (std::size_t fact = 0; fact < members.front()->facts.size(); ++fact) {
      const auto is_first = [&](const Group* group) {
        return group->facts[fact] == members.front()->facts[fact];
      };
      if (std::ranges::all_of(members, is_first)) continue;
      for (Group* group : members) group->title += ", " + group->facts[fact];
    }
  }
}

std::vector<Group> groups_of(const std::vector<BlockSummary>& blocks) {
  std::map<std::vector<std::string>, Group> groups;  // by title and facts
  for (const BlockSummary& block : blocks) {
    const std::optional<Place> place = place_of(block.device);
    // Times of fits that differ do not belong beside each other.
    if (!place || block.device_models.size() > 1) continue;
    const std::string title = family_of(block.scene) + " on " + place->device + ", " +
                              std::to_string(block.viewport.width) + " × " +
                              std::to_string(block.viewport.height);
    const std::vector<std::string> facts = {std::to_string(block.frames) + " frames",
                                            std::to_string(block.threads) + " threads",
                                            "seed " + std::to_string(block.seed), dials_of(block)};
    std::vector<std::string> key = facts;
    key.insert(key.begin(), title);
    Group& group = groups[key];
    group.title = title;
    group.facts = facts;
    group.blocks.emplace_back(place->latency_us, &block);
  }
  std::vector<Group> result;
  for (auto& [key, group] : groups) result.push_back(std::move(group));
  tell_apart(result);
  return result;
}

bool may_take_part(const CellSummary& cell) {
  return !cell.anchor && (cell.asks_device || culls_by_frustum(cell)) &&
         cell.guarantee <= Guarantee::image_exact;
}

bool takes_part(const CellSummary& cell) {
  return may_take_part(cell) && cell.frame_ms.measured() && is_free_of_errors(cell);
}

std::string reason_of_absence(const CellSummary& cell) {
  if (cell.status == ResultCell::Status::failed) return "failed: " + cell.reason;
  if (cell.status == ResultCell::Status::running) return "is not finished";
  if (!cell.judged) return "is not judged";
  return cell.frame_ms.measured() ? "is wrong" : "is not timed";
}

void add_absences(PhaseDiagram& diagram) {
  std::map<std::pair<std::string, std::string>, std::size_t> counts;
  for (const BlockSummary* block : diagram.blocks) {
    for (const CellSummary& cell : block->cells) {
      if (!may_take_part(cell) || takes_part(cell)) continue;
      ++counts[{cell.culler, reason_of_absence(cell)}];
    }
  }
  for (const auto& [what, count] : counts) {
    diagram.absences.push_back({what.first, what.second, count});
  }
}

void add_winners(PhaseDiagram& diagram) {
  std::map<std::string, int> wins;
  for (const PhaseRow& row : diagram.rows) {
    for (const auto& cell : row.by_latency) {
      if (cell) ++wins[cell->winner];
    }
  }
  for (const auto& [name, count] : wins) diagram.winners.push_back(name);
  std::ranges::stable_sort(diagram.winners, std::ranges::greater(),
                           [&](const std::string& name) { return wins.at(name); });
}

/// Mixed with white, so that black text is read on it.
std::string light_colour(const std::string& colour) {
  std::ostringstream text;
  text << '#' << std::hex << std::uppercase;
  for (const std::size_t at : {1, 3, 5}) {
    const int channel = std::stoi(colour.substr(at, 2), nullptr, 16);
    const int light = channel + (255 - channel) * 45 / 100;
    text << (light < 16 ? "0" : "") << light;
  }
  return text.str();
}

std::string times(double ratio) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(ratio < 10.0 ? 2 : 0);
  text << ratio << "×";
  return text.str();
}

class PhaseWriter {
 public:
  PhaseWriter(const PhaseDiagram& diagram, std::ostream& out) : diagram_(diagram), out_(out) {
    std::vector<LegendEntry> entries;
    for (std::size_t i = 0; i < diagram.winners.size(); ++i) {
      LegendEntry entry;
      entry.text = phase_letter(i) + "  " + diagram.winners[i];
      entry.field = light_colour(method_look(i).colour);
      entries.push_back(std::move(entry));
    }
    legend_ = Legend(std::move(entries));
    bottom_ = legend_.height() + axis_height;
    panel_height_ = row_height * static_cast<double>(diagram.rows.size());
    height_ = bottom_ + panel_height_ + top_margin;
  }

  void write(const std::filesystem::path& file) {
    start_chart(out_, file, height_);
    write_panel();
    legend_.write(out_, height_);
    end_chart(out_);
  }

 private:
  std::size_t index_of(const std::string& winner) const {
    return static_cast<std::size_t>(std::ranges::find(diagram_.winners, winner) -
                                    diagram_.winners.begin());
  }

  void rectangle(double left, double low, double right, double high, const std::string& colour) {
    out_ << "set object rectangle from first " << left << ',' << low << " to first " << right << ','
         << high << " fc rgb '" << colour << "' fs solid border lc rgb '#FFFFFF'\n";
  }
  void text(double x, double y, const std::string& words, const char* font) {
    out_ << "set label " << quoted(words) << " at first " << x << ',' << y << " center font '"
         << font << "' front\n";
  }

  void write_panel() {
    out_ << "unset label\nunset arrow\nunset object\nset border 3 lc rgb '#444444'\n"
         << "set tics nomirror out scale 0.5\nunset grid\nunset title\nunset ylabel\n"
         << "set xlabel " << quoted("latency of an answer (µs)") << " offset 0,0.5\nset label "
         << quoted("hidden share of what is\nin the frustum, measured") << " at screen "
         << y_title_left / chart_width << ',' << (bottom_ + 0.5 * panel_height_) / height_
         << " center rotate by 90\n";
    ChartAxis x;
    x.high = static_cast<double>(diagram_.latencies_us.size());
    for (std::size_t i = 0; i < diagram_.latencies_us.size(); ++i) {
      x.ticks.emplace_back(static_cast<double>(i) + 0.5, plain(diagram_.latencies_us[i]));
    }
    ChartAxis y;
    y.high = static_cast<double>(diagram_.rows.size());
    for (std::size_t i = 0; i < diagram_.rows.size(); ++i) {
      y.ticks.emplace_back(static_cast<double>(i) + 0.5,
                           // gnuplot takes tick labels for formats.
                           format_percent(diagram_.rows[i].hidden_share) + "%");
    }
    set_axis(out_, 'x', x);
    set_axis(out_, 'y', y);
    set_margins(out_, panel_left, bottom_, panel_right - panel_left, panel_height_, height_);
    for (std::size_t row = 0; row < diagram_.rows.size(); ++row) {
      for (std::size_t column = 0; column < diagram_.latencies_us.size(); ++column) {
        write_cell(diagram_.rows[row].by_latency[column], static_cast<double>(column),
                   static_cast<double>(row));
      }
    }
    out_ << "plot NaN notitle\n";
  }

  void write_cell(const std::optional<PhaseCell>& cell, double x, double y) {
    if (!cell) {
      text(x + 0.5, y + 0.5, "–", ",11");
      return;
    }
    const std::size_t winner = index_of(cell->winner);
    rectangle(x, y, x + 1.0, y + 1.0, light_colour(method_look(winner).colour));
    text(x + 0.5, y + 0.74, phase_letter(winner) + (cell->decided ? "" : " (tie)"), ",13");
    text(x + 0.5, y + 0.28,
         times(cell->lead) + (cell->over_frustum ? " | " + times(*cell->over_frustum) : ""), ",10");
  }

  const PhaseDiagram& diagram_;
  std::ostream& out_;
  Legend legend_;
  double bottom_ = 0.0, panel_height_ = 0.0, height_ = 0.0;
};

}  // namespace

std::string phase_letter(std::size_t winner) {
  return std::string(1, static_cast<char>('A' + winner % 26));
}

std::vector<const CellSummary*> phase_contestants(const BlockSummary& block) {
  std::vector<const CellSummary*> cells;
  for (const CellSummary& cell : block.cells) {
    if (takes_part(cell)) cells.push_back(&cell);
  }
  return cells;
}

std::vector<PhaseDiagram> phase_diagrams(
    const std::vector<BlockSummary>& blocks,
    const std::function<double(const BlockSummary& block)>& hidden_share) {
  std::vector<PhaseDiagram> diagrams;
  if (!hidden_share) return diagrams;
  for (const Group& group : groups_of(blocks)) {
    PhaseDiagram diagram;
    diagram.title = group.title;
    for (const auto& [latency, block] : group.blocks) {
      diagram.latencies_us.push_back(latency);
      diagram.blocks.push_back(block);
    }
    std::ranges::sort(diagram.latencies_us);
    const auto repeated = std::ranges::unique(diagram.latencies_us);
    diagram.latencies_us.erase(repeated.begin(), repeated.end());
    std::map<std::vector<std::string>, PhaseRow> rows;  // by scene and path
    for (const auto& [latency, block] : group.blocks) {
      if (diagram.latencies_us.size() < 2) break;
      PhaseRow& row = rows[{block->scene, block->path, block->scene_hash, block->path_hash}];
      if (row.scene.empty()) {
        row.scene = block->scene;
        row.path = block->path;
        row.by_latency.resize(diagram.latencies_us.size());
        try {
          row.hidden_share = hidden_share(*block);
        } catch (const InputError&) {
          row.hidden_share = std::nan("");  // left out below: results outlive their scenes
        }
      }
      const auto column = std::ranges::lower_bound(diagram.latencies_us, latency);
      row.by_latency[static_cast<std::size_t>(column - diagram.latencies_us.begin())] =
          cell_of(*block);
    }
    for (auto& [key, row] : rows) {
      if (!std::isnan(row.hidden_share)) diagram.rows.push_back(std::move(row));
    }
    if (diagram.rows.size() < 2) continue;
    std::ranges::stable_sort(diagram.rows, {}, &PhaseRow::hidden_share);
    add_winners(diagram);
    add_absences(diagram);
    if (!diagram.winners.empty()) diagrams.push_back(std::move(diagram));
  }
  return diagrams;
}

std::string phase_script(const PhaseDiagram& diagram, const std::filesystem::path& file) {
  std::ostringstream script;
  script.precision(12);
  PhaseWriter(diagram, script).write(file);
  return script.str();
}

}  // namespace vislab
