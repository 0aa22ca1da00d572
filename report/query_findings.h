// What the report says of methods that ask the device, found in the blocks before anything is
// drawn.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/line_chart.h"
#include "report/phase_diagram.h"
#include "report/query_picture_choice.h"
#include "report/report.h"

namespace vislab {

/// Frame times of the same method with aligned and with randomised re-tests of what is visible.
struct RetestPair {
  std::string title;                          // scene, path and device
  std::string method;                         // with randomised re-tests
  std::vector<double> aligned_ms, random_ms;  // by frame
  // Without the first quarter of the path, in which everything is new.
  double aligned_deviation_ms = 0.0, random_deviation_ms = 0.0;  // standard deviations
  double aligned_worst_ms = 0.0, random_worst_ms = 0.0;
};

/// Queries a second of the frame's whole time by the size of bunches: lines of all methods, scenes
/// and paths that were measured with several sizes on one device.
struct BunchChart {
  std::string device;
  LineChart chart;
};

struct QueryFindings {
  std::vector<PhaseDiagram> phases;
  std::vector<RetestPair> retests;
  /// The pair of each title that differs most; a few of them, the greatest difference first.
  std::vector<std::size_t> charted_retests;
  std::vector<BunchChart> bunches;  // in the blocks' order
  std::vector<QueryPictureChoice> pictures;

  /// The blocks that phase diagrams speak of. They are too many for sections and rows of their own.
  std::vector<const BlockSummary*> diagram_blocks() const;
};

QueryFindings find_queries(const ReportInput& input);

/// gnuplot commands for all charts of the section; files are named by the functions below.
std::string query_chart_script(const QueryFindings& findings);
std::string phase_file_name(std::size_t phase);    // "phases-1.svg"
std::string retest_file_name(std::size_t retest);  // "retests-1.svg"
std::string bunch_file_name(std::size_t chart);    // "bunches-1.svg"

}  // namespace vislab
