#include <cmath>

#include "experiments/analysis/guide.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {
namespace {

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
  fields.values["best"] = markdown_code(row.best->culler);
  fields.values["best_us"] = format_number(decision_us(*row.best));
  fields.values["runner_up"] = markdown_code(row.runner_up->culler);
  fields.values["runner_up_us"] = format_number(decision_us(*row.runner_up));
  fields.values["build_ms"] = format_rounded(row.best->build_ms);
  fields.values["bytes"] = format_bytes(row.best->bytes);
  fields.values["over"] = format_number(row.best->over);
  fields.values["best_frame"] =
      row.best_frame == nullptr ? "not drawn" : markdown_code(row.best_frame->culler);
  fields.values["frame_ms"] =
      row.best_frame == nullptr ? "–" : format_number(row.best_frame->frame_ms.median.value);
  return fields;
}

/// "On all 9 scenes and paths, `X` …"
std::string advice_text(const GuideAdvice& advice) {
  const GuideCandidate& choice = advice.choice;
  const char* const group = advice.group == GuideAdvice::Group::still ? " whose objects stand still"
                            : advice.group == GuideAdvice::Group::moving ? " whose objects move"
                                                                         : "";
  const auto wins = static_cast<std::size_t>(choice.wins);
  std::string text = "On the " + std::to_string(advice.blocks) +
                     (advice.blocks == 1 ? " scene" : " scenes") + group + ", take " +
                     markdown_code(choice.culler) + ": it decides soonest on " +
                     std::to_string(wins) + " of them";
  if (wins == advice.blocks) return text + ".";
  return text + ", takes " + format_number(choice.mean_ratio) +
         " times as long as the best of each in the geometric mean, and at worst " +
         format_number(choice.worst_ratio) + " times, on " + place_of(*choice.worst_block) + ".";
}

}  // namespace

std::vector<Fields> guide_fields(const std::vector<BlockSummary>& blocks) {
  std::vector<Fields> entries;
  for (const FamilyGuide& guide : make_guides(blocks)) {
    Fields entry;
    entry.values["family"] = markdown_text(guide.family);
    for (const GuideRow& row : guide.rows) entry.lists["rows"].push_back(row_fields(row));
    auto& advice = entry.lists["advice"];
    for (const GuideAdvice& one : guide.advice) {
      advice.emplace_back();
      advice.back().values["sentence"] = advice_text(one);
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace vislab
