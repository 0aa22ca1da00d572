#include "report/chains_section.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

#include "experiments/analysis/chains.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {
namespace {

constexpr std::size_t least_families = 2;  // that a choice is between
constexpr std::size_t most_named = 3;      // of those that cannot be told from the fastest

/// The scene and path, and what else tells blocks on them apart.
std::string place_of(const std::vector<ChainChoice>& choices, const BlockSummary& block) {
  const auto same = std::ranges::count_if(choices, [&](const ChainChoice& choice) {
    return choice.block->scene == block.scene && choice.block->path == block.path;
  });
  std::string place = block.scene + (block.path.empty() ? "" : ", " + block.path);
  if (same > 1) {
    place += ", " + std::to_string(block.viewport.width) + " × " +
             std::to_string(block.viewport.height) + ", " + block.device;
  }
  return markdown_text(place);
}

std::string undecided_text(const ChainChoice& choice) {
  if (choice.undecided.empty()) return "decided";
  std::string text = "undecided: ";
  const std::size_t named = std::min(most_named, choice.undecided.size());
  for (std::size_t i = 0; i < named; ++i) {
    text += (i == 0 ? "" : ", ") + markdown_code(choice.undecided[i]->culler);
  }
  const std::size_t others = choice.undecided.size() - named;
  return others == 0 ? text : text + " and " + std::to_string(others) + " more";
}

std::string worth_text(const ChainChoice& choice) {
  const Estimate& ratio = choice.best->against_none;
  switch (choice.worth) {
    case ChainChoice::Worth::saves:
      return "saves " + format_percents(1.0 - ratio.high, 1.0 - ratio.low);
    case ChainChoice::Worth::loses:
      return "draw everything: loses " + format_percents(ratio.low - 1.0, ratio.high - 1.0);
    case ChainChoice::Worth::within_noise:
    case ChainChoice::Worth::nothing:
      break;
  }
  if (!choice.block->noise.measured()) {
    return "cannot be told: `none` was not measured against itself";
  }
  return "no faster than drawing everything, as far as can be told";
}

/// Of one scene the run to show, and the others.
struct SceneChoice {
  const ChainChoice* shown = nullptr;
  std::vector<const ChainChoice*> others;
};

/// Which of two runs of a scene tells more of what there is to choose from?
bool tells_more(const ChainChoice& a, const ChainChoice& b) {
  const auto weight = [](const ChainChoice& choice) {
    return std::tuple(choice.best != nullptr, choice.families.size(), choice.block->cells.size(),
                      choice.block->frames);
  };
  return weight(a) > weight(b);
}

/// In the order in which the scenes come first.
std::vector<SceneChoice> by_scene(const std::vector<ChainChoice>& choices) {
  std::vector<SceneChoice> scenes;
  for (const ChainChoice& choice : choices) {
    const auto known = std::ranges::find_if(scenes, [&](const SceneChoice& scene) {
      return scene.shown->block->scene == choice.block->scene;
    });
    if (known == scenes.end()) {
      scenes.push_back({&choice, {}});
      continue;
    }
    known->others.push_back(&choice);
    if (tells_more(choice, *known->shown)) std::swap(known->shown, known->others.back());
  }
  return scenes;
}

/// Is the method the fastest on this run as well, or not to be told from it?
bool is_best_on(const ChainChoice& run, const CellSummary& method) {
  const auto is_it = [&](const CellSummary* cell) { return cell->canonical == method.canonical; };
  return run.best != nullptr && (is_it(run.best) || std::ranges::any_of(run.undecided, is_it));
}

/// "(3 of 5 other runs alike)", or empty.
std::string others_text(const SceneChoice& scene) {
  if (scene.others.empty()) return {};
  const auto alike = std::ranges::count_if(scene.others, [&](const ChainChoice* run) {
    return scene.shown->best != nullptr && is_best_on(*run, *scene.shown->best);
  });
  return " (" + std::to_string(alike) + " of " + std::to_string(scene.others.size()) +
         (scene.others.size() == 1 ? " other run" : " other runs") + " alike)";
}

Fields choice_fields(const std::string& place, const ChainChoice& choice) {
  Fields row;
  row.values["scene"] = place;
  for (const char* name : {"ratio", "worth", "undecided", "near", "near_ratio", "near_px"}) {
    row.values[name] = "–";
  }
  row.values["best"] = "none without an error";
  if (choice.best != nullptr) {
    row.values["best"] = markdown_code(choice.best->culler);
    row.values["ratio"] = format_estimate(choice.best->against_none);
    row.values["worth"] = worth_text(choice);
    row.values["undecided"] = undecided_text(choice);
  }
  if (choice.nearly_right != nullptr) {
    const CellSummary& near = *choice.nearly_right;
    row.values["near"] = markdown_code(near.culler);
    row.values["near_ratio"] = format_estimate(near.against_none);
    row.values["near_px"] = format_of(near.false_px, near.pixels);
  }
  return row;
}

/// The fastest of each family; those in question for the fastest of all in bold.
Fields family_row(const std::string& place, const ChainChoice& choice,
                  const std::set<std::string>& families) {
  Fields row;
  row.values["scene"] = place;
  for (const std::string& family : families) {
    const auto found = choice.families.find(family);
    std::string text = "–";
    if (found != choice.families.end()) {
      text = format_number(found->second->against_none.value);
      if (choice.is_undecided(*found->second)) text = "**" + text + "**";
    }
    row.lists["cells"].emplace_back();
    row.lists["cells"].back().values["ratio"] = text;
  }
  return row;
}

Fields tally_fields(const std::string& family, const FamilyTally& tally) {
  Fields row;
  row.values["family"] = markdown_code(family);
  row.values["wins"] = std::to_string(tally.wins);
  row.values["undecided"] = std::to_string(tally.undecided - tally.wins);
  row.values["blocks"] = std::to_string(tally.blocks);
  return row;
}

/// Where methods of several families stand beside each other there is something to choose; what was
/// run for one claim or one mistake would only make the table long. All, if there is no such place.
std::vector<ChainChoice> worth_choosing(const std::vector<ChainChoice>& choices) {
  std::vector<ChainChoice> some;
  std::ranges::copy_if(choices, std::back_inserter(some), [](const ChainChoice& choice) {
    return choice.families.size() >= least_families;
  });
  return some.empty() ? choices : some;
}

}  // namespace

