#include "report/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <sstream>

#include "report/chart_axis.h"
#include "report/chart_labels.h"
#include "report/chart_legend.h"
#include "report/chart_parts.h"
#include "report/dial_curves.h"
#include "report/finding.h"
#include "report/format.h"

namespace vislab {
namespace {

using namespace chart;

// Everything in units of the drawing (1 unit = 1/4 mm as shown), y upwards.
constexpr double panel_left[2] = {92.0, 424.0};
constexpr double panel_width = 248.0;
constexpr double y_title_distance[2] = {82.0, 46.0};  // from the panel's left
constexpr double usual_height = 360.0;                // more if the legend is long
constexpr double usual_legend_height = 84.0;
constexpr double top_margin = 22.0;
constexpr double axis_height = 50.0;  // tick labels and title below a panel
constexpr double mark_radius = 4.5;
constexpr double digit_width = 6.0;
constexpr double label_height = 10.0;
constexpr double shared_label_reach = 11.0;  // marks nearer than this share a label

constexpr const char* reference_colour = "#000000";
constexpr const char* label_colour = "#000000";
constexpr const char* hull_style = "lw 1.6 lc rgb '#9A9A9A'";
constexpr const char* none_style = "dt (2,4) lw 1.2 lc rgb '#777777'";
constexpr const char* zero_band_colour = "#EEF2F6";
constexpr int none_shape = 1, none_again_shape = 2;  // plus and cross
constexpr std::array<int, 4> oracle_shapes{6, 4, 8, 12};

// With more methods than this only those on a hull and the anchors are named; the others are dots.
constexpr std::size_t most_named = 24;
constexpr std::size_t most_curves = 12;
constexpr std::size_t longest_legend_text = 104;  // letters; the rest is cut
constexpr double letter_width = 5.4;              // of a label's text
constexpr int obstacles_a_segment = 10;           // of a curve
constexpr const char* other_colour = "#9DB4C8";
constexpr int other_shape = 7;
constexpr double named_size = 0.9, other_size = 0.5;  // of symbols

struct Mark {
  const CellSummary* cell = nullptr;
  std::size_t number = 0;  // in charts and tables
  Look look;
  bool named = true;                // in the legend, with its interval
  bool on_curve = false;            // the curve has an entry in the legend for all its marks
  std::vector<std::string> labels;  // values of dials, in the panels beside the mark
};

/// A curve over a dial, as places in the list of marks.
struct Curve {
  DialCurve dial;
  std::vector<std::size_t> marks;
  std::vector<std::size_t> own;  // those that lie on no curve before this one
};

struct Panel {
  std::string title, y_title;
  std::vector<double> values;
  ChartAxis axis;
};

/// Only the anchors have their looks yet.
std::vector<Mark> marks_of(const BlockSummary& block, const ChartChoice& takes) {
  const std::vector<const CellSummary*> charted = charted_cells(block);
  std::vector<Mark> marks;
  std::size_t oracles = 0;
  for (std::size_t i = 0; i < block.cells.size(); ++i) {
    const CellSummary& cell = block.cells[i];
    if (std::ranges::count(charted, &cell) == 0) continue;
    if (!cell.anchor && takes && !takes(cell)) continue;
    Mark mark;
    mark.cell = &cell;
    mark.number = i + 1;
    mark.look = {reference_colour, none_shape};
    if (cell.anchor && cell.canonical == "none") {
      mark.look.shape = cell.replicate == 0 ? none_shape : none_again_shape;
    } else if (cell.anchor) {
      mark.look.shape = oracle_shapes[oracles++ % oracle_shapes.size()];
    }
    marks.push_back(mark);
  }
  return marks;
}

std::string cut(std::string text) {
  if (text.size() <= longest_legend_text) return text;
  std::size_t end = longest_legend_text;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end) + "…";
}

class ChartWriter {
 public:
  ChartWriter(const BlockSummary& block, const ChartChoice& takes, std::ostream& out)
      : out_(out),
        marks_(marks_of(block, takes)),
        best_(find(block).best),
        timed_(has_time_axis(block)) {
    std::vector<double> ends;
    for (const Mark& mark : marks_) {
      const Estimate x = x_of(*mark.cell);
      x_.push_back(x);
      ends.insert(ends.end(), {x.low, x.value, x.high});
      if (mark.cell->canonical == "none" && mark.cell->replicate == 0) none_x_ = x.value;
    }
    x_axis_ = positive_axis(ends);
    add_panels();
    add_curves();
    name_marks();
    add_legend();
    panel_bottom_ = legend_.height() + axis_height;
    chart_height_ = usual_height + std::max(0.0, legend_.height() - usual_legend_height);
    panel_height_ = chart_height_ - top_margin - panel_bottom_;
  }

