#include "report/report.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>

#include "common/scene/error.h"
#include "report/cell_section.h"
#include "report/chains_section.h"
#include "report/chart.h"
#include "report/claims_section.h"
#include "report/errata_section.h"
#include "report/family_section.h"
#include "report/introduction_section.h"
#include "report/main_chart.h"
#include "report/method_fields.h"
#include "report/model_size_section.h"
#include "report/page.h"
#include "report/persistence_section.h"
#include "report/process.h"
#include "report/query_section.h"
#include "report/scene_section.h"
#include "report/sections.h"
#include "report/summary_section.h"
#include "report/sweep_chart.h"
#include "report/sweep_section.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

const Program gnuplot{"gnuplot", "gnuplot-nox"};
constexpr std::chrono::seconds time_limit{600};
constexpr const char* persistence_file = "persistence.json";

/// The report's parts in their order; each is templates/NAME.md, and is left out where there is no
/// such file.
constexpr const char* parts[] = {"front",       "introduction", "floor",      "depth",
                                 "persistence", "families",     "scenes",     "chains",
                                 "model_size",  "sweeps",       "claims",     "errata",
                                 "methods",     "metrics",      "measurement"};

/// A folder for work in progress, gone with this object.
class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (fs::temp_directory_path() / "vislab-report-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw InputError("no temporary folder can be made in " + fs::temp_directory_path().string());
    }
    path_ = name;
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// One name a line.
std::vector<std::string> read_names(const fs::path& file) {
  std::istringstream lines(read_template(file));
  std::vector<std::string> names;
  for (std::string name; lines >> name;) names.push_back(name);
  return names;
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw InputError(file.string() + " cannot be written");
}

using DrawPicture = decltype(ReportInput::picture);

/// Several parts may show the same picture: it is drawn once, and copied. Threads may ask at the
/// same time.
DrawPicture drawn_once(const DrawPicture& draw) {
  struct Drawn {
    std::once_flag once;
    std::string caption, error;
    fs::path file;
  };
  struct All {
    std::mutex mutex;  // of the map, not of what it holds
    std::map<std::string, Drawn> drawn;
  };
  if (!draw) return draw;
  const auto all = std::make_shared<All>();
  return [all, draw](const BlockSummary& block, const CellSummary& cell, const fs::path& file) {
    Drawn* found = nullptr;
    {
      const std::scoped_lock lock(all->mutex);
      found = &all->drawn[block.scene_hash + block.path_hash + cell.id];
    }
    Drawn& drawn = *found;
    std::call_once(drawn.once, [&] {
      drawn.file = file;
      try {
        drawn.caption = draw(block, cell, file);
      } catch (const InputError& error) {
        drawn.error = error.what();
      }
    });
    if (!drawn.error.empty()) throw InputError(drawn.error);
    if (drawn.file != file) fs::copy_file(drawn.file, file, fs::copy_options::overwrite_existing);
    return drawn.caption;
  };
}

void draw_charts(const ReportInput& input, const QueryFindings& queries,
                 const std::vector<PersistenceRow>& persistence,
                 const std::vector<FamilyChart>& of_families, const fs::path& work) {
  std::string script = family_chart_script(of_families, input.cullers);
  for (const ShownScene& scene : shown_scenes(input.blocks, queries.diagram_blocks())) {
    const BlockSummary& block = input.blocks[scene.block];
    if (charted_cells(block).empty()) continue;
    script += chart_script(block, chart_file_name(scene.block));
  }
  for (std::size_t i = 0; i < input.sweeps.size(); ++i) {
    if (!is_shown(input.sweeps[i]) || !has_sweep_chart(input.sweeps[i])) continue;
    script += sweep_chart_script(input.sweeps[i], sweep_chart_file_name(i));
  }
  if (!persistence.empty()) {
    script += persistence_chart_script(persistence, persistence_chart_file);
  }
  script += size_charts_script(input.sizes);
  script += query_chart_script(queries);
  if (has_main_chart(input.blocks)) script += main_chart_script(input.blocks, main_chart_file);
  if (script.empty()) return;
  write_text(work / "charts.gnuplot", script);
  run_program(gnuplot, {"charts.gnuplot"}, work, time_limit);
}

