#include "experiments/analysis/guide.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace vislab {
namespace {

constexpr std::size_t fewest_methods = 3;
constexpr double most_triangles = 1.01;  // of the fewest, where nothing is drawn

/// Methods that paint an image of their own are not to choose from: what they do takes the place of
/// drawing, not of finding what to draw.
bool is_right(const BlockSummary& block, const CellSummary& cell) {
  return !cell.anchor && !cell.paints && cell.guarantee != Guarantee::erroneous &&
         cell.status == ResultCell::Status::done && is_free_of_errors(cell) &&
         cell.canonical.find('>') == std::string::npos && cost_ms(block, cell) > 0.0;
}

using RightCells = std::vector<const CellSummary*>;
using Measured = std::vector<std::pair<const BlockSummary*, RightCells>>;  // least cost first

void leave_out_what_hardly_culls(RightCells& cells) {
  const auto triangles = [](const CellSummary* cell) { return cell->submitted_triangles; };
  const double fewest = triangles(*std::ranges::min_element(cells, {}, triangles));
  std::erase_if(cells,
                [&](const CellSummary* cell) { return triangles(cell) > most_triangles * fewest; });
}

/// The candidates of each kind on the block, least cost first.
std::map<Culls, RightCells> candidates_of(const BlockSummary& block) {
  std::map<Culls, RightCells> kinds;
  for (const CellSummary& cell : block.cells) {
    if (is_right(block, cell)) kinds[cell.culls].push_back(&cell);
  }
  for (auto& [culls, cells] : kinds) {
    if (!block.drawn) leave_out_what_hardly_culls(cells);
    std::ranges::stable_sort(cells, {},
                             [&](const CellSummary* cell) { return cost_ms(block, *cell); });
  }
  return kinds;
}

/// Those that submit less than none does, in their order; all if none was not measured.
RightCells that_leave_out(const BlockSummary& block, RightCells cells) {
  const auto none = std::ranges::find(block.cells, "none", &CellSummary::canonical);
  if (none != block.cells.end()) {
    std::erase_if(cells, [&](const CellSummary* cell) {
      return cell->submitted_triangles >= none->submitted_triangles;
    });
  }
  return cells;
}

GuideRow row_of(const BlockSummary& block, const RightCells& cells) {
  const RightCells culling = that_leave_out(block, cells);
  const auto soonest = std::ranges::min_element(
      culling, {}, [](const CellSummary* cell) { return decision_us(*cell); });
  return {&block, cells[0], cells[1], *soonest};
}

struct Tally {
  GuideCandidate candidate;
  std::size_t blocks = 0;
  double sum_of_logarithms = 0.0;
};

/// Nothing if no method is a candidate on all blocks.
std::optional<GuideAdvice> choose(GuideAdvice::Group group, const Measured& measured) {
  std::map<std::string, Tally> tallies;  // by canonical chain
  for (const auto& [block, cells] : measured) {
    for (const CellSummary* cell : cells) {
      Tally& tally = tallies[cell->canonical];
      const double ratio = cost_ms(*block, *cell) / cost_ms(*block, *cells[0]);
      tally.candidate.culler = cell->culler;
      tally.candidate.guarantee = cell->guarantee;
      tally.candidate.wins += cell == cells[0] ? 1 : 0;
      tally.sum_of_logarithms += std::log(ratio);
      ++tally.blocks;
      if (ratio > tally.candidate.worst_ratio) {
        tally.candidate.worst_ratio = ratio;
        tally.candidate.worst_block = block;
      }
    }
  }
  GuideAdvice advice{group, measured.size(), 0, {}};
  for (auto& [chain, tally] : tallies) {
    if (tally.blocks != measured.size()) continue;
    tally.candidate.mean_ratio =
        std::exp(tally.sum_of_logarithms / static_cast<double>(tally.blocks));
    if (advice.eligible == 0 || tally.candidate.mean_ratio < advice.choice.mean_ratio) {
      advice.choice = tally.candidate;
    }
    ++advice.eligible;
  }
  return advice.eligible == 0 ? std::nullopt : std::optional(advice);
}

}  // namespace

double decision_us(const CellSummary& cell) {
  return cell.update_us.median.value + cell.cull_us.median.value;
}

double cost_ms(const BlockSummary& block, const CellSummary& cell) {
  return block.drawn ? cell.modelled_frame_ms : decision_us(cell) / 1000.0;
}

std::vector<CullerGuide> make_guides(const std::vector<BlockSummary>& blocks) {
  std::map<Culls, Measured> kinds;
  for (const BlockSummary& block : blocks) {
    // Times of different machines have no common order, nor have modelled and real ones.
    if (!is_of_one_machine(block) || !block.device_models.empty()) continue;
    for (auto& [culls, cells] : candidates_of(block)) {
      // Where nothing can be left out (meshes that are not solid, to cullers of back faces) the
      // least cost is that of noise.
      if (cells.size() < fewest_methods || that_leave_out(block, cells).empty()) continue;
      kinds[culls].emplace_back(&block, std::move(cells));
    }
  }
  std::vector<CullerGuide> guides;
  for (const auto& [culls, measured] : kinds) {
    CullerGuide guide{culls, {}, {}};
    Measured still;
    Measured moving;
    for (const auto& entry : measured) {
      guide.rows.push_back(row_of(*entry.first, entry.second));
      (entry.first->moving_objects > 0.0 ? moving : still).push_back(entry);
    }
    const auto advise = [&](GuideAdvice::Group group, const auto& entries) {
      if (const auto advice = choose(group, entries)) guide.advice.push_back(*advice);
    };
    advise(GuideAdvice::Group::all, measured);
    if (!still.empty() && !moving.empty()) {
      advise(GuideAdvice::Group::still, still);
      advise(GuideAdvice::Group::moving, moving);
    }
    guides.push_back(std::move(guide));
  }
  return guides;
}

}  // namespace vislab
