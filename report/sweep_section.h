// The report's section on stress sweeps: where methods break.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/break_points.h"
#include "report/template.h"

namespace vislab {

/// One entry for each sweep that was measured, for templates/sweeps.md. Charts are expected under
/// sweep_chart_file_name().
std::vector<Fields> sweep_fields(const std::vector<SweepResult>& sweeps);

/// Name of the chart of the sweep with that index: "sweep-1.svg".
std::string sweep_chart_file_name(std::size_t sweep);

}  // namespace vislab
