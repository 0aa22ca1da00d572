// The report's section on methods that go from cell to cell.
#pragma once

#include <filesystem>
#include <vector>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Adds the fields of templates/families/portal/walks.md: what each method that knows of cells did
/// a frame, scene by scene, and for each scene a plan with the one that is right and submits the
/// fewest triangles, written into `folder`; and what the sets of whole cells miss, hold too much
/// and take, of methods that have any. Methods are told by their counters. Without one that was
/// ever in a cell or has sets the section is empty.
void add_cell_fields(const ReportInput& input, const std::filesystem::path& folder, Fields& fields);

}  // namespace vislab
