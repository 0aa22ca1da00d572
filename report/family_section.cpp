#include "report/family_section.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "common/scene/error.h"
#include "report/chart.h"
#include "report/dial_curves.h"
#include "report/family_measures.h"
#include "report/family_stability.h"
#include "report/finding.h"
#include "report/format.h"
#include "report/sweep_section.h"

namespace vislab {
namespace {

constexpr std::size_t charts_a_family = 2;
constexpr std::size_t missing_named = 4;  // a matrix

/// Of a text that may hold the name of a dial instead of a value, and so need not be a chain.
std::string last_name(const std::string& text) {
  const std::size_t stage = text.rfind("> ");
  const std::string last = stage == std::string::npos ? text : text.substr(stage + 2);
  return last.substr(0, last.find('['));
}

bool is_left_out(const std::string& name, const Registry* cullers) {
  if (cullers == nullptr) return false;
  const auto found = cullers->entries().find(name);
  return found != cullers->entries().end() && found->second.info.needs_truth;
}

/// "apartment, apartment_walk", with the size and device where several blocks share them.
std::string place_of(const std::vector<BlockSummary>& blocks, const BlockSummary& block) {
  const auto same = std::ranges::count_if(blocks, [&](const BlockSummary& other) {
    return other.scene == block.scene && other.path == block.path;
  });
  std::string place = block.scene + (block.path.empty() ? "" : ", " + block.path);
  if (same > 1) {
    place += ", " + std::to_string(block.viewport.width) + " × " +
             std::to_string(block.viewport.height) + ", " + block.device;
  }
  return markdown_text(place);
}

bool is_in(const std::vector<const BlockSummary*>& blocks, const BlockSummary& block) {
  return std::ranges::find(blocks, &block) != blocks.end();
}

/// Does a block of the same scene say more of the family: with more methods, of these drawn, in
/// more frames?
bool tells_more(const FamilyOn& a, const BlockSummary& on_a, const FamilyOn& b,
                const BlockSummary& on_b) {
  return std::tuple(a.methods.size(), on_a.drawn, on_a.frames) >
         std::tuple(b.methods.size(), on_b.drawn, on_b.frames);
}

bool is_among(const FamilyOn& on, const CellSummary& cell) {
  return std::ranges::find(on.methods, &cell, &FamilyMethod::cell) != on.methods.end();
}

Fields method_row(const CullerInfo& info) {
  Fields row;
  row.values["method"] = markdown_code(info.name);
  row.values["idea"] = markdown_text(info.summary);
  row.values["promise"] = markdown_text(to_string(info.guarantee));
  row.values["place"] =
      std::string(to_string(info.space)) + ", " + std::string(to_string(info.stage));
  row.values["cost"] = markdown_text(info.cost);
  row.values["fails"] = markdown_text(info.limits);
  return row;
}

Fields best_row(const std::vector<BlockSummary>& blocks, const BlockSummary& block,
                const FamilyOn& on) {
  Fields row;
  row.values["place"] = place_of(blocks, block);
  for (const char* name : {"best", "against", "ratio", "efficiency", "over", "recall"}) {
    row.values[name] = "–";
  }
  if (on.best != nullptr) {
    const CellSummary& best = *on.best->cell;
    row.values["best"] = markdown_code(best.culler);
    row.values["against"] = markdown_code(on.best->against());
    row.values["ratio"] = format_estimate(on.best->ratio);
    row.values["efficiency"] = format_number(best.efficiency.value);
    row.values["over"] = format_number(best.over);
    row.values["recall"] = format_percent(best.recall);
  }
  row.values["erring"] = std::to_string(on.erring) + " of " + std::to_string(on.methods.size());
  row.values["worst"] = on.most_wrong != nullptr
                            ? markdown_code(on.most_wrong->culler) + ", " +
                                  format_percent(static_cast<double>(wrong_pixels(*on.most_wrong)) /
                                                 static_cast<double>(on.most_wrong->pixels))
                            : "–";
  return row;
}

/// "`m` at 4 m".
std::string break_of(const Sweep& sweep, const SweepVerdict& verdict) {
  std::string text =
      markdown_code(verdict.culler) + " at " + dial_text(sweep.dial, *verdict.break_point);
  if (verdict.agreement == SweepVerdict::Agreement::differs) text += " (not as expected)";
  return text;
}

/// "`vislab run a b` measures its break points": the sweeps with a method of the family of which
/// nothing is in the results.
std::string sweeps_not_run(const ReportInput& input, const std::string& family) {
  std::string names;
  for (const SweepResult& result : input.sweeps) {
    if (result.was_measured()) continue;
    if (std::ranges::none_of(result.sweep.methods, [&](const SweepMethod& method) {
          return family_of_stage(last_name(method.culler), input.cullers) == family;
        })) {
      continue;
    }
    names += (names.empty() ? "" : " ") + result.sweep.name;
  }
  if (names.empty()) return {};
  return "Stress sweeps with methods of this family that are not in the results: " +
         markdown_code("vislab run " + names) + " measures them, " +
         markdown_code("vislab run stress") + " all sweeps of all families.";
}

/// "Of the matrix `m` 12 of 45 cells are here; missing of this family: `a` (3), `b` (1) and 2 more"
std::vector<Fields> matrix_gaps(const ReportInput& input, const std::string& family) {
  std::vector<Fields> gaps;
  for (const MatrixShare& matrix : input.matrices) {
    std::string names;
    std::size_t methods = 0;
    for (const auto& [chain, cells] : matrix.missing) {
      if (family_of_stage(last_name(chain), input.cullers) != family) continue;
      if (++methods > missing_named) continue;
      names += (names.empty() ? "" : ", ") + markdown_code(chain) + " (" + std::to_string(cells) +
               (cells == 1 ? " cell)" : " cells)");
    }
    if (methods == 0) continue;
    if (methods > missing_named) {
      names += " and " + std::to_string(methods - missing_named) + " more methods";
    }
    gaps.emplace_back();
    gaps.back().values["matrix"] = markdown_code(matrix.name);
    gaps.back().values["share"] =
        format_count(matrix.present) + " of " + format_count(matrix.planned);
    gaps.back().values["methods"] = names;
    gaps.back().values["command"] = markdown_code("vislab run " + matrix.name);
  }
  return gaps;
}

/// One row for each sweep that a method of the family took part in.
std::vector<Fields> break_rows(const ReportInput& input, const std::string& family) {
  std::vector<Fields> rows;
  for (const SweepResult& result : input.sweeps) {
    std::string breaks;
    std::string holds;
    std::string open;
    for (const SweepVerdict& verdict : result.verdicts) {
      if (!verdict.was_measured()) continue;
      if (family_of_stage(last_name(verdict.culler), input.cullers) != family) continue;
      std::string& list = verdict.break_point ? breaks : verdict.is_complete ? holds : open;
      list += (list.empty() ? "" : "; ") + (verdict.break_point ? break_of(result.sweep, verdict)
                                                                : markdown_code(verdict.culler));
    }
    if (breaks.empty() && holds.empty() && open.empty()) continue;
    Fields row;
    row.values["failure"] = markdown_text(result.sweep.failure);
    row.values["sweep"] = markdown_text(result.sweep.name);
    row.values["dial"] = markdown_text(result.sweep.dial.name);
    row.values["breaks"] = breaks.empty() ? "–" : breaks;
    row.values["holds"] = holds.empty() ? "–" : holds;
    if (!open.empty()) row.values["holds"] += " (not all values were measured of " + open + ")";
    rows.push_back(std::move(row));
  }
  return rows;
}

/// On how many of the drawn blocks a method without errors saves time beyond the noise, and where
/// most; empty if nothing was drawn.
std::string saving_sentence(const std::vector<BlockSummary>& blocks,
                            const std::vector<std::pair<const BlockSummary*, FamilyOn>>& on) {
  std::size_t drawn = 0;
  std::size_t saving = 0;
  const BlockSummary* most_block = nullptr;
  const FamilyMethod* most = nullptr;
  for (const auto& [block, found] : on) {
    if (!block->drawn || found.best == nullptr) continue;
    ++drawn;
    if (!saves_time(*block, *found.best)) continue;
    ++saving;
    if (most == nullptr || found.best->ratio.value < most->ratio.value) {
      most = found.best;
      most_block = block;
    }
  }
  if (drawn == 0) return {};
  std::string text = "On " + std::to_string(saving) + " of the " + std::to_string(drawn) +
                     " scenes and paths that were drawn and have a method of this family "
                     "without errors, one saves more than the noise of the time that drawing takes "
                     "without it";
  if (most == nullptr) return text + ".";
  text += "; most on " + place_of(blocks, *most_block) + ", where " +
          markdown_code(most->cell->culler) + " saves " + format_percent(1.0 - most->ratio.value);
  if (most->before == nullptr) return text + " of the frame.";
  return text + " of what " + markdown_code(most->against()) + " alone takes.";
}

/// Pictures of the family's best method on the block of its first chart, and of the method with the
/// most false pixels anywhere.
void add_pictures(const ReportInput& input, const BlockSummary* charted,
                  const std::vector<std::pair<const BlockSummary*, FamilyOn>>& on,
                  const std::string& family, const std::filesystem::path& work, Fields& fields) {
  auto& pictures = fields.lists["pictures"];
  auto& missing = fields.lists["pictures_missing"];
  if (!input.picture) return;
  std::vector<std::pair<const BlockSummary*, const CellSummary*>> wanted;
  const BlockSummary* worst_block = nullptr;
  const CellSummary* worst = nullptr;
  for (const auto& [block, found] : on) {
    if (block == charted && found.best != nullptr) wanted.emplace_back(block, found.best->cell);
    if (found.worst == nullptr) continue;
    if (worst == nullptr || found.worst->false_px > worst->false_px) {
      worst = found.worst;
      worst_block = block;
    }
  }
  if (worst != nullptr) wanted.emplace_back(worst_block, worst);
  for (const auto& [block, cell] : wanted) {
    const std::string file =
        "family-" + family + "-" + std::to_string(pictures.size() + 1) + ".png";
    Fields entry;
    entry.values["method"] = markdown_code(cell->culler);
    try {
      entry.values["caption"] = markdown_text(input.picture(*block, *cell, work / file));
      entry.values["file"] = file;
      pictures.push_back(std::move(entry));
    } catch (const InputError& error) {
      entry.values["reason"] = markdown_text(error.what());
      missing.push_back(std::move(entry));
    }
  }
}

Fields chapter_fields(const ReportInput& input, const std::vector<const BlockSummary*>& in_diagrams,
                      const std::vector<FamilyChart>& charts, const std::string& family,
                      const std::filesystem::path& work) {
  Fields fields;
  fields.values["family"] = markdown_text(family);
  auto& methods = fields.lists["family_methods"];
  if (input.cullers != nullptr) {
    for (const auto& [name, entry] : input.cullers->entries()) {
      if (entry.info.family == family) methods.push_back(method_row(entry.info));
    }
  }
  fields.flag("has_family_methods", !methods.empty());
  const BlockSummary* charted = nullptr;
  auto& figures = fields.lists["family_charts"];
  for (const FamilyChart& chart : charts) {
    if (chart.family != family) continue;
    if (charted == nullptr) charted = chart.block;
    figures.emplace_back();
    figures.back().values["place"] = place_of(input.blocks, *chart.block);
    figures.back().values["file"] = chart.file;
    figures.back().values["x_meaning"] =
        has_time_axis(*chart.block) ? "median time of a frame" : "triangles submitted per frame";
  }
  std::vector<std::pair<const BlockSummary*, FamilyOn>> on;
  auto& best = fields.lists["family_best"];
  std::map<std::string, std::size_t> of_scene;  // places in `on`
  for (const BlockSummary& block : input.blocks) {
    if (is_in(in_diagrams, block)) continue;
    FamilyOn found = family_on(block, family, input.cullers);
    if (found.methods.empty()) continue;
    const auto [known, is_new] = of_scene.emplace(block.scene, on.size());
    if (!is_new && tells_more(found, block, on[known->second].second, *on[known->second].first)) {
      known->second = on.size();
    }
    on.emplace_back(&block, std::move(found));
  }
  std::set<std::size_t> shown;
  for (const auto& [scene, place] : of_scene) shown.insert(place);
  for (const std::size_t i : shown) {
    best.push_back(best_row(input.blocks, *on[i].first, on[i].second));
  }
  fields.flag("has_family_best", !best.empty());
  fields.lists["matrix_gaps"] = matrix_gaps(input, family);
  fields.values["saving"] = saving_sentence(input.blocks, on);
  add_stability_fields(input, in_diagrams, family, fields);
  fields.lists["family_breaks"] = break_rows(input, family);
  fields.flag("has_family_breaks", !fields.lists["family_breaks"].empty());
  fields.values["sweeps_not_run"] = sweeps_not_run(input, family);
  fields.flag("has_sweeps_of_family",
              !fields.lists["family_breaks"].empty() || !fields.values["sweeps_not_run"].empty());
  add_pictures(input, charted, on, family, work, fields);
  return fields;
}

}  // namespace

FamilyTexts family_texts(const std::filesystem::path& templates, const Fields& fields) {
  std::set<std::filesystem::path> files;
  for (const auto& family : std::filesystem::directory_iterator(templates)) {
    if (!family.is_directory()) continue;
    for (const auto& file : std::filesystem::directory_iterator(family.path())) {
      if (file.path().extension() == ".md") files.insert(file.path());
    }
  }
  FamilyTexts texts;
  for (const std::filesystem::path& file : files) {
    const std::string text = fill_template(read_template(file), fields, file.string());
    if (text.find_first_not_of(" \n") == std::string::npos) continue;
    texts[file.parent_path().filename().string()] += text + "\n";
  }
  return texts;
}

std::vector<std::string> measured_families(const ReportInput& input,
                                           const std::vector<std::string>& order,
                                           const FamilyTexts& texts) {
  std::set<std::string> found;
  for (const auto& [family, text] : texts) found.insert(family);
  for (const std::vector<BlockSummary>* blocks : {&input.blocks, &input.sweep_blocks}) {
    for (const BlockSummary& block : *blocks) {
      for (const CellSummary& cell : block.cells) {
        if (cell.anchor) continue;
        const std::vector<CullerSpec> chain = parse_chain(cell.canonical);
        if (chain.empty() || is_left_out(chain.back().name, input.cullers)) continue;
        found.insert(family_of_stage(chain.back().name, input.cullers));
      }
    }
  }
  std::vector<std::string> families;
  for (const std::string& family : order) {
    if (found.erase(family) > 0) families.push_back(family);
  }
  families.insert(families.end(), found.begin(), found.end());
  return families;
}

std::vector<FamilyChart> family_charts(const ReportInput& input,
                                       const std::vector<const BlockSummary*>& in_diagrams,
                                       const std::vector<std::string>& families) {
  std::vector<FamilyChart> charts;
  for (const std::string& family : families) {
    using Score = std::pair<std::size_t, double>;  // points, and how much the family saves at best
    std::vector<std::pair<Score, const BlockSummary*>> scored;
    for (const BlockSummary& block : input.blocks) {
      if (is_in(in_diagrams, block)) continue;
      const FamilyOn on = family_on(block, family, input.cullers);
      std::vector<const CellSummary*> cells;
      for (const CellSummary* cell : charted_cells(block)) {
        if (is_among(on, *cell)) cells.push_back(cell);
      }
      if (cells.empty()) continue;
      std::set<std::size_t> on_curves;
      for (const DialCurve& curve : dial_curves(cells)) {
        on_curves.insert(curve.cells.begin(), curve.cells.end());
      }
      const double saving = on.best == nullptr || !on.best->ratio.measured()
                                ? -std::numeric_limits<double>::infinity()
                                : -on.best->ratio.value;
      scored.emplace_back(Score(cells.size() + on_curves.size(), saving), &block);
    }
    std::ranges::stable_sort(scored, std::greater<>{},
                             [](const auto& entry) { return entry.first; });
    std::set<std::string> scenes;
    for (const auto& [score, block] : scored) {
      if (scenes.size() == charts_a_family || !scenes.insert(block->scene).second) continue;
      charts.push_back(
          {family, block, "family-" + family + "-" + std::to_string(scenes.size()) + ".svg"});
    }
  }
  return charts;
}

std::string family_chart_script(const std::vector<FamilyChart>& charts, const Registry* cullers) {
  std::string script;
  for (const FamilyChart& chart : charts) {
    const FamilyOn on = family_on(*chart.block, chart.family, cullers);
    script += chart_script(*chart.block, chart.file, [&](const CellSummary& cell) {
      return is_among(on, cell) ||
             std::ranges::find(on.methods, &cell, &FamilyMethod::before) != on.methods.end();
    });
  }
  return script;
}

void add_family_fields(const ReportInput& input,
                       const std::vector<const BlockSummary*>& in_diagrams,
                       const std::vector<FamilyChart>& charts,
                       const std::vector<std::string>& families, const FamilyTexts& texts,
                       const std::filesystem::path& templates, const std::filesystem::path& work,
                       Fields& fields) {
  auto& chapters = fields.lists["families"];
  const std::filesystem::path measured = templates / "measured.md";
  for (const std::string& family : families) {
    Fields chapter = chapter_fields(input, in_diagrams, charts, family, work);
    const auto text = texts.find(family);
    chapter.values["sections"] = text == texts.end() ? "" : text->second;
    chapter.values["measurements"] =
        fill_template(read_template(measured), chapter, measured.string());
    std::filesystem::path file = templates / (family + ".md");
    if (!std::filesystem::exists(file)) file = templates / "generic.md";
    Fields entry;
    entry.values["chapter"] = fill_template(read_template(file), chapter, file.string());
    chapters.push_back(std::move(entry));
  }
}

}  // namespace vislab
