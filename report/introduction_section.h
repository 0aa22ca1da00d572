// What the report's introduction is filled with: where each method stands in the taxonomy, and a
// frame in which the kinds of culling are marked.
#pragma once

#include <filesystem>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// The list "taxonomy": methods of one family that decide in the same space at the same stage about
/// the same things with the same promise share a row. From the declarations of all registered
/// methods. The list "kinds_pictures": at most one, of the first blocks that have what the most
/// kinds of culling need; "kinds_missing" says why there is none. Writes it into `work`.
void add_introduction_fields(const ReportInput& input,
                             const std::vector<const BlockSummary*>& in_diagrams,
                             const std::filesystem::path& work, Fields& fields);

}  // namespace vislab
