// The sheet in front of the report: the main findings on one page.
#pragma once

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Name of the chart that the sheet shows.
constexpr const char* main_chart_file = "main-chart.svg";

/// Adds what templates/summary.md asks for. Lists are cut to what fits on a page, and say so.
void add_summary_fields(const ReportInput& input, Fields& fields);

}  // namespace vislab
