// The fields that fill the report's templates.
#pragma once

#include <filesystem>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Fields for all templates of the report. Writes the pictures of the blocks into `folder`; charts
/// are expected there under chart_file_name(). `verdict_template` is the text of verdict.md. The
/// blocks `in_diagrams` only serve as cells of a diagram, so they have no sections of their own.
Fields report_fields(const ReportInput& input, const std::string& verdict_template,
                     const std::vector<const BlockSummary*>& in_diagrams,
                     const std::filesystem::path& folder);

/// The scene's name, with path, resolution and device where several blocks share it.
std::string title_of(const std::vector<BlockSummary>& blocks, const BlockSummary& block);

/// "5", or "3–5" where cells differ.
std::string rounds_of(const BlockSummary& block);

/// Name of the chart of the block with that index: "chart-1.svg".
std::string chart_file_name(std::size_t block);

}  // namespace vislab