  double height() const { return chart_height_; }

  void write() {
    for (std::size_t i = 0; i < panels_.size(); ++i) write_panel(i);
    legend_.write(out_, chart_height_);
  }

 private:
  Estimate x_of(const CellSummary& cell) const {
    if (timed_) return cell.frame_ms.median;
    return {cell.submitted_triangles, cell.submitted_triangles, cell.submitted_triangles};
  }

  void add_panels() {
    std::uint64_t pixels = 0;
    Panel errors{"a   Errors", "false pixels (false_px)", {}, {}};
    Panel over{"b   Over-inclusion", "kept but invisible ÷ visible (over)", {}, {}};
    for (const Mark& mark : marks_) {
      pixels = std::max(pixels, mark.cell->pixels);
      errors.values.push_back(static_cast<double>(mark.cell->false_px));
      over.values.push_back(std::isnan(mark.cell->over) ? 0.0 : mark.cell->over);
    }
    errors.axis = logarithmic_axis(errors.values, 10.0, "0 of\n" + format_count(pixels));
    const double most = over.values.empty() ? 0.0 : std::ranges::max(over.values);
    over.axis = logarithmic_axis(over.values, most > 0.0 ? most : 1.0, "0");
    panels_ = {std::move(errors), std::move(over)};
  }

  /// The longest first; a curve all of whose marks lie on others says nothing new.
  void add_curves() {
    std::vector<const CellSummary*> cells;
    for (const Mark& mark : marks_) cells.push_back(mark.cell);
    for (DialCurve& dial : dial_curves(cells)) {
      if (curves_.size() == most_curves) break;
      Curve curve;
      curve.marks = dial.cells;
      for (const std::size_t mark : curve.marks) {
        if (!marks_[mark].on_curve) curve.own.push_back(mark);
      }
      if (curve.own.empty()) continue;
      for (const std::size_t mark : curve.own) marks_[mark].on_curve = true;
      curve.dial = std::move(dial);
      curves_.push_back(std::move(curve));
    }
  }

  /// Which marks have a name, how they look, and what stands beside them. Where there are many, the
  /// anchors, the curves and what lies on a hull have names.
  void name_marks() {
    if (marks_.size() > most_named) {
      for (Mark& mark : marks_) mark.named = mark.cell->anchor || mark.on_curve;
      for (std::size_t panel = 0; panel < panels_.size(); ++panel) {
        for (const std::size_t i : hull_marks(panel)) marks_[i].named = true;
      }
      for (Mark& mark : marks_) mark.named = mark.named || mark.cell == best_;
    }
    std::size_t looks = 0;
    for (const Curve& curve : curves_) {
      const Look look = method_look(looks++);
      for (const std::size_t i : curve.own) marks_[i].look = look;
      for (const bool last : {false, true}) {
        const std::size_t i = last ? curve.marks.back() : curve.marks.front();
        const std::string& value = last ? curve.dial.values.back() : curve.dial.values.front();
        marks_[i].labels.push_back("=" + value);
      }
    }
    for (Mark& mark : marks_) {
      if (mark.cell->anchor || mark.on_curve) continue;
      mark.look = mark.named ? method_look(looks++) : Look{other_colour, other_shape};
    }
  }

