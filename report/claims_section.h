// The report's section on the sources' claims: each with its verdict and the figures.
#pragma once

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Adds what templates/claims.md asks for, and the counts that the summary does. Of a source of
/// which most claims were not run these are counted only; else they stand in the table as gaps.
/// Where no claim of any source was measured, the section is left out.
void add_claim_fields(const ReportInput& input, Fields& fields);

}  // namespace vislab
