#include <algorithm>
#include <utility>
#include <vector>

#include "experiments/analysis/guide.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {
namespace {

const char* kind_of(Culls culls) {
  switch (culls) {
    case Culls::back_faces:
      return "back-face";
    case Culls::outside_frustum:
      return "view-frustum";
    case Culls::hidden:
      break;
  }
  return "occlusion";
}

std::string place_of(const BlockSummary& block) {
  return markdown_text(block.scene + (block.path.empty() ? "" : ", " + block.path));
}

Fields row_fields(const GuideRow& row) {
  const BlockSummary& block = *row.block;
  Fields fields;
  fields.values["scene"] = place_of(block);
  fields.values["objects"] = format_count(block.objects);
  fields.values["moving"] =
      block.moving_objects > 0.0 && block.objects > 0
          ? format_percent(block.moving_objects / static_cast<double>(block.objects))
          : "–";
  fields.values["triangles"] = format_count(block.triangles);
  const auto cost = [&](const CellSummary& cell) {
    return block.drawn ? format_number(cost_ms(block, cell)) : std::string("not drawn");
  };
  fields.values["best"] = markdown_code(row.best->culler);
  fields.values["best_ms"] = cost(*row.best);
  fields.values["best_us"] = format_number(decision_us(*row.best));
  fields.values["runner_up"] = markdown_code(row.runner_up->culler);
  fields.values["runner_up_ms"] = cost(*row.runner_up);
  fields.values["soonest"] = markdown_code(row.soonest->culler);
  fields.values["soonest_us"] = format_number(decision_us(*row.soonest));
  fields.values["build_ms"] = format_rounded(row.best->build_ms);
  fields.values["bytes"] = format_bytes(row.best->bytes);
  fields.values["over"] = format_number(row.best->over);
  return fields;
}

/// Of each scene the row of the run with most methods, then frames; in the order of the scenes.
std::vector<const GuideRow*> rows_by_scene(const std::vector<GuideRow>& rows) {
  const auto weight = [](const GuideRow& row) {
    return std::pair(row.block->cells.size(), row.block->frames);
  };
  std::vector<const GuideRow*> shown;
  for (const GuideRow& row : rows) {
    const auto known = std::ranges::find_if(
        shown, [&](const GuideRow* other) { return other->block->scene == row.block->scene; });
    if (known == shown.end()) {
      shown.push_back(&row);
    } else if (weight(row) > weight(**known)) {
      *known = &row;
    }
  }
  return shown;
}

/// "Of the 12 methods that were right on all 9 scenes and paths, take `X`: …"
std::string advice_text(const GuideAdvice& advice) {
  const GuideCandidate& choice = advice.choice;
  const char* const group = advice.group == GuideAdvice::Group::still ? " whose objects stand still"
                            : advice.group == GuideAdvice::Group::moving ? " whose objects move"
                                                                         : "";
  const std::string places = advice.blocks == 1
                                 ? "the one scene and path"
                                 : "all " + std::to_string(advice.blocks) + " scenes and paths";
  const auto wins = static_cast<std::size_t>(choice.wins);
  std::string text = advice.eligible == 1
                         ? "On " + places + group +
                               " there is one method to choose: " + markdown_code(choice.culler)
                         : "Of the " + std::to_string(advice.eligible) +
                               " methods to choose from on " + places + group + ", take " +
                               markdown_code(choice.culler);
  if (choice.guarantee != Guarantee::conservative) {
    text += " (which promises no more than *" + std::string(to_string(choice.guarantee)) + "*)";
  }
  if (wins == advice.blocks) return text + ": nothing costs less there.";
  return text + ": it costs least on " + std::to_string(wins) + " of them, " +
         format_number(choice.mean_ratio) +
         " times as much as the best of each in the geometric mean, and at worst " +
         format_number(choice.worst_ratio) + " times, on " + place_of(*choice.worst_block) + ".";
}

}  // namespace

std::vector<Fields> guide_fields(const std::vector<BlockSummary>& blocks) {
  std::vector<Fields> entries;
  for (const CullerGuide& guide : make_guides(blocks)) {
    Fields entry;
    entry.values["kind"] = kind_of(guide.culls);
    entry.values["run_count"] = std::to_string(guide.rows.size());
    for (const GuideRow* row : rows_by_scene(guide.rows)) {
      entry.lists["rows"].push_back(row_fields(*row));
    }
    auto& advice = entry.lists["advice"];
    for (const GuideAdvice& one : guide.advice) {
      advice.emplace_back();
      advice.back().values["sentence"] = advice_text(one);
    }
    entry.flag("has_advice", !advice.empty());
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace vislab
