#include "report/query_picture_choice.h"

#include <algorithm>
#include <functional>

namespace vislab {
namespace {

constexpr std::size_t most_scenes = 2;

double counter_of(const CellSummary& cell, const char* name) {
  const auto found = cell.counters.find(name);
  return found == cell.counters.end() ? 0.0 : found->second;
}

double changes_of(const CellSummary* cell) { return counter_of(*cell, "state_changes"); }

double boxes_a_query(const CellSummary* cell) {
  return counter_of(*cell, "query_boxes") / counter_of(*cell, "queries");
}

/// Questions asked beyond what was kept, a frame, times their share: of a method that asks about
/// each object alone, the objects that it found hidden, and how many of all these are.
double found_hidden(const CellSummary* cell) {
  const double asked = counter_of(*cell, "queries");
  const double hidden = std::max(asked - cell->kept_objects, 0.0);
  return hidden * hidden / asked;
}

/// Methods with parameters that are not the usual ones stand aside for those without.
void keep_usual(std::vector<const CellSummary*>& cells) {
  const auto is_variant = [](const CellSummary* cell) {
    return cell->culler.find('[') != std::string::npos;
  };
  if (!std::ranges::all_of(cells, is_variant)) std::erase_if(cells, is_variant);
}

QueryPictureChoice choice_of(const BlockSummary& block) {
  QueryPictureChoice choice;
  choice.block = &block;
  std::vector<const CellSummary*> cells;
  for (const CellSummary& cell : block.cells) {
    if (!asks_questions(cell) || cell.guarantee > Guarantee::image_exact) continue;
    if (is_free_of_errors(cell) && cell.frame_ms.measured()) cells.push_back(&cell);
  }
  if (cells.empty()) return choice;
  keep_usual(cells);
  choice.found_hidden = found_hidden(*std::ranges::max_element(cells, {}, found_hidden));
  const auto time = [](const CellSummary* cell) { return cell->frame_ms.median.value; };
  for (const CellSummary* cell : {*std::ranges::max_element(cells, {}, changes_of),
                                  *std::ranges::min_element(cells, {}, time),
                                  *std::ranges::min_element(cells, {}, changes_of)}) {
    if (std::ranges::count(choice.contrasts, cell) == 0) choice.contrasts.push_back(cell);
  }
  const auto joint = std::ranges::max_element(cells, {}, boxes_a_query);
  if (boxes_a_query(*joint) > 1.0) choice.joint = *joint;
  return choice;
}

}  // namespace

bool asks_questions(const CellSummary& cell) {
  // Methods that rasterise themselves count queries, too, but ask no device.
  return cell.asks_device && counter_of(cell, "queries") > 0.0 &&
         cell.guarantee != Guarantee::erroneous;
}

std::vector<QueryPictureChoice> choose_query_pictures(
    const std::vector<BlockSummary>& blocks, const std::vector<const BlockSummary*>& left_out) {
  std::vector<QueryPictureChoice> choices;  // one a scene
  for (const BlockSummary& block : blocks) {
    if (std::ranges::count(left_out, &block) > 0) continue;
    QueryPictureChoice choice = choice_of(block);
    if (choice.contrasts.empty()) continue;
    const auto same = std::ranges::find_if(choices, [&](const QueryPictureChoice& known) {
      return known.block->scene == block.scene;
    });
    if (same == choices.end()) {
      choices.push_back(std::move(choice));
    } else if (choice.found_hidden > same->found_hidden) {
      *same = std::move(choice);
    }
  }
  std::ranges::stable_sort(choices, std::ranges::greater(), &QueryPictureChoice::found_hidden);
  choices.resize(std::min(choices.size(), most_scenes));
  return choices;
}

}  // namespace vislab
