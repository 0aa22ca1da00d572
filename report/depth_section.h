// The section on how much lies one behind the other in the scenes.
#pragma once

#include <filesystem>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Adds the fields of templates/depth.md: a row for each scene, on the path that is
/// shown of it, and a heat map,
/// written into `folder`, of the one with the greatest mean by rays. Blocks in `left_out` and
/// scenes that are no longer what was measured are left out; without any, the section says so.
void add_depth_fields(const ReportInput& input, const std::vector<const BlockSummary*>& left_out,
                      const std::filesystem::path& folder, Fields& fields);

}  // namespace vislab
