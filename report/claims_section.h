// The report's section on the sources' claims: each with its verdict and the figures.
#pragma once

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Adds what templates/claims.md asks for, and the counts that the summary does. A source of which
/// nothing was measured is named without its rows; without any the section is left out.
void add_claim_fields(const ReportInput& input, Fields& fields);

}  // namespace vislab
