#include "experiments/analysis/chains.h"

#include <algorithm>

namespace vislab {
namespace {

bool overlap(const Estimate& a, const Estimate& b) { return a.low <= b.high && b.low <= a.high; }

bool can_be_chosen(const CellSummary& cell) {
  return !cell.anchor && !cell.paints && cell.judged && cell.against_none.measured() &&
         cell.guarantee != Guarantee::erroneous && cell.status == ResultCell::Status::done;
}

bool is_nearly_right(const CellSummary& cell) {
  return static_cast<double>(cell.false_px) <=
         nearly_right_share * static_cast<double>(cell.pixels);
}

ChainChoice::Worth worth_of(const BlockSummary& block, const CellSummary& best) {
  switch (told_against_none(block, best.against_none)) {
    case AgainstNone::faster:
      return ChainChoice::Worth::saves;
    case AgainstNone::slower:
      return ChainChoice::Worth::loses;
    case AgainstNone::alike:
      break;
  }
  return ChainChoice::Worth::within_noise;
}

ChainChoice choice_of(const BlockSummary& block, std::vector<const CellSummary*> cells) {
  std::ranges::stable_sort(cells, [&](const CellSummary* a, const CellSummary* b) {
    return is_sooner(block, a->against_none, b->against_none);
  });
  ChainChoice choice;
  choice.block = &block;
  for (const CellSummary* cell : cells) {
    if (!is_free_of_errors(*cell)) continue;
    choice.families.emplace(family_of_chain(cell->canonical), cell);
    if (choice.best == nullptr) {
      choice.best = cell;
    } else if (overlap(cell->against_none, choice.best->against_none)) {
      choice.undecided.push_back(cell);
    }
  }
  if (choice.best != nullptr) choice.worth = worth_of(block, *choice.best);
  for (const CellSummary* cell : cells) {
    if (is_free_of_errors(*cell) || !is_nearly_right(*cell)) continue;
    if (choice.best == nullptr || cell->against_none.high < choice.best->against_none.low) {
      choice.nearly_right = cell;
    }
    break;
  }
  return choice;
}

}  // namespace

bool ChainChoice::is_undecided(const CellSummary& cell) const {
  return best != nullptr && overlap(cell.against_none, best->against_none);
}

std::vector<ChainChoice> choose_chains(const std::vector<BlockSummary>& blocks) {
  std::vector<ChainChoice> choices;
  for (const BlockSummary& block : blocks) {
    // Times of different machines have no common order, nor have modelled and real ones.
    if (!block.drawn || !is_of_one_machine(block) || !block.device_models.empty()) continue;
    std::vector<const CellSummary*> cells;
    for (const CellSummary& cell : block.cells) {
      if (can_be_chosen(cell)) cells.push_back(&cell);
    }
    if (!cells.empty()) choices.push_back(choice_of(block, std::move(cells)));
  }
  return choices;
}

std::map<std::string, FamilyTally> tally_families(const std::vector<ChainChoice>& choices) {
  std::map<std::string, FamilyTally> tallies;
  for (const ChainChoice& choice : choices) {
    if (choice.best == nullptr) continue;
    std::size_t in_question = 0;
    for (const auto& [family, cell] : choice.families) {
      FamilyTally& tally = tallies[family];
      ++tally.blocks;
      if (!choice.is_undecided(*cell)) continue;
      ++tally.undecided;
      ++in_question;
    }
    if (in_question == 1) ++tallies[family_of_chain(choice.best->canonical)].wins;
  }
  return tallies;
}

std::string family_of_chain(const std::string& canonical) {
  if (canonical.find('>') != std::string::npos) return "chain";
  return canonical.substr(0, canonical.find_first_of(".["));
}

}  // namespace vislab
