// The report's part on the scenes: of each what tells most, and a row for every other run on it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "report/device_fits.h"
#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// A scene's blocks, as places in the blocks of the input.
struct ShownScene {
  std::size_t block = 0;            // has a chart, tables and pictures
  std::vector<std::size_t> others;  // have a row each, ascending
};

/// One for each scene, in the order of its first block. Shown is the block with most methods that
/// were judged and timed, those on a common axis of time counting twice; of equals the one with
/// most frames, then with most pixels, then the first. Blocks `in_diagrams` are left out.
std::vector<ShownScene> shown_scenes(const std::vector<BlockSummary>& blocks,
                                     const std::vector<const BlockSummary*>& in_diagrams);

/// An entry of templates/scenes.md. Pictures go into `folder`; the chart of the block is expected
/// there under chart_file_name(). `verdict_template` is the text of verdict.md.
Fields scene_fields(const ReportInput& input, const ShownScene& scene, const DeviceFits& fits,
                    const std::string& verdict_template, const std::filesystem::path& folder);

}  // namespace vislab
