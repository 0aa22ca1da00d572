// The report's section on occlusion queries.
#pragma once

#include "report/query_findings.h"
#include "report/template.h"

namespace vislab {

/// Adds the fields of templates/queries.md: what each method that asks the device asked a frame,
/// and what was found before. Blocks that a phase diagram speaks of have no rows of their own.
/// Charts are expected under the names of query_findings.h. Without such
/// a method the section is empty.
void add_query_fields(const ReportInput& input, const QueryFindings& findings, Fields& fields);

}  // namespace vislab
