// surface.span_buffer: for each row, who is nearest from where to where.
//
// Idea: a row of the image meets each polygon in a span. The spans of a row are cut at all end
//   points of other spans within them; of those that then cover the same piece of the row the one
//   that is nearest at the piece's left end wins all of it, for spans that do not cross keep their
//   order; neighbours of one triangle are merged, and each is drawn once. No pixel is drawn twice
//   and no depth is kept.
// Guarantee: approximate. The same image as the z-buffer's where no polygons interpenetrate, cycles
//   or not. Where polygons cross within a piece, the piece is wrong beyond the crossing, for it is
//   not cut there. With compare_at=left_end, as the textbook has it, the depths are compared where
//   the piece begins; spans that touch there are equally near, and rounding decides. This is so at
//   every left outline of a solid, unless its back faces are left out before, as the textbook says
//   they are. compare_at=first_pixel compares at the centre of the piece's first pixel instead.
// Cost: O(s log s + s p) a row with s spans that are cut into p pieces: in the worst case all of
//   them at all end points, O(s^2).
// Limits: interpenetrating polygons. More work than a z-buffer with many polygons in a row.
// Source: textbook chapter 17, Culling (in German), 17.2.2, figures 17.2 to 17.4.

#include <algorithm>

#include "algorithms/surface/surface_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace surface;

CullerInfo describe() {
  CullerInfo info;
  info.name = "surface.span_buffer";
  info.family = "surface";
  info.summary =
      "Cuts the spans that a row of the image has of the polygons at each other's end points, lets "
      "the nearest win each piece, and draws every pixel once.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::raster;
  info.parameters = {ParameterSpec::choice(
      "compare_at", "first_pixel", {"first_pixel", "left_end"}, ParameterSpec::Stage::build,
      "where the spans of a piece are compared: first_pixel at the centre of its first pixel; "
      "left_end where it begins, as printed, which is undecided for spans that touch there")};
  info.cost = "O(s log s + s p) a row with s spans in p pieces; O(s^2) if all are cut by all";
  info.limits =
      "Wrong where polygons interpenetrate: pieces are not cut where spans cross. With "
      "compare_at=left_end also where spans touch at their left ends.";
  info.sources = {"Textbook chapter 17, Culling (in German), 17.2.2, figures 17.2-17.4"};
  return info;
}

enum class CompareAt { first_pixel, left_end };

class SpanBuffer final : public SurfaceCuller {
 public:
  explicit SpanBuffer(CompareAt compare_at) : SurfaceCuller(describe()), compare_at_(compare_at) {}

  Counters counters() const override {
    return {{"spans", span_count_},
            {"cut_spans", cut_count_},
            {"spans_drawn", drawn_count_},
            {"pixels_written", writes_}};
  }

 protected:
  std::size_t own_bytes() const override {
    return (spans_.capacity() + sorted_.capacity()) * sizeof(Span) +
           row_begins_.capacity() * sizeof(std::size_t) +
           end_points_.capacity() * sizeof(EndPoint) +
           (by_left_end_.capacity() + active_.capacity()) * sizeof(const Span*);
  }
  void paint(const Frame& frame, const Candidates& candidates) override {
    collect(frame, candidates);
    for (int y = 0; y < frame.viewport.height; ++y) {
      const std::size_t first = row_begins_[static_cast<std::size_t>(y)];
      const std::size_t end = row_begins_[static_cast<std::size_t>(y) + 1];
      if (first < end) paint_row(y, std::span(sorted_).subspan(first, end - first));
    }
  }

 private:
  struct Span {
    int y;
    RowSpan row;
    RowEnds ends;
    WindowLine nearness;
    TriangleId triangle;
  };
  /// Where a piece begins or ends: at pixel x, and exactly.
  struct EndPoint {
    int x;
    double exact;
  };

  /// All spans, by row, in the order of the candidates.
  void collect(const Frame& frame, const Candidates& candidates) {
    const WindowTransform window(frame.camera, frame.viewport);
    spans_.clear();
    row_begins_.assign(static_cast<std::size_t>(frame.viewport.height) + 2, 0);
    for_each_face(window, frame, candidates, [&](TriangleId triangle, const WindowFace& face) {
      face.for_each_row([&](int y, RowSpan row, const RowEnds& ends) {
        spans_.push_back({y, row, ends, face.nearness(), triangle});
        ++row_begins_[static_cast<std::size_t>(y) + 2];
      });
    });
    for (std::size_t y = 1; y < row_begins_.size(); ++y) row_begins_[y] += row_begins_[y - 1];
    sorted_.resize(spans_.size());
    for (const Span& span : spans_) {
      sorted_[row_begins_[static_cast<std::size_t>(span.y) + 1]++] = span;
    }
    span_count_ += spans_.size();
  }

  void paint_row(int y, std::span<const Span> spans) {
    end_points_.clear();
    by_left_end_.clear();
    for (const Span& span : spans) {
      by_left_end_.push_back(&span);
      end_points_.push_back({span.row.x0, span.ends.left});
      end_points_.push_back({span.row.x1, span.ends.right});
    }
    std::ranges::sort(end_points_, [](const EndPoint& p, const EndPoint& q) {
      return p.x != q.x ? p.x < q.x : p.exact < q.exact;
    });
    std::ranges::sort(by_left_end_, [](const Span* s, const Span* t) {
      return s->row.x0 != t->row.x0 ? s->row.x0 < t->row.x0 : s->triangle < t->triangle;
    });
    active_.clear();
    std::size_t next = 0;
    TriangleId last = none_id;
    for (std::size_t i = 0; i + 1 < end_points_.size(); ++i) {
      const int x0 = end_points_[i].x;
      const int x1 = end_points_[i + 1].x;
      if (x0 == x1) continue;  // the last of equal ones begins the piece
      std::erase_if(active_, [&](const Span* span) { return span->row.x1 <= x0; });
      for (; next < by_left_end_.size() && by_left_end_[next]->row.x0 <= x0; ++next) {
        active_.push_back(by_left_end_[next]);
      }
      cut_count_ += active_.size();
      const double at =
          compare_at_ == CompareAt::left_end ? end_points_[i].exact : static_cast<double>(x0);
      const Span* nearest = nullptr;
      for (const Span* span : active_) {
        if (nearest == nullptr || span->nearness.at(at, y) > nearest->nearness.at(at, y))
          nearest = span;
      }
      const TriangleId owner = nearest == nullptr ? none_id : nearest->triangle;
      if (owner != none_id) {
        drawn_count_ += owner != last ? 1 : 0;
        writes_ += static_cast<std::uint64_t>(x1 - x0);
        std::fill_n(&image().at(x0, y), x1 - x0, owner);
      }
      last = owner;
    }
  }

  CompareAt compare_at_;
  std::vector<Span> spans_, sorted_;
  std::vector<std::size_t> row_begins_;
  std::vector<EndPoint> end_points_;
  std::vector<const Span*> by_left_end_, active_;
  std::uint64_t span_count_ = 0, cut_count_ = 0, drawn_count_ = 0, writes_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry surface_span_buffer() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            return std::make_unique<SpanBuffer>(values.choice("compare_at") == "left_end"
                                                    ? CompareAt::left_end
                                                    : CompareAt::first_pixel);
          }};
}

}  // namespace cullers
}  // namespace vislab
