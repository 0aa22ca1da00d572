#include "experiments/show/depth_complexity_picture.h"

#include <cstdio>

#include "common/render/heat_map.h"

namespace vislab {
namespace {

std::string one_decimal(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

std::string line_of(DepthComplexity definition, const DepthComplexityFigures& figures) {
  const char* meaning = "";
  switch (definition) {
    case DepthComplexity::rays:
      meaning = "intersections of the ray";
      break;
    case DepthComplexity::polygons:
      meaning = "polygons that project to the pixel";
      break;
    case DepthComplexity::transparent:
      meaning = "polygons seen if all were transparent";
      break;
  }
  return std::string(to_string(definition)) + " (" + meaning + "): mean " +
         one_decimal(figures.mean) + ", p95 " + std::to_string(figures.p95) + ", max " +
         std::to_string(figures.max);
}

}  // namespace

DepthComplexityTable measure_depth_complexity(const Scene& scene, const Frame& frame,
                                              DepthComplexity pictured, const std::string& title,
                                              const std::filesystem::path& file) {
  DepthComplexityTable table;
  DepthComplexityMap map;
  for (const DepthComplexity definition : depth_complexities) {
    DepthComplexityMap counted = depth_complexity(scene, frame, definition);
    table[static_cast<std::size_t>(definition)] = figures_of(counted);
    if (definition == pictured) map = std::move(counted);
  }
  if (file.empty()) return table;
  HeatMapInput input;
  input.width = map.width;
  input.height = map.height;
  input.counts = map.counts;
  input.title = title;
  input.counted = pictured == DepthComplexity::rays ? "intersections" : "polygons";
  for (const DepthComplexity definition : depth_complexities) {
    input.lines.push_back(line_of(definition, table[static_cast<std::size_t>(definition)]));
  }
  write_png(file, render_heat_map(input));
  return table;
}

}  // namespace vislab
