#include "common/render/cell_plan.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/render/canvas.h"
#include "common/render/plan_shapes.h"

namespace vislab {
namespace {

constexpr Color paper = {255, 255, 255};
constexpr Color white = {255, 255, 255};
constexpr Color cell_color = {42, 47, 55};
constexpr Color reached_color = {40, 92, 76};
constexpr Color cell_edge = {84, 92, 104};
constexpr Color portal_color = {204, 121, 167};  // the reddish purple of Okabe and Ito
constexpr double margin = 16.0;
constexpr double title_height = 40.0;
constexpr double note_height = 22.0;
constexpr double panel_size = 760.0;

struct PlanBounds {
  glm::dvec2 min{1e300}, max{-1e300};

  void extend(const glm::dvec2& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
};

/// A square part of the plan in a square part of the picture.
class Panel {
 public:
  Panel(double left, double top, const PlanBounds& shown) : left_(left), top_(top) {
    const glm::dvec2 size = glm::max(shown.max - shown.min, glm::dvec2(1e-9));
    scale_ = panel_size / (1.08 * std::max(size.x, size.y));
    middle_ = 0.5 * (shown.min + shown.max);
  }

  double left() const { return left_; }
  double top() const { return top_; }
  glm::dvec2 at(const glm::dvec2& p) const {
    return glm::dvec2(left_, top_) + 0.5 * panel_size + scale_ * (p - middle_);
  }
  template <typename Points>
  std::vector<glm::dvec2> at_all(const Points& points) const {
    std::vector<glm::dvec2> placed;
    for (const glm::dvec2& p : points) placed.push_back(at(p));
    return placed;
  }
  /// Longer than the panel's diagonal, metres.
  double beyond() const { return 2.0 * panel_size / scale_ + 2.0 * glm::length(middle_); }

 private:
  double left_, top_;
  double scale_ = 1.0;
  glm::dvec2 middle_{0.0};
};

const Color& color_of(TriangleClass kind) { return class_colors[static_cast<std::size_t>(kind)]; }

/// What is right and plain first, so that what is wrong lies on top.
constexpr std::array drawing_order = {TriangleClass::culled_rightly, TriangleClass::kept_invisible,
                                      TriangleClass::kept_visible, TriangleClass::culled_wrongly};

class PlanPainter {
 public:
  explicit PlanPainter(const CellPlanInput& input)
      : input_(input), is_reached_(input.scene->cells.size(), 0) {
    for (const CellId cell : input.reached) is_reached_.at(cell) = 1;
  }

  Image paint() {
    const double width = 3.0 * margin + 2.0 * panel_size;
    const double panels_top = title_height + 3.0 * note_height;
    Canvas canvas(static_cast<int>(width),
                  static_cast<int>(panels_top + panel_size + note_height + margin), paper);
    canvas.text(margin, 28.0, width - 2.0 * margin, 19.0, true, input_.title);
    draw_legend(canvas, width);
    draw_storey(canvas, Panel(margin, panels_top, storey_bounds()));
    draw_all(canvas, Panel(2.0 * margin + panel_size, panels_top, all_bounds()));
    const double below = panels_top + panel_size + 16.0;
    canvas.text(margin, below, panel_size, 14.0, false,
                "The storey of the eye: cut at its height, around what was reached");
    canvas.text(2.0 * margin + panel_size, below, panel_size, 14.0, false,
                "All storeys from above; boxes of what was kept or is missing");
    return canvas.image();
  }

 private:
  double height() const { return input_.frame->camera.pose.eye.y; }

  PlanBounds all_bounds() const {
    PlanBounds bounds;
    for (const Cell& cell : input_.scene->cells) {
      bounds.extend({cell.bounds.min.x, cell.bounds.min.z});
      bounds.extend({cell.bounds.max.x, cell.bounds.max.z});
    }
    bounds.extend(seen_from_above(input_.frame->camera.pose.eye));
    return bounds;
  }

