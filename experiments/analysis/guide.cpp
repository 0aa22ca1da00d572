#include "experiments/analysis/guide.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace vislab {
namespace {

constexpr std::size_t fewest_methods = 3;

/// "frustum" of "frustum.flat[test=vertex]".
std::string family_of(const std::string& chain) {
  return chain.substr(0, chain.find_first_of(".["));
}

bool is_candidate(const CellSummary& cell) {
  return !cell.anchor && cell.guarantee != Guarantee::erroneous &&
         cell.status == ResultCell::Status::done && is_free_of_errors(cell) &&
         cell.canonical.find('>') == std::string::npos && decision_us(cell) > 0.0;
}

using RightCells = std::vector<const CellSummary*>;
using Measured = std::vector<std::pair<const BlockSummary*, RightCells>>;  // soonest first

/// The right methods of each family on the block, soonest first.
std::map<std::string, RightCells> candidates_of(const BlockSummary& block) {
  std::map<std::string, RightCells> families;
  for (const CellSummary& cell : block.cells) {
    if (is_candidate(cell)) families[family_of(cell.canonical)].push_back(&cell);
  }
  for (auto& [family, cells] : families) {
    std::ranges::stable_sort(cells, {}, [](const CellSummary* cell) { return decision_us(*cell); });
  }
  return families;
}

GuideRow row_of(const BlockSummary& block, const RightCells& cells) {
  GuideRow row{&block, cells[0], cells[1], nullptr};
  for (const CellSummary* cell : cells) {
    if (!block.drawn || !cell->frame_ms.measured()) continue;
    if (row.best_frame == nullptr ||
        cell->frame_ms.median.value < row.best_frame->frame_ms.median.value) {
      row.best_frame = cell;
    }
  }
  return row;
}

struct Tally {
  GuideCandidate candidate;
  std::size_t blocks = 0;
  double sum_of_logarithms = 0.0;
};

/// Nothing if no method was measured on all blocks.
std::optional<GuideCandidate> choose(const Measured& measured) {
  std::map<std::string, Tally> tallies;  // by canonical chain
  for (const auto& [block, cells] : measured) {
    for (const CellSummary* cell : cells) {
      Tally& tally = tallies[cell->canonical];
      const double ratio = decision_us(*cell) / decision_us(*cells[0]);
      tally.candidate.culler = cell->culler;
      tally.candidate.wins += cell == cells[0] ? 1 : 0;
      tally.sum_of_logarithms += std::log(ratio);
      ++tally.blocks;
      if (ratio > tally.candidate.worst_ratio) {
        tally.candidate.worst_ratio = ratio;
        tally.candidate.worst_block = block;
      }
    }
  }
  std::optional<GuideCandidate> best;
  for (auto& [chain, tally] : tallies) {
    if (tally.blocks != measured.size()) continue;
    tally.candidate.mean_ratio =
        std::exp(tally.sum_of_logarithms / static_cast<double>(tally.blocks));
    if (!best || tally.candidate.mean_ratio < best->mean_ratio) best = tally.candidate;
  }
  return best;
}

}  // namespace

double decision_us(const CellSummary& cell) {
  return cell.update_us.median.value + cell.cull_us.median.value;
}

std::vector<FamilyGuide> make_guides(const std::vector<BlockSummary>& blocks) {
  std::map<std::string, Measured> families;
  for (const BlockSummary& block : blocks) {
    // Times of different machines have no common order.
    if (block.machines.size() > 1) continue;
    for (auto& [family, cells] : candidates_of(block)) {
      if (cells.size() >= fewest_methods) families[family].emplace_back(&block, std::move(cells));
    }
  }
  std::vector<FamilyGuide> guides;
  for (const auto& [family, measured] : families) {
    FamilyGuide guide{family, {}, {}};
    Measured still;
    Measured moving;
    for (const auto& entry : measured) {
      guide.rows.push_back(row_of(*entry.first, entry.second));
      (entry.first->moving_objects > 0.0 ? moving : still).push_back(entry);
    }
    const auto advise = [&](GuideAdvice::Group group, const auto& entries) {
      if (const auto choice = choose(entries)) {
        guide.advice.push_back({group, entries.size(), *choice});
      }
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
