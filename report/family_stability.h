// What a family's methods do over time: what flickers, pops up late, and how late.
#pragma once

#include <string>
#include <vector>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// The list "over_time", a row for each scene and path, and each sweep over all values of its dial,
/// on which a method of the family flickered, popped or was late, with the method that did most of
/// each: sweeps that are held to one of these first, then by what popped; a dozen at most. The
/// values "over_time_runs" and "over_time_quiet" count the cells looked at and those without any of
/// it, "over_time_more" the rows that were too many. Methods that are wrong on purpose are not
/// looked at, nor blocks `in_diagrams`, nor paths of one frame.
void add_stability_fields(const ReportInput& input,
                          const std::vector<const BlockSummary*>& in_diagrams,
                          const std::string& family, Fields& fields);

}  // namespace vislab