  /// What was reached on the storey of the eye, but for cells that are larger than half of the
  /// scene: the world around a house.
  PlanBounds storey_bounds() const {
    const PlanBounds all = all_bounds();
    const glm::dvec2 half = 0.5 * (all.max - all.min);
    PlanBounds bounds;
    bounds.extend(seen_from_above(input_.frame->camera.pose.eye));
    bool any = false;
    for (const CellId id : input_.reached) {
      const Cell& cell = input_.scene->cells[id];
      const glm::vec3 size = cell.bounds.max - cell.bounds.min;
      if (size.x > half.x && size.z > half.y) continue;
      for (const ConvexRegion& region : cell.regions) {
        for (const glm::dvec2& corner : cut_at(region, height())) {
          bounds.extend(corner);
          any = true;
        }
      }
    }
    return any ? bounds : all;
  }

  template <typename Visit>
  void for_each_region(Visit&& visit) const {
    for (std::size_t cell = 0; cell < input_.scene->cells.size(); ++cell) {
      for (const ConvexRegion& region : input_.scene->cells[cell].regions) {
        visit(region, is_reached_[cell] != 0);
      }
    }
  }

  template <typename Visit>
  void for_each_reached_portal(Visit&& visit) const {
    for (const Portal& portal : input_.scene->portals) {
      if (is_reached_[portal.from] != 0 && is_reached_[portal.to] != 0) visit(portal);
    }
  }

  /// `shape_of` gives a region's polygon in the plan. Cells that were reached lie on top, the
  /// outlines of all on top of these.
  template <typename ShapeOf>
  void draw_cells(Canvas& canvas, const Panel& panel, ShapeOf&& shape_of) const {
    std::vector<std::vector<glm::dvec2>> outlines;
    for (const bool reached : {false, true}) {
      for_each_region([&](const ConvexRegion& region, bool is_reached) {
        if (is_reached != reached) return;
        std::vector<glm::dvec2> shape = panel.at_all(shape_of(region));
        if (shape.size() < 3) return;
        canvas.polygon(shape, reached ? reached_color : cell_color, std::nullopt, 0.0);
        outlines.push_back(std::move(shape));
      });
    }
    for (const std::vector<glm::dvec2>& shape : outlines) {
      canvas.polygon(shape, std::nullopt, cell_edge, 0.6);
    }
  }

  void draw_storey(Canvas& canvas, const Panel& panel) const {
    begin(canvas, panel);
    draw_cells(canvas, panel, [&](const ConvexRegion& region) { return cut_at(region, height()); });
    draw_cut_objects(canvas, panel);
    for_each_reached_portal([&](const Portal& portal) {
      PlanLine line;
      if (!cut_at(portal.polygon, height(), line)) return;
      canvas.polygon(panel.at_all(line), std::nullopt, portal_color, 1.6);
    });
    end(canvas, panel);
  }

  void draw_all(Canvas& canvas, const Panel& panel) const {
    begin(canvas, panel);
    draw_cells(canvas, panel, outline_of);
    for (const TriangleClass kind : drawing_order) {
      if (kind == TriangleClass::culled_rightly) continue;
      for (const ObjectId object : input_.frame->objects.shown) {
        if (input_.objects[object] != kind) continue;
        const Aabb& box = input_.frame->objects.bounds[object];
        const std::array<glm::dvec2, 4> corners = {{{box.min.x, box.min.z},
                                                    {box.max.x, box.min.z},
                                                    {box.max.x, box.max.z},
                                                    {box.min.x, box.max.z}}};
        canvas.polygon(panel.at_all(corners), std::nullopt, color_of(kind), 0.8);
      }
    }
    end(canvas, panel);
  }

