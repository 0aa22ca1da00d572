#include "report/report.h"

#include <iostream>

#include "common/scene/error.h"
#include "experiments/show/frame_picture.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

int report(const Lab& lab, const std::filesystem::path& results,
           const std::filesystem::path& output) {
  ReportInput input;
  input.blocks = summarise(require_present_cells(results, lab.cullers));
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
