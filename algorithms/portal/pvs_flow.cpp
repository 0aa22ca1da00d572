#include "algorithms/portal/pvs_flow.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <deque>
#include <numeric>

#include "algorithms/portal/pvs_polygon.h"

namespace vislab::portal_culling {
namespace {

/// What does not reach farther than this beyond a plane only touches it. More than portals are
/// enlarged by.
constexpr double touching_m = 1e-5;
/// What separating planes give way by.
constexpr double separator_slack_m = 1e-6;
/// Corners of a portal and of its way back: rounding of the edges' enlargement.
constexpr double same_corner_m = 1e-7;
constexpr std::size_t batch_size = 64;

/// A directed opening.
struct FlowPortal {
  CellId to = none_id;
  FlowPolygon polygon;
  HalfSpace beyond;  // the side that it leads to
  HalfSpace before;  // the side of the cell that it leads out of
};

/// A rectangle around corners in a plane.
FlowPolygon rectangle_around(std::span<const glm::dvec3> corners, const glm::dvec3& normal) {
  const glm::dvec3 other = std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(other, normal));
  const glm::dvec3 v = glm::cross(normal, u);
  glm::dvec2 low(0.0);
  glm::dvec2 high(0.0);
  for (const glm::dvec3& corner : corners) {
    const glm::dvec2 at(glm::dot(corner - corners[0], u), glm::dot(corner - corners[0], v));
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  const auto point = [&](double x, double y) { return corners[0] + u * x + v * y; };
  const std::array rectangle{point(low.x, low.y), point(high.x, low.y), point(high.x, high.y),
                             point(low.x, high.y)};
  return FlowPolygon(rectangle);
}

/// A line that crosses `first` may cross `second` after it.
bool may_follow(const FlowPortal& first, const FlowPortal& second) {
  return second.polygon.farthest(first.beyond) > touching_m &&
         first.polygon.farthest(second.before) > touching_m;
}

/// Follows the sequences from one source.
class Follower {
 public:
  Follower(const PortalGraph& graph, const std::vector<FlowPortal>& portals,
           const std::vector<BitWords>& behind, std::uint64_t most_passes)
      : graph_(&graph),
        portals_(&portals),
        behind_(&behind),
        most_passes_(most_passes),
        on_path_(portals.size(), 0) {}

  /// Which portals a line through the source reaches.
  void run(std::uint32_t source, BitWords& seen) {
    seen.assign((*behind_)[source].size(), 0);
    seen_ = &seen;
    source_ = source;
    passes_ = 0;
    if (levels_.empty()) levels_.emplace_back();
    levels_[0].might = (*behind_)[source];
    levels_[0].source = (*portals_)[source].polygon;
    levels_[0].pass = none_id;
    follow(0, (*portals_)[source].to);
    gave_up_ = passes_ > most_passes_;
    if (gave_up_) seen = (*behind_)[source];
  }

  std::uint64_t passes() const { return passes_; }
  bool gave_up() const { return gave_up_; }

 private:
  struct Level {
    BitWords might;
    FlowPolygon source;  // what of it the lines cross
    FlowPolygon window;  // what of the portal last passed
    std::uint32_t pass = none_id;
    bool has_separators = false;
    std::vector<HalfSpace> separators;
  };

  void follow(std::size_t depth, CellId cell) {
    if (levels_.size() < depth + 2) levels_.emplace_back();
    Level& level = levels_[depth];
    Level& next = levels_[depth + 1];
    level.has_separators = false;
    for (std::uint32_t id = graph_->first_opening(cell); id < graph_->end_opening(cell); ++id) {
      if (!bit(level.might, id) || on_path_[id] || passes_ > most_passes_) continue;
      const bool adds = narrow(level.might, (*behind_)[id], next.might);
      if (!adds && bit(*seen_, id)) continue;
      if (!pass(level, (*portals_)[id], next)) continue;
      ++passes_;
      set_bit(*seen_, id);
      if (!adds) continue;
      next.pass = id;
      on_path_[id] = 1;
      follow(depth + 1, (*portals_)[id].to);
      on_path_[id] = 0;
    }
  }