  void draw_cut_objects(Canvas& canvas, const Panel& panel) const {
    const ObjectsView& objects = input_.frame->objects;
    for (const TriangleClass kind : drawing_order) {
      for (const ObjectId object : objects.shown) {
        const Aabb& box = objects.bounds[object];
        if (input_.objects[object] != kind || box.min.y > height() || box.max.y < height()) {
          continue;
        }
        const Mesh& mesh = input_.scene->mesh_of(object);
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
          PlanLine line;
          if (!cut_at(world_triangle(mesh, objects.transforms[object], i), height(), line)) {
            continue;
          }
          canvas.polygon(panel.at_all(line), std::nullopt, color_of(kind), 1.8);
        }
      }
    }
  }

  static void begin(Canvas& canvas, const Panel& panel) {
    canvas.clip(panel.left(), panel.top(), panel_size, panel_size);
    canvas.fill(panel.left(), panel.top(), panel_size, panel_size, background_color);
  }

  void end(Canvas& canvas, const Panel& panel) const {
    const Camera& camera = input_.frame->camera;
    for (const double side : {0.0, 1.0}) {
      const Ray ray = camera.ray({side, 0.5});
      const glm::dvec2 from = seen_from_above(ray.origin);
      const glm::dvec2 direction = seen_from_above(ray.direction);
      const double length = glm::length(direction);
      if (!(length > 1e-9)) continue;  // straight up or down
      const double reach = panel.beyond() + 2.0 * glm::length(from);
      canvas.line(panel.at(from), panel.at(from + direction * (reach / length)), white, 1.2);
    }
    canvas.disc(panel.at(seen_from_above(camera.pose.eye)), 5.0, white);
    canvas.unclip();
  }

  void draw_legend(Canvas& canvas, double width) const {
    std::array<std::uint64_t, triangle_class_count> counts{};
    for (const ObjectId object : input_.frame->objects.shown) {
      ++counts[static_cast<std::size_t>(input_.objects[object])];
    }
    std::array<std::size_t, 2> cells{is_reached_.size(), 0};
    for (const std::uint8_t reached : is_reached_) cells[1] += reached;
    struct Entry {
      Color color;
      std::string words;
    };
    const auto objects = [&](TriangleClass kind, const std::string& words) {
      const std::uint64_t count = counts[static_cast<std::size_t>(kind)];
      return Entry{color_of(kind), words + ": " + std::to_string(count)};
    };
    Entry missing = objects(TriangleClass::culled_wrongly, "objects visible, but left out");
    if (input_.excused > 0) missing.words += " (excused: " + std::to_string(input_.excused) + ")";
    const std::array<std::array<Entry, 3>, 2> rows = {
        {{{{reached_color, "cells " + input_.reached_means + ": " + std::to_string(cells[1]) +
                               " of " + std::to_string(cells[0])},
           {portal_color, "portals between these"},
           objects(TriangleClass::culled_wrongly, "objects visible, but left out")}},
         {{objects(TriangleClass::kept_visible, "objects kept and visible"),
           objects(TriangleClass::kept_invisible, "kept, invisible"),
           objects(TriangleClass::culled_rightly, "left out, invisible")}}}};
    const double step = (width - 2.0 * margin) / 3.0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double baseline = title_height + 14.0 + note_height * static_cast<double>(row);
      for (std::size_t i = 0; i < 3; ++i) {
        const double left = margin + step * static_cast<double>(i);
        canvas.fill(left, baseline - 12.0, 14.0, 14.0, rows[row][i].color);
        canvas.text(left + 22.0, baseline, step - 30.0, 15.0, false, rows[row][i].words);
      }
    }
  }

  CellPlanInput input_;
  std::vector<std::uint8_t> is_reached_;
};

}  // namespace

Image render_cell_plan(const CellPlanInput& input) {
  if (input.scene == nullptr || input.frame == nullptr || input.scene->cells.empty()) {
    throw std::logic_error("render_cell_plan: a scene with cells and a frame are needed");
  }
  if (input.objects.size() != input.scene->object_count()) {
    throw std::logic_error("render_cell_plan: a class for each object is needed");
  }
  return PlanPainter(input).paint();
}

}  // namespace vislab
