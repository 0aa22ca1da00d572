// The report's sections that put methods beside each other across scenes.
#pragma once

#include <filesystem>
#include <vector>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// One entry for each kind of culling with enough methods, for templates/chains.md.
std::vector<Fields> guide_fields(const std::vector<BlockSummary>& blocks);

/// Methods that paint an image themselves, for templates/families/surface/images.md. Pictures of
/// the most telling scenes go into `folder`.
void add_surface_fields(const ReportInput& input, const std::filesystem::path& folder,
                        Fields& fields);

/// One entry for each machine and figure of the table of costs, for templates/measurement.md.
std::vector<Fields> cost_fields(const std::vector<BlockSummary>& blocks);
/// Timed cells without such a table.
std::size_t count_uncalibrated(const std::vector<BlockSummary>& blocks);

}  // namespace vislab