void add_chain_fields(const ReportInput& input, Fields& fields) {
  const std::vector<ChainChoice> all = choose_chains(input.blocks);
  const std::vector<ChainChoice> choices = worth_choosing(all);
  auto& rows = fields.lists["choices"];
  auto& family_rows = fields.lists["family_choices"];
  auto& names = fields.lists["chosen_families"];
  std::set<std::string> families;
  for (const ChainChoice& choice : choices) {
    for (const auto& [family, cell] : choice.families) families.insert(family);
  }
  bool has_others = false;
  for (const SceneChoice& scene : by_scene(choices)) {
    const ChainChoice& choice = *scene.shown;
    const std::string place = place_of(choices, *choice.block);
    rows.push_back(choice_fields(place + others_text(scene), choice));
    if (choice.best != nullptr) family_rows.push_back(family_row(place, choice, families));
    has_others = has_others || !scene.others.empty();
  }
  fields.flag("has_other_choices", has_others);
  const auto tallies = tally_families(choices);
  for (const std::string& family : families) {
    names.push_back(tally_fields(family, tallies.at(family)));
  }
  fields.values["tolerance"] = format_percent(nearly_right_share);
  fields.values["not_timed"] = std::to_string(input.blocks.size() - all.size());
  fields.flag("has_not_timed", all.size() < input.blocks.size());
  fields.values["one_family"] = std::to_string(all.size() - choices.size());
  fields.flag("has_one_family", choices.size() < all.size());
  fields.flag("has_choices", !choices.empty());
  fields.values["choice_count"] = std::to_string(choices.size());
  fields.flag("has_families", !families.empty());
  fields.lists["guides"] = guide_fields(input.blocks);
  fields.flag("has_guides", !fields.lists["guides"].empty());
  fields.flag("has_chains", !choices.empty() || !fields.lists["guides"].empty());
}

}  // namespace vislab
