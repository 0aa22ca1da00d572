// The report's section on stress sweeps: where methods break.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/break_points.h"
#include "report/template.h"

namespace vislab {

/// For templates/sweeps.md: an entry for each sweep that was measured and in which something broke,
/// came out unlike predicted or is missing, and a row for each of the others. Charts are expected
/// under sweep_chart_file_name().
void add_sweep_fields(const std::vector<SweepResult>& sweeps, Fields& fields);

/// Has the sweep an entry, with a chart?
bool is_shown(const SweepResult& sweep);

/// A value of a dial with its unit, as Markdown: "10⁻⁶ rad".
std::string dial_text(const SweepDial& dial, std::size_t value);

/// Name of the chart of the sweep with that index: "sweep-1.svg".
std::string sweep_chart_file_name(std::size_t sweep);

}  // namespace vislab