void write_words(const ReportInput& input, const QueryFindings& queries,
                 const std::vector<PersistenceRow>& persistence,
                 const std::vector<FamilyChart>& of_families, const fs::path& templates,
                 const fs::path& work) {
  const fs::path folder = templates / "templates";
  Fields fields =
      report_fields(input, read_template(folder / "verdict.md"), queries.diagram_blocks(), work);
  add_persistence_fields(persistence, fields);
  add_query_fields(input, queries, work, fields);
  add_cell_fields(input, work, fields);
  add_model_size_fields(input.sizes, fields);
  add_chain_fields(input, fields);
  add_claim_fields(input, fields);
  add_errata_fields(input, work, fields);
  add_summary_fields(input, fields);
  add_introduction_fields(input, queries.diagram_blocks(), work, fields);
  const FamilyTexts texts = family_texts(folder / "families", fields);
  const std::vector<std::string> families =
      measured_families(input, read_names(folder / "families" / "order.txt"), texts);
  add_family_fields(input, queries.diagram_blocks(), of_families, families, texts,
                    folder / "families", work, fields);
  cite_sources(read_template(templates / "bibliography.bib"), fields.lists["methods"]);
  std::string text;
  for (const std::string part : parts) {
    const fs::path file = folder / (part + ".md");
    if (!fs::exists(file)) continue;
    text += fill_template(read_template(file), fields, file.string()) + "\n";
  }
  write_text(work / "report.md", text);
  const fs::path summary = folder / "summary.md";
  write_text(work / "summary.md", fill_template(read_template(summary), fields, summary.string()));
}

/// Copies the files beside their final names before any is renamed.
void publish(const fs::path& work, const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  std::vector<std::string> names{"index.html", "report.pdf"};
  const std::string temporary = "." + std::to_string(::getpid()) + ".tmp";  // of no other report
  const auto unwritable = [&] {
    std::error_code ignored;
    for (const std::string& name : names) fs::remove(folder / (name + temporary), ignored);
    return InputError("the report cannot be written to " + folder.string() + ": " + code.message() +
                      "; name another folder with -o");
  };
  if (code) throw unwritable();
  if (fs::exists(work / persistence_file)) names.emplace_back(persistence_file);
  if (fs::exists(work / main_chart_file)) names.emplace_back(main_chart_file);
  for (const std::string& name : names) {
    fs::copy_file(work / name, folder / (name + temporary), fs::copy_options::overwrite_existing,
                  code);
    if (code) throw unwritable();
  }
  for (const std::string& name : names) {
    fs::rename(folder / (name + temporary), folder / name, code);
    if (code) throw unwritable();
  }
}

}  // namespace

void write_report(const ReportInput& given, const fs::path& template_folder,
                  const fs::path& folder) {
  ReportInput input = given;
  input.picture = drawn_once(given.picture);
  const bool no_sweep =
      std::ranges::none_of(input.sweeps, [](const SweepResult& s) { return s.was_measured(); });
  if (input.blocks.empty() && no_sweep &&
      std::ranges::none_of(input.sizes, &SizeResult::was_measured)) {
    throw InputError("there is nothing to report; measure something with 'vislab run' first");
  }
  const WorkFolder work;
  const QueryFindings queries = find_queries(input);
  const std::vector<PersistenceRow> persistence = persistence_rows(input, queries.diagram_blocks());
  const std::vector<FamilyChart> of_families =
      family_charts(input, queries.diagram_blocks(), measured_families(input, {}, {}));
  // gnuplot draws the charts while the pictures are painted here.
  std::future<void> charts = std::async(std::launch::async, [&] {
    draw_charts(input, queries, persistence, of_families, work.path());
  });
  write_words(input, queries, persistence, of_families, template_folder, work.path());
  if (!persistence.empty()) write_text(work.path() / persistence_file, to_json(persistence));
  charts.get();
  make_page(template_folder, work.path());
  publish(work.path(), folder);
}

}  // namespace vislab
