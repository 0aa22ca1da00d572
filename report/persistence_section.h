// The section on how long hidden things stay hidden, beside the formula of the lecture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/analysis/persistence.h"
#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Points of fewer cases are left out of the chart and of what is concluded.
inline constexpr std::uint64_t least_persistence_cases = 20;

/// Counts of each scene and path on which a method was measured that builds on what was hidden
/// before (occlusion.chc and its kin), each once: where it was measured in several ways, the block
/// with the most frames, then the most pixels. Those whose scene is no longer what was measured are
/// left out, and so are the blocks in `left_out`. Truth of all frames is read: about 10 ms a frame.
std::vector<PersistenceRow> persistence_rows(const ReportInput& input,
                                             const std::vector<const BlockSummary*>& left_out);

/// Adds the fields of templates/persistence.md. Without rows, the section stays away.
void add_persistence_fields(const std::vector<PersistenceRow>& rows, Fields& fields);

/// Name of the chart in the report's folder.
inline constexpr const char* persistence_chart_file = "persistence.svg";

/// gnuplot commands that draw p(t) over t into `file` (SVG): a panel a scene, a line a path, the
/// formula dashed in all. The axis of p is logarithmic in 1 - p.
std::string persistence_chart_script(const std::vector<PersistenceRow>& rows,
                                     const std::filesystem::path& file);

}  // namespace vislab
