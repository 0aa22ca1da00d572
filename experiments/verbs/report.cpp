#include "report/report.h"

#include <iostream>
#include <tuple>

#include "common/scene/error.h"
#include "experiments/show/frame_picture.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/sweep_results.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

int report(const Lab& lab, const std::filesystem::path& results,
           const std::filesystem::path& output) {
  const std::vector<JudgedCell> cells = require_present_cells(results, lab.cullers);
  ReportInput input;
  std::tie(input.blocks, input.sweep_blocks) = split_sweeps(lab, summarise(cells), results);
  input.sweeps = sweep_results(lab, results, cells);
  input.published = load_published(lab.published, lab.cullers);
  input.cullers = &lab.cullers;
  StoredPictures pictures(results, lab.data);
  input.picture = [&](const BlockSummary& block, const CellSummary& cell,
                      const std::filesystem::path& file) {
    return pictures.write(block, cell, file);
  };
  write_report(input, lab.report, output);
  std::cerr << "wrote " << (output / "index.html").string() << " and "
            << (output / "report.pdf").string() << '\n';
  return 0;
}

}  // namespace vislab
