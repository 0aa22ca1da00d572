// The report: one self-contained HTML page and the same as PDF, written from stored results.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/break_points.h"
#include "experiments/analysis/errata.h"
#include "experiments/analysis/knees.h"
#include "experiments/analysis/matrix_share.h"
#include "experiments/analysis/persistence.h"
#include "experiments/analysis/published.h"
#include "experiments/analysis/summary.h"
#include "experiments/show/depth_complexity_picture.h"
#include "experiments/show/kinds_picture.h"
#include "experiments/show/query_pictures.h"

namespace vislab {

/// A gap in the results.
struct MissingCell {
  std::string name;  // the culler's short name, or the block's title
  std::string reason;
};

/// What its functions draw and measure is asked for by several threads at once.
struct ReportInput {
  std::vector<BlockSummary> blocks;
  /// Blocks of stress sweeps, which stand in the sections on break points and wrong methods only.
  std::vector<BlockSummary> sweep_blocks;
  std::vector<SweepResult> sweeps;
  std::vector<SizeResult> sizes;  // size sweeps, whose blocks are in neither
  std::vector<PublishedFigures> published;
  std::vector<Erratum> errata;
  const Registry* cullers = nullptr;  // for the method pages
  /// Writes a picture of a block's most telling frame under a culler to `file` (PNG), as `vislab
  /// show` does; returns a caption. Empty function: no pictures.
  std::function<std::string(const BlockSummary& block, const CellSummary& cell,
                            const std::filesystem::path& file)>
      picture;
  /// Writes a picture of the images that a block's hidden-surface algorithms painted, beside
  /// truth's, to `file` (PNG); returns a caption. Empty function: no pictures.
  std::function<std::string(const BlockSummary& block, const std::filesystem::path& file)>
      surface_picture;
  /// Writes a plan of a scene's cells with what a method that goes from cell to cell reached and
  /// kept in a telling frame to `file` (PNG); returns the place: scene, path, method and frame.
  /// Throws InputError if the scene is no longer there or has no cells. Empty function: no plans.
  std::function<std::string(const BlockSummary& block, const CellSummary& cell,
                            const std::filesystem::path& file)>
      plan;
  /// Measures the depth complexity of a block's frame after a third of its path by all definitions,
  /// and writes a heat map by rays to `file` unless that is empty. Empty function: no section on
  /// it.
  std::function<DepthComplexityTable(const BlockSummary& block, const std::filesystem::path& file)>
      depth_complexity;
  /// Counts how long hidden objects stayed hidden on a block's path. Throws InputError if its scene
  /// or its truth is no longer there. Empty function: no section on it.
  std::function<PersistenceCounts(const BlockSummary& block)> persistence;
  /// Writes a picture of what methods had the device do in one frame of a block to `file` (PNG), a
  /// row a cell; returns the place: scene, path, frame and device. Throws InputError if the scene
  /// is no longer there or a method asked nothing in that frame. Empty function: no pictures.
  std::function<std::string(const BlockSummary& block, const std::vector<const CellSummary*>& cells,
                            QueryPicture picture, const std::filesystem::path& file)>
      query_picture;
  /// The measured share of what lies in the frustum of a block's frames that is hidden. Throws
  /// InputError if its scene or its truth is no longer there. Empty function: no phase diagrams.
  std::function<double(const BlockSummary& block)> hidden_share;
  /// Writes a picture of one frame of a block, every triangle in the colour of the kind of culling
  /// that leaves it out, to `file` (PNG). Throws InputError if its scene or its truth is no longer
  /// there. Empty function: no picture.
  std::function<KindsPicture(const BlockSummary& block, const std::filesystem::path& file)>
      kinds_picture;
  /// What was to be measured on the block and is not in the results. Empty function: nothing is
  /// known of that.
  std::function<std::vector<MissingCell>(const BlockSummary& block)> missing_cells;
  /// Blocks of which no cell is in the results though their matrix was run.
  std::vector<MissingCell> missing_blocks;
  /// The matrices that were run.
  std::vector<MatrixShare> matrices;
  /// A cell's frame_ms by frame, each the median of its rounds. Throws InputError if the cell is no
  /// longer there. Empty function: no chart of them.
  std::function<std::vector<double>(const CellSummary& cell)> frame_times;
};

/// Writes index.html, report.pdf, the chart of all families (main-chart.svg, if anything was drawn)
/// and, if hidden things were counted, persistence.json into `folder` (made if missing). They
/// appear only when whole. Runs pandoc, gnuplot and chromium; throws InputError that names the
/// program that is missing or failed, or if there is nothing to report. `template_folder` is the
/// repository's report/.
void write_report(const ReportInput& input, const std::filesystem::path& template_folder,
                  const std::filesystem::path& folder);

}  // namespace vislab