  /// What may be seen on; true if anything of it is not known to be seen.
  bool narrow(const BitWords& might, const BitWords& behind, BitWords& rest) const {
    rest.resize(might.size());
    std::uint64_t fresh = 0;
    for (std::size_t i = 0; i < might.size(); ++i) {
      rest[i] = might[i] & behind[i];
      fresh |= rest[i] & ~(*seen_)[i];
    }
    return fresh != 0;
  }

  /// Cuts the portal and the source to what lines from one to the other cross.
  bool pass(Level& level, const FlowPortal& portal, Level& next) {
    const FlowPortal& source = (*portals_)[source_];
    next.window = portal.polygon;
    next.source = level.source;
    if (!cut(next.window, source.beyond) || !cut(next.source, portal.before)) return false;
    if (level.pass == none_id) return true;
    if (!cut(next.window, (*portals_)[level.pass].beyond)) return false;
    if (!level.has_separators) {
      level.separators.clear();
      append_separators(level.source, level.window, separator_slack_m, level.separators);
      level.has_separators = true;
    }
    for (const HalfSpace& half : level.separators) {
      if (!cut(next.window, half)) return false;
    }
    backward_.clear();
    append_separators(next.window, level.window, separator_slack_m, backward_);
    for (const HalfSpace& half : backward_) {
      if (!cut(next.source, half)) return false;
    }
    return true;
  }

  static bool cut(FlowPolygon& polygon, const HalfSpace& half) {
    return polygon.farthest(half) > touching_m && polygon.clip(half);
  }

  const PortalGraph* graph_;
  const std::vector<FlowPortal>* portals_;
  const std::vector<BitWords>* behind_;
  std::uint64_t most_passes_;
  std::vector<std::uint8_t> on_path_;
  std::deque<Level> levels_;
  std::vector<HalfSpace> backward_;
  BitWords* seen_ = nullptr;
  std::uint32_t source_ = 0;
  std::uint64_t passes_ = 0;
  bool gave_up_ = false;
};

class PvsBuilder {
 public:
  PvsBuilder(const PortalGraph& graph, const PvsLimits& limits)
      : graph_(graph), limits_(limits), arena_(limits.threads) {
    const std::size_t count = graph.opening_count();
    portals_.resize(count);
    for (std::uint32_t id = 0; id < count; ++id) {
      const Opening& opening = graph.opening(id);
      const std::span<const glm::dvec3> corners = graph.corners(opening);
      const Plane& plane = opening.plane;
      portals_[id] = {opening.to,
                      FlowPolygon::fits(corners.size()) ? FlowPolygon(corners)
                                                        : rectangle_around(corners, plane.normal),
                      {-plane.normal, plane.d},
                      {plane.normal, -plane.d}};
    }
    behind_.assign(count, BitWords(words_for(count), 0));
  }

  PvsTable run() {
    each(0, portals_.size(), [&](std::size_t id) { flood(static_cast<std::uint32_t>(id)); });
    follow_all();
    return table();
  }

