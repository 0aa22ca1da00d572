// Figures that the sources print, beside which the lab sets its own: TOML files of facts.
//
//   title = "Thesis, tables 5.2 to 5.9"
//   source = "Kowalka 2016"
//   note = "…"                     what is known to be odd about the figures
//   [[row]]
//   what = "mixed scene, camera moving"
//   table = "5.2"
//   without_fps = 58.92            frames a second without culling (or of what `against` stands
//   with_fps = 66.21               for), and with; or instead of both
//   published = "1.4, at most 3"   the ratio without ÷ with as the source words it
//   metric = "frame_ms"            what stands for it here: a ratio of frame_ms or of cull_us; or
//                                  a share: culled (of all triangles), or decision_share (of
//                                  frame_ms that goes into update and cull)
//   scene = "mixed"                of this scene, path ("" or left out: any path)
//   path = "mixed_moving"
//   culler = "frustum.two_step"    and method
//   against = "none"               what it is compared with; none if left out. Not for shares
//   cannot_be_told = "…"           instead of metric, scene, path, culler and against: why nothing
//                                  here can stand beside the figure
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/summary.h"

namespace vislab {

struct PublishedRow {
  std::string what, table;
  double without_fps = 0.0, with_fps = 0.0;
  std::string scene, path;
  std::string culler, against;                        // canonical
  std::string short_culler = {}, short_against = {};  // the same as tables show them
  std::string published = {};                         // instead of frames a second
  enum class Metric { frame_ms, cull_us, culled, decision_share } metric = Metric::frame_ms;
  std::string cannot_be_told = {};  // if not empty, the row has no figure of ours

  bool is_share() const { return metric == Metric::culled || metric == Metric::decision_share; }

  /// How many times as many frames a second as without; not with `published`.
  double ratio() const { return with_fps / without_fps; }
};

struct PublishedFigures {
  std::string title, source, note;
  std::vector<PublishedRow> rows;
};

/// All files of the folder, by name; empty if there is no such folder. Throws InputError that names
/// file, line or key, and what would be right.
std::vector<PublishedFigures> load_published(const std::filesystem::path& folder,
                                             const Registry& registry);

/// The block and the cell that stand for a row; null where they were not measured.
struct OwnFigure {
  const BlockSummary* block = nullptr;
  const CellSummary* cell = nullptr;
  /// A share, without an interval; or the row's metric of `against` / that of the culler. frame_ms
  /// against none is paired by frame and round; else it is the quotient of two such ratios, or of
  /// the medians of cull_us, with the widest interval that they allow.
  Estimate ratio = Estimate::none();
};

/// Of several blocks of the row's scene and path the one with the most frames, then with the most
/// pixels, then the first.
OwnFigure own_figure(const PublishedRow& row, const std::vector<BlockSummary>& blocks);

}  // namespace vislab
