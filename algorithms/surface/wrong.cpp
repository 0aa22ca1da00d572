// surface.wrong: the mistakes that sources make with hidden surfaces, as negative controls.
//
// Idea: each variant makes one documented mistake and does everything else right, so that its
//   damage can be measured, and so that the judge is seen to find it.
// Guarantee: none (erroneous). The table below says of each what its source says or does, what is
//   wrong with it, and what comes of it.
// Cost: as the method that is got wrong.
// Limits: that is what they are for.
// Sources: in the table.

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "algorithms/surface/bsp_culler.h"
#include "algorithms/surface/zbuffer_culler.h"
#include "common/culler/mistakes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace surface;

/// Paints whole triangles, the farthest first: by the mean of their corners' depths, which has no
/// meaning for triangles that overlap in a ring.
class WholePainter final : public SurfaceCuller {
 public:
  using SurfaceCuller::SurfaceCuller;

 protected:
  void paint(const Frame& frame, const Candidates& candidates) override {
    const WindowTransform window(frame.camera, frame.viewport);
    order_.clear();
    for_each_range(candidates, frame, scene(), [&](const TriangleRange& range) {
      const WindowRows rows = window.mesh(frame.objects.transforms[range.object]);
      for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
        const auto corners = corners_of(scene().mesh_of(range.object), i, rows);
        order_.push_back({corners[0].depth + corners[1].depth + corners[2].depth,
                          scene().first_triangle(range.object) + i, range.object});
      }
    });
    // What is equally far away comes in the order of its numbers.
    std::ranges::sort(order_, [](const Place& a, const Place& b) {
      return std::pair(-a.depth, a.triangle) < std::pair(-b.depth, b.triangle);
    });
    for (const Place& place : order_) {
      const WindowRows rows = window.mesh(frame.objects.transforms[place.object]);
      const std::uint32_t in_mesh = place.triangle - scene().first_triangle(place.object);
      if (!face_.set(window, corners_of(scene().mesh_of(place.object), in_mesh, rows))) continue;
      face_.for_each_row([&](int y, RowSpan row, const RowEnds&) {
        for (int x = row.x0; x < row.x1; ++x) image().at(x, y) = place.triangle;
      });
    }
  }
  std::size_t own_bytes() const override { return order_.capacity() * sizeof(Place); }

 private:
  struct Place {
    double depth;  // of its corners, in sum
    TriangleId triangle;
    ObjectId object;
  };
  std::vector<Place> order_;
  WindowFace face_;
};

using Make = std::unique_ptr<ICuller> (*)(CullerInfo info);

struct SurfaceMistake : Mistake {
  Make make;
};

constexpr DepthFormat textbook_format{DepthConvention::reversed, 32};

std::unique_ptr<ICuller> other_clear(CullerInfo info) {
  return std::make_unique<ZBuffer>(
      std::move(info),
      ZBuffer::Rules{textbook_format, DepthConvention::reversed, DepthConvention::standard});
}

std::unique_ptr<ICuller> other_comparison(CullerInfo info) {
  return std::make_unique<ZBuffer>(
      std::move(info),
      ZBuffer::Rules{textbook_format, DepthConvention::standard, DepthConvention::standard});
}

std::unique_ptr<ICuller> only_leaves(CullerInfo info) {
  BspPainter::Options options;
  options.max_fragments = 1'000'000;
  options.forgets_inner_nodes = true;
  return std::make_unique<BspPainter>(std::move(info), options);
}

std::unique_ptr<ICuller> whole_painter(CullerInfo info) {
  return std::make_unique<WholePainter>(std::move(info));
}

constexpr const char* both_sources =
    "Textbook chapter 17, Culling (in German), 17.2.1, against Kowalka 2016, 2.4.1";

constexpr std::array mistakes = {
    SurfaceMistake{{"own_polygon_lost",
                    "The textbook's traversal of its tree visits the far subtree and then the near "
                    "one, and its leaves are faces",
                    "the faces are at the nodes, and those of inner nodes are never visited",
                    "draws only the faces of leaves", "Textbook chapter 17 (in German), 17.2.3"},
                   only_leaves},
    SurfaceMistake{{"clear_of_other_convention",
                    "A buffer that is cleared as the thesis says and compared as the textbook says",
                    "where greater is nearer, 1 is the near plane: nothing is nearer",
                    "draws nothing", both_sources},
                   other_clear},
    SurfaceMistake{
        {"comparison_of_other_convention",
         "Depths of the textbook, where greater is nearer, compared and cleared as in the "
         "thesis",
         "the smaller depth is the farther one", "shows what is farthest", both_sources},
        other_comparison},
    SurfaceMistake{
        {"whole_polygons",
         "The painter's order by a key of each whole triangle: the mean of its corners' "
         "depths",
         "triangles that overlap in a ring have no order, and of two that overlap the one "
         "whose middle is nearer may lie behind",
         "shows what is hidden where triangles tilt past each other, and in rings always",
         "Textbook chapter 17 (in German), 17.2.3, why a tree cuts polygons; gripho.it, on "
         "span buffers"},
        whole_painter},
};

CullerInfo describe() {
  CullerInfo info;
  info.name = "surface.wrong";
  info.family = "surface";
  info.summary =
      "Negative controls: hidden surfaces with one documented mistake each, picked by error=.";
  info.guarantee = Guarantee::erroneous;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.parameters = {error_parameter(mistakes)};
  info.cost = "As the method that is got wrong.";
  info.limits = "Wrong on purpose: loses what is seen.";
  info.sources = {"Textbook chapter 17, Culling (in German), 17.2", "Kowalka 2016, 2.4.1"};
  return info;
}

}  // namespace

namespace cullers {

CullerEntry surface_wrong() {
  return {describe(), [](const ParameterValues& values) {
            const SurfaceMistake& mistake = chosen_mistake(mistakes, values);
            return mistake.make(info_of(describe(), mistake));
          }};
}

}  // namespace cullers
}  // namespace vislab