 private:
  template <typename Function>
  void each(std::size_t begin, std::size_t end, Function&& f) {
    arena_.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(begin, end, 1),
          [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) f(i);
          },
          tbb::simple_partitioner());
    });
  }

  /// What can be reached behind a portal if every portal's line may bend.
  void flood(std::uint32_t source) {
    std::vector<CellId> open{portals_[source].to};
    BitWords& reached = behind_[source];
    while (!open.empty()) {
      const CellId cell = open.back();
      open.pop_back();
      for (std::uint32_t id = graph_.first_opening(cell); id < graph_.end_opening(cell); ++id) {
        if (bit(reached, id) || !may_follow(portals_[source], portals_[id])) continue;
        set_bit(reached, id);
        open.push_back(portals_[id].to);
      }
    }
  }

  void follow_all() {
    std::vector<std::size_t> size(portals_.size(), 0);
    for (std::size_t id = 0; id < portals_.size(); ++id) {
      for (const std::uint64_t word : behind_[id]) size[id] += std::popcount(word);
    }
    std::vector<std::uint32_t> order(portals_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t id) { return size[id]; });

    tbb::enumerable_thread_specific<Follower> followers(
        [&] { return Follower(graph_, portals_, behind_, limits_.most_passes); });
    std::vector<BitWords> seen(batch_size);
    std::vector<std::uint64_t> passes(batch_size);
    std::vector<std::uint8_t> gave_up(batch_size);
    for (std::size_t first = 0; first < order.size(); first += batch_size) {
      const std::size_t count = std::min(batch_size, order.size() - first);
      each(0, count, [&](std::size_t i) {
        Follower& follower = followers.local();
        follower.run(order[first + i], seen[i]);
        passes[i] = follower.passes();
        gave_up[i] = follower.gave_up() ? 1 : 0;
      });
      for (std::size_t i = 0; i < count; ++i) {
        std::swap(behind_[order[first + i]], seen[i]);
        found_.passes += passes[i];
        found_.given_up += gave_up[i];
      }
    }
  }

  PvsTable table() {
    const std::size_t cells = graph_.cell_count();
    std::vector<BitWords> sees(cells, BitWords(words_for(cells), 0));
    for (CellId cell = 0; cell < cells; ++cell) {
      set_bit(sees[cell], cell);
      for (std::uint32_t id = graph_.first_opening(cell); id < graph_.end_opening(cell); ++id) {
        set_bit(sees[cell], portals_[id].to);
        for (std::uint32_t other = 0; other < portals_.size(); ++other) {
          if (bit(behind_[id], other)) set_bit(sees[cell], portals_[other].to);
        }
      }
    }
    const bool both_ways = all_portals_lead_back();
    found_.cells.clear(cells);
    BitWords row;
    for (CellId cell = 0; cell < cells; ++cell) {
      row = sees[cell];
      for (CellId other = 0; both_ways && other < cells; ++other) {
        // What is found along a line from one end need not be from the other.
        if (bit(row, other) && !bit(sees[other], cell)) {
          row[other / 64] &= ~(std::uint64_t{1} << (other % 64));
        }
      }
      found_.cells.add(row);
    }
    found_.cells.finish();
    return std::move(found_);
  }

  /// Only then is sight mutual. A portal between the same two cells elsewhere does not do: a line
  /// that goes through the one need not go back through the other.
  bool all_portals_lead_back() const {
    for (CellId cell = 0; cell < graph_.cell_count(); ++cell) {
      for (std::uint32_t id = graph_.first_opening(cell); id < graph_.end_opening(cell); ++id) {
        if (!leads_back(cell, graph_.opening(id))) return false;
      }
    }
    return true;
  }

  bool leads_back(CellId from, const Opening& way) const {
    const std::span<const glm::dvec3> there = graph_.corners(way);
    for (std::uint32_t id = graph_.first_opening(way.to); id < graph_.end_opening(way.to); ++id) {
      const Opening& other = graph_.opening(id);
      if (other.to == from && reversed(there, graph_.corners(other))) return true;
    }
    return false;
  }

  /// The same corners in the other order, whichever is first.
  static bool reversed(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b) {
    const std::size_t count = a.size();
    if (b.size() != count) return false;
    for (std::size_t first = 0; first < count; ++first) {
      std::size_t same = 0;
      while (same < count &&
             glm::distance(a[same], b[(first + count - same) % count]) <= same_corner_m) {
        ++same;
      }
      if (same == count) return true;
    }
    return false;
  }

  const PortalGraph& graph_;
  PvsLimits limits_;
  tbb::task_arena arena_;
  std::vector<FlowPortal> portals_;
  std::vector<BitWords> behind_;  // by portal: what is seen behind it at best
  PvsTable found_;
};

}  // namespace

PvsTable find_visible_cells(const PortalGraph& graph, const PvsLimits& limits) {
  return PvsBuilder(graph, limits).run();
}

}  // namespace vislab::portal_culling