  void add_legend() {
    bool others = false;
    std::vector<LegendEntry> entries;
    for (const Mark& mark : marks_) {
      others = others || !mark.named;
      if (!mark.named || mark.on_curve) continue;
      entries.push_back(symbol_entry(cut(std::to_string(mark.number) + "  " + mark.cell->culler),
                                     mark.look, named_size));
    }
    for (const Curve& curve : curves_) {
      std::vector<std::size_t> numbers;
      for (const std::size_t i : curve.own) numbers.push_back(marks_[i].number);
      entries.push_back(symbol_entry(
          cut(number_list(numbers) + "  " + curve.dial.name + " over " + curve.dial.parameter),
          marks_[curve.own.front()].look, named_size));
    }
    if (others) {
      entries.push_back(symbol_entry("other methods: see the tables",
                                     Look{other_colour, other_shape}, other_size));
    }
    entries.push_back(line_entry("Pareto hull of the methods", hull_style));
    if (none_x_ > 0.0) {
      entries.push_back(
          line_entry(timed_ ? "time of drawing everything" : "drawing everything", none_style));
    }
    legend_ = Legend(std::move(entries));
  }

  double pixel_x(std::size_t panel, double value) const {
    return panel_left[panel] + panel_width * x_axis_.share(value);
  }
  double pixel_y(const Panel& panel, double value) const {
    return panel_bottom_ + panel_height_ * panel.axis.share(value);
  }

  void write_panel(std::size_t index) {
    const Panel& panel = panels_[index];
    out_ << "unset label\nunset arrow\nunset object\nset border 3 lc rgb '#444444'\n"
         << "set tics nomirror out scale 0.5\nset grid xtics ytics lt 1 lw 0.5 lc rgb '#E4E4E4'\n"
         << "set title " << quoted(panel.title) << " offset 0,-0.6 font ',12'\n"
         << "unset ylabel\nset xlabel "
         << quoted(timed_ ? "time of a frame, frame_ms (ms)" : "triangles submitted per frame")
         << " offset 0,0.5\n"
         // gnuplot would place the title by the widest tick label, and outside the drawing.
         << "set label " << quoted(panel.y_title) << " at screen "
         << (panel_left[index] - y_title_distance[index]) / chart_width << ','
         << (panel_bottom_ + 0.5 * panel_height_) / chart_height_ << " center rotate by 90\n";
    set_axis(out_, 'x', x_axis_);
    set_axis(out_, 'y', panel.axis);
    set_margins(out_, panel_left[index], panel_bottom_, panel_width, panel_height_, chart_height_);
    const double right = panel_left[index] + panel_width;
    const double top = panel_bottom_ + panel_height_;
    if (panel.axis.logarithmic) {
      // Zero has no place on a logarithmic axis: a band sets it apart.
      out_ << "set object rectangle from graph 0, graph 0 to graph 1, first "
           << panel.axis.zero_band_top << " fc rgb '" << zero_band_colour
           << "' fs solid noborder behind\n";
    }
    std::vector<ChartBox> lines;
    if (none_x_ > 0.0) {
      const double x = pixel_x(index, none_x_);
      lines.push_back({x, panel_bottom_, x, top});
      write_line(lines.back(), none_style);
    }
    for (const ChartBox& step : hull_steps(index, {panel_left[index], panel_bottom_, right, top})) {
      lines.push_back(step);
      write_line(step, hull_style);
    }
    write_curves(index, lines);
    write_labels(index, lines);
    out_ << "$points << END\n";
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      out_ << x_[i].value << ' ' << panel.axis.position(panel.values[i]) << ' ' << x_[i].low << ' '
           << x_[i].high << '\n';
    }
    out_ << "END\n";
    plot_points();
  }

  void write_line(const ChartBox& line, const char* style) {
    out_ << "set arrow from screen " << line.left / chart_width << ','
         << line.bottom / chart_height_ << " to screen " << line.right / chart_width << ','
         << line.top / chart_height_ << " nohead " << style << " back\n";
  }

