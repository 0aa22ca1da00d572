// The report's section on occlusion queries.
#pragma once

#include <filesystem>

#include "report/query_findings.h"
#include "report/template.h"

namespace vislab {

/// Adds the fields of templates/families/occlusion/queries.md: what each method that asks the
/// device asked a frame, what was found before, and pictures of frames, written into `folder`.
/// Blocks that a phase diagram speaks of have no rows of their own. Charts are expected under the
/// names of query_findings.h. Without such a method the section is empty.
void add_query_fields(const ReportInput& input, const QueryFindings& findings,
                      const std::filesystem::path& folder, Fields& fields);

}  // namespace vislab
