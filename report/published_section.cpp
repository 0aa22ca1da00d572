#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {
namespace {

/// "mixed, mixed_moving, 512 × 512, 24 frames": what our figure was measured on.
std::string place_of(const PublishedRow& row, const OwnFigure& own) {
  if (own.block == nullptr) return row.scene + (row.path.empty() ? "" : ", " + row.path);
  const BlockSummary& block = *own.block;
  return block.scene + (block.path.empty() ? "" : ", " + block.path) + ", " +
         std::to_string(block.viewport.width) + " × " + std::to_string(block.viewport.height) +
         ", " + std::to_string(block.frames) + " frames";
}

std::string own_text(const PublishedRow& row, const OwnFigure& own) {
  if (own.cell == nullptr) return "not run";
  if (row.is_share()) return format_percent(own.ratio.value);
  return row.compares ? format_estimate(own.ratio) : format_number(own.ratio.value);
}

/// "`a` against `b`, frame_ms".
std::string method_text(const PublishedRow& row) {
  const std::string method = markdown_code(row.short_culler);
  const std::string compared = method + " against " + markdown_code(row.short_against);
  switch (row.metric) {
    case PublishedRow::Metric::culled:
      return method + ", share of all triangles";
    case PublishedRow::Metric::decision_share:
      return method + ", (update_us + cull_us) ÷ frame_ms";
    case PublishedRow::Metric::cull_us:
      return compared + ", cull_us";
    case PublishedRow::Metric::named:
      return (row.compares ? compared : method) + ", " + markdown_text(row.metric_name);
    case PublishedRow::Metric::frame_ms:
      break;
  }
  return compared + ", frame_ms";
}

Fields row_fields(const PublishedRow& row, const OwnFigure& own) {
  Fields fields;
  fields.values["what"] = markdown_text(row.what);
  fields.values["table"] = markdown_text(row.table);
  if (row.published.empty()) {
    fields.values["fps"] = format_number(row.without_fps) + " → " + format_number(row.with_fps);
    fields.values["published"] = format_number(row.ratio());
  } else {
    fields.values["fps"] = "–";
    fields.values["published"] = markdown_text(row.published);
  }
  if (!row.cannot_be_told.empty()) {
    fields.values["own"] = "cannot be told";
    fields.values["scene"] = "–";
    fields.values["method"] = markdown_text(row.cannot_be_told);
    return fields;
  }
  fields.values["own"] = own_text(row, own);
  fields.values["scene"] = markdown_text(place_of(row, own));
  fields.values["method"] = method_text(row);
  return fields;
}

}  // namespace

std::vector<Fields> published_fields(const std::vector<PublishedFigures>& published,
                                     const std::vector<BlockSummary>& blocks) {
  std::vector<Fields> entries;
  for (const PublishedFigures& figures : published) {
    Fields entry;
    bool any = false;
    for (const PublishedRow& row : figures.rows) {
      const OwnFigure own = own_figure(row, blocks);
      any |= own.cell != nullptr;
      entry.lists["rows"].push_back(row_fields(row, own));
    }
    if (!any) continue;
    entry.values["title"] = markdown_text(figures.title);
    entry.values["source"] = markdown_text(figures.source);
    entry.values["note"] = markdown_text(figures.note);
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace vislab
