// Blocks as a run would give them, with figures that tests can expect in the report.
#pragma once

#include <string>

#include "experiments/analysis/summary.h"

namespace vislab {

inline TimeSummary fabricated_time(double value) {
  return {{value, 0.98 * value, 1.02 * value},
          1.1 * value,
          1.3 * value,
          1.5 * value,
          {0.1 * value, 0.08 * value, 0.12 * value}};
}

/// A cell that takes `ratio` times as long as none's 8 ms and is wrong in `false_px` pixels.
inline CellSummary fabricated_cell(const std::string& name, double ratio, std::uint64_t false_px,
                                   double over) {
  CellSummary cell;
  cell.id = name;
  cell.culler = name;
  cell.canonical = name;
  cell.rounds = 5;
  cell.machine = "one";
  cell.judged = true;
  cell.drawn = true;
  cell.pixels = 15'728'640;
  cell.jittered = 16 * cell.pixels;
  cell.false_px = cell.image_px = false_px;
  cell.max_false_px = false_px / 2;
  cell.false_objects = false_px / 1000;
  cell.false_triangles = false_px / 10;
  cell.over = over;
  cell.over_objects = over / 2.0;
  cell.recall = 1.0 / (1.0 + over);
  cell.visible_triangles = 9'300.0;
  cell.submitted_triangles = 9'300.0 * (1.0 + over);
  cell.frame_ms = fabricated_time(8.0 * ratio);
  cell.draw_ms = fabricated_time(7.0 * ratio);
  cell.cull_us = fabricated_time(42.0);
  cell.update_us = fabricated_time(0.1);
  cell.modelled_frame_ms = 7.5 * ratio;
  cell.build_ms = 1.25;
  cell.bytes = 48'000;
  cell.against_none = {ratio, 0.98 * ratio, 1.02 * ratio};
  cell.efficiency = {0.09 / ratio, 0.088 / ratio, 0.092 / ratio};
  return cell;
}

/// none, its control and the oracles.
inline BlockSummary fabricated_block(const std::string& scene) {
  BlockSummary block;
  block.scene = scene;
  block.scene_description = "A scene that was made up: 100 % invented, for tests_only";
  block.path = "orbit";
  block.scene_hash = "scene-" + scene;
  block.path_hash = "path";
  block.device = "osmesa";
  block.threads = 2;
  block.seed = 1;
  block.frames = 60;
  block.objects = 56;
  block.triangles = 278'208;
  block.floor_pixels = 15'728'640;
  block.floor_disputed_px = 1'234;
  block.noise = {1.001, 0.996, 1.006};
  block.context = {{"machine", "one"}, {"compiler", "g++ 12.2"}, {"build_type", "Release"}};
  block.machines = {"one"};
  for (const auto& [name, ratio, over] :
       {std::tuple{"none", 1.0, 29.0}, std::tuple{"none (again)", 1.001, 29.0},
        std::tuple{"oracle", 0.12, 1.4}, std::tuple{"oracle[level=triangle]", 0.09, 0.0}}) {
    CellSummary cell = fabricated_cell(name, ratio, 0, over);
    cell.anchor = true;
    if (std::string(name).starts_with("none")) cell.canonical = "none";
    if (std::string(name) == "none (again)") cell.replicate = 1;
    if (std::string(name) == "oracle") cell.canonical = "oracle[level=object]";
    cell.guarantee = Guarantee::image_exact;
    block.cells.push_back(cell);
  }
  return block;
}

}  // namespace vislab