  /// The hull of all methods that could be used (the oracles and the control are not among them).
  std::vector<std::size_t> hull_marks(std::size_t panel) const {
    std::vector<std::size_t> usable;
    std::vector<double> x;
    std::vector<double> y;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const CellSummary& cell = *marks_[i].cell;
      if (cell.anchor && !(cell.canonical == "none" && cell.replicate == 0)) continue;
      usable.push_back(i);
      x.push_back(x_axis_.position(x_[i].value));
      y.push_back(panels_[panel].axis.position(panels_[panel].values[i]));
    }
    std::vector<std::size_t> hull = pareto_hull(x, y);
    for (std::size_t& i : hull) i = usable[i];
    return hull;
  }

  /// The hull as a staircase: what lies to the right of it and above it is beaten by some method.
  std::vector<ChartBox> hull_steps(std::size_t index, const ChartBox& frame) const {
    const auto across = [&](std::size_t mark) { return pixel_x(index, x_[mark].value); };
    std::vector<ChartBox> steps;
    double from = frame.top;
    const std::vector<std::size_t> hull = hull_marks(index);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const double px = across(hull[i]);
      const double py = pixel_y(panels_[index], panels_[index].values[hull[i]]);
      steps.push_back({px, py, px, from});
      steps.push_back({px, py, i + 1 < hull.size() ? across(hull[i + 1]) : frame.right, py});
      from = py;
    }
    return steps;
  }

  /// Joins the marks of each curve, and adds what labels should keep off.
  void write_curves(std::size_t index, std::vector<ChartBox>& lines) {
    for (const Curve& curve : curves_) {
      const std::string& colour = marks_[curve.own.front()].look.colour;
      for (std::size_t i = 1; i < curve.marks.size(); ++i) {
        const glm::dvec2 from = place_of(index, curve.marks[i - 1]);
        const glm::dvec2 to = place_of(index, curve.marks[i]);
        write_line({from.x, from.y, to.x, to.y}, ("lw 1.4 lc rgb '" + colour + "'").c_str());
        for (int k = 0; k < obstacles_a_segment; ++k) {
          const glm::dvec2 at = glm::mix(from, to, (k + 0.5) / obstacles_a_segment);
          lines.push_back({at.x, at.y, at.x, at.y});
        }
      }
    }
  }

  glm::dvec2 place_of(std::size_t panel, std::size_t mark) const {
    return {pixel_x(panel, x_[mark].value), pixel_y(panels_[panel], panels_[panel].values[mark])};
  }

  /// Marks on a hull first: if there is no room for all, theirs have to stand there.
  std::vector<NumberedPoint> numbered_points(std::size_t index) const {
    const std::vector<std::size_t> hull = hull_marks(index);
    std::vector<NumberedPoint> points;
    for (const bool on_hull : {true, false}) {
      for (std::size_t i = 0; i < marks_.size(); ++i) {
        if (!marks_[i].named || marks_[i].on_curve) continue;
        if ((std::ranges::count(hull, i) > 0) != on_hull) continue;
        const glm::dvec2 at = place_of(index, i);
        points.push_back({at.x, at.y, marks_[i].number});
      }
    }
    return points;
  }

  void write_labels(std::size_t index, const std::vector<ChartBox>& lines) {
    std::vector<LabelRequest> requests;
    std::vector<std::string> texts, colours;
    std::vector<ChartBox> obstacles;
    for (const ChartBox& line : lines) {
      obstacles.push_back({line.left - 1.0, line.bottom - 1.0, line.right + 1.0, line.top + 1.0});
    }
    const auto request = [&](double x, double y, const std::string& text, double letter,
                             const std::string& colour) {
      texts.push_back(text);
      colours.push_back(colour);
      requests.push_back({x, y, letter * static_cast<double>(letters_of(text)), label_height});
    };
    for (const PointGroup& group : group_points(numbered_points(index), shared_label_reach)) {
      request(group.x, group.y, number_list(group.numbers), digit_width, label_colour);
    }
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const glm::dvec2 at = place_of(index, i);
      obstacles.push_back(
          {at.x - mark_radius, at.y - mark_radius, at.x + mark_radius, at.y + mark_radius});
      if (!marks_[i].named) continue;
      // Several curves may have the same values: each has its colour.
      for (const std::string& label : marks_[i].labels) {
        request(at.x, at.y, label, letter_width, marks_[i].look.colour);
      }
      obstacles.push_back(
          {pixel_x(index, x_[i].low), at.y - 1.0, pixel_x(index, x_[i].high), at.y + 1.0});
    }
    const ChartBox frame{panel_left[index] + 2.0, panel_bottom_ + 1.0,
                         panel_left[index] + panel_width + 8.0, panel_bottom_ + panel_height_};
    const std::vector<PlacedLabel> labels = place_labels(requests, obstacles, frame);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const PlacedLabel& label = labels[i];
      if (!label.is_legible) continue;  // symbol and colour are in the legend
      if (label.leader) write_leader(requests[i], label);
      out_ << "set label " << quoted(texts[i]) << " at screen " << label.x / chart_width << ','
           << label.y / chart_height_ << " center font ',10' textcolor rgb '" << colours[i]
           << "' front\n";
    }
  }

  /// From the edge of the mark to the edge of the label.
  void write_leader(const LabelRequest& point, const PlacedLabel& label) {
    const double dx = label.x - point.x;
    const double dy = label.y - point.y;
    const double begin = mark_radius / std::hypot(dx, dy);
    // How far from its middle the label's box is left, as a share of the way.
    const double end =
        1.0 - std::min({1.0 - begin, 0.5 * point.width / std::max(std::abs(dx), 1e-9),
                        0.5 * point.height / std::max(std::abs(dy), 1e-9)});
    out_ << "set arrow from screen " << (point.x + begin * dx) / chart_width << ','
         << (point.y + begin * dy) / chart_height_ << " to screen "
         << (point.x + end * dx) / chart_width << ',' << (point.y + end * dy) / chart_height_
         << " nohead lw 0.6 lc rgb '#777777' front\n";
  }

  /// Plots the lines of $points, each with the look of its mark; those without a name as dots below
  /// the others.
  void plot_points() {
    const char* separator = "plot ";
    for (const bool named : {false, true}) {
      for (std::size_t i = 0; i < marks_.size(); ++i) {
        const Look& look = marks_[i].look;
        if (marks_[i].named != named) continue;
        out_ << separator << "$points every ::" << i << "::" << i << " using "
             << (named ? "1:2:3:4 with xerrorbars" : "1:2 with points") << " notitle pt "
             << look.shape << " ps " << (named ? named_size : other_size) << " lw 1.3 lc rgb '"
             << look.colour << "'";
        separator = ", \\\n  ";
      }
    }
    out_ << '\n';
  }

  std::ostream& out_;
  std::vector<Mark> marks_;
  const CellSummary* best_ = nullptr;  // of which the text beside the chart speaks
  bool timed_ = false;
  std::vector<Estimate> x_;
  double none_x_ = 0.0;
  ChartAxis x_axis_;
  std::vector<Panel> panels_;
  std::vector<Curve> curves_;
  Legend legend_;
  double chart_height_ = 0.0, panel_bottom_ = 0.0, panel_height_ = 0.0;
};

}  // namespace

bool has_time_axis(const BlockSummary& block) {
  return block.drawn && is_of_one_machine(block) && block.device_models.size() <= 1 &&
         std::ranges::any_of(block.cells,
                             [](const CellSummary& cell) { return cell.frame_ms.measured(); });
}

std::vector<const CellSummary*> charted_cells(const BlockSummary& block) {
  const bool timed = has_time_axis(block);
  std::vector<const CellSummary*> cells;
  for (const CellSummary& cell : block.cells) {
    if (cell.judged && (cell.frame_ms.measured() || !timed)) cells.push_back(&cell);
  }
  return cells;
}

std::vector<std::size_t> pareto_hull(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<std::size_t> order(x.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return std::pair(x[i], y[i]); });
  std::vector<std::size_t> hull;
  for (const std::size_t i : order) {
    if (hull.empty() || y[i] < y[hull.back()]) hull.push_back(i);
  }
  return hull;
}

std::string chart_script(const BlockSummary& block, const std::filesystem::path& file,
                         const ChartChoice& takes) {
  std::ostringstream script;
  script.precision(12);
  ChartWriter writer(block, takes, script);
  start_chart(script, file, writer.height());
  writer.write();
  end_chart(script);
  return script.str();
}

}  // namespace vislab
