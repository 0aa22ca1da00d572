// Figures that the sources print, beside which the lab sets its own: TOML files of facts.
//
//   title = "Thesis, tables 5.2 to 5.9"
//   source = "Kowalka 2016"
//   note = "…"                     what is known to be odd about the figures
//   [[row]]
//   what = "mixed scene, camera moving"
//   table = "5.2"
//   without_fps = 58.92            frames a second without culling (or of what `against` stands
//   for) with_fps = 66.21 scene = "mixed"                what stands for it here: scene, path, path
//   = "mixed_moving"          "" or left out: any path culler = "frustum.two_step"    and method
//   against = "none"               what it is compared with; none if left out
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

  /// How many times as many frames a second as without.
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
  /// frame_ms of `against` / frame_ms of the culler. Against none paired by frame and round;
  /// against another method the quotient of two such ratios, with the widest interval that they
  /// allow.
  Estimate ratio = Estimate::none();
};

OwnFigure own_figure(const PublishedRow& row, const std::vector<BlockSummary>& blocks);

}  // namespace vislab
