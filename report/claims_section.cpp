#include "report/claims_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "report/format.h"

namespace vislab {
namespace {

/// "mixed, mixed_moving, 512 × 512, 24 frames": what our figure was measured on.
std::string place_of(const PublishedRow& row, const OwnFigure& own) {
  std::string place;
  if (own.block == nullptr) {
    place = row.scene + (row.path.empty() ? "" : ", " + row.path);
  } else {
    const BlockSummary& block = *own.block;
    place = block.scene + (block.path.empty() ? "" : ", " + block.path) + ", " +
            std::to_string(block.viewport.width) + " × " + std::to_string(block.viewport.height) +
            ", " + std::to_string(block.frames) + " frames";
    if (!row.device.empty()) place += ", " + block.device;
  }
  if (row.compares_places()) {
    place += ", against " + (row.against_scene.empty() ? row.scene : row.against_scene) + ", " +
             (row.against_path.empty() ? row.path : row.against_path);
  }
  if (!row.stand_in.empty()) place += ": " + row.stand_in;
  if (own.cell != nullptr && own.is_out_of_reach(row)) {
    place += ". Drawing nothing but what is visible gives " +
             (row.is_share() ? format_percent(own.reach) : format_number(own.reach)) +
             " there: the scene cannot show more";
  }
  if (!row.cannot_be_told.empty()) return place + ". " + row.cannot_be_told;
  if (own.block != nullptr && noise_decides(row, own)) {
    place += own.block->noise.measured()
                 ? ". None against itself gives " + format_estimate(own.block->noise) +
                       " there: the difference may be noise"
                 : ". There is no control, so all of it may be noise";
  }
  return place;
}

bool has_interval(const PublishedRow& row, const OwnFigure& own) {
  return row.compares && own.ratio.low < own.ratio.high;
}

std::string own_text(const PublishedRow& row, const OwnFigure& own) {
  if (own.cell == nullptr) return "–";
  if (row.is_share()) return format_percent(own.ratio.value);
  if (has_interval(row, own)) return format_estimate(own.ratio);
  const double value = own.ratio.value;
  const bool is_low_nearer = std::abs(value - row.accept.low) < std::abs(value - row.accept.high);
  return format_apart(value, is_low_nearer ? row.accept.low : row.accept.high);
}

/// "0.2 to 0.5", "at least 1", "at most 1": what of ours confirms the claim.
std::string accept_text(const PublishedRow& row, const OwnFigure& own) {
  if (!row.cannot_be_told.empty()) return "–";
  const auto text = [&](double bound) {
    if (row.is_share()) return format_percent(bound);
    const bool is_near = own.cell != nullptr && !has_interval(row, own) &&
                         format_number(bound) == format_number(own.ratio.value);
    return is_near ? format_apart(bound, own.ratio.value) : format_number(bound);
  };
  const double low = row.accept.low;
  const double high = row.accept.high;
  const bool no_low = !(low > 0.0);
  if (std::isinf(high)) return no_low ? "anything" : "at least " + text(low);
  if (no_low) return "at most " + text(high);
  return low == high ? text(low) : text(low) + " to " + text(high);
}

/// "`a` against `b`, frame_ms".
std::string method_text(const PublishedRow& row) {
  const std::string method = markdown_code(row.short_culler);
  const std::string compared =
      row.compares ? method + " against " + markdown_code(row.short_against) : method;
  switch (row.metric) {
    case PublishedRow::Metric::culled:
      return compared + ", share of all triangles";
    case PublishedRow::Metric::decision_share:
      return compared + ", (update_us + cull_us) ÷ frame_ms";
    case PublishedRow::Metric::cull_us:
      return compared + ", cull_us";
    case PublishedRow::Metric::named:
      return compared + ", " + markdown_text(row.metric_name);
    case PublishedRow::Metric::frame_ms:
      break;
  }
  return compared + ", frame_ms";
}

std::string verdict_text(ClaimVerdict verdict) {
  const std::string text = to_string(verdict);
  const bool is_told = verdict == ClaimVerdict::confirmed || verdict == ClaimVerdict::not_confirmed;
  return is_told ? "**" + text + "**" : text;
}

/// What every claim has, measured or not.
Fields claim_fields(const PublishedRow& row) {
  Fields fields;
  fields.values["what"] = markdown_text(row.what);
  fields.values["table"] = markdown_text(row.table);
  fields.values["published"] =
      row.published.empty() ? format_number(row.ratio()) + " (" + format_number(row.without_fps) +
                                  " → " + format_number(row.with_fps) + " frames a second)"
                            : markdown_text(row.published);
  return fields;
}

Fields untold_fields(const PublishedRow& row) {
  Fields fields = claim_fields(row);
  fields.values["reason"] = markdown_text(row.cannot_be_told);
  return fields;
}

Fields row_fields(const PublishedRow& row, const OwnFigure& own) {
  Fields fields = claim_fields(row);
  fields.values["verdict"] = verdict_text(verdict_of(row, own));
  fields.values["accept"] = accept_text(row, own);
  fields.values["own"] = own_text(row, own);
  fields.values["scene"] = markdown_text(place_of(row, own));
  fields.values["method"] = method_text(row);
  return fields;
}

/// Rows that make the same claim of several scenes say only once what they share.
void shorten_repeated(std::vector<Fields>& rows) {
  const std::vector<std::string> shared{"published", "table", "accept", "method"};
  for (std::size_t i = rows.size(); i-- > 1;) {
    const auto is_same = [&](const std::string& name) {
      return rows[i].values.at(name) == rows[i - 1].values.at(name);
    };
    if (!std::ranges::all_of(shared, is_same)) continue;
    for (const std::string& name : shared) rows[i].values[name] = "″";
  }
  for (Fields& row : rows) row.flag("is_repeated", row.values.at("method") == "″");
}

using Counts = std::array<std::size_t, 4>;  // by ClaimVerdict

void add_counts(const Counts& counts, const std::string& prefix, Fields& fields) {
  const auto set = [&](const char* name, ClaimVerdict verdict) {
    fields.values[prefix + name] = std::to_string(counts[static_cast<std::size_t>(verdict)]);
  };
  set("confirmed", ClaimVerdict::confirmed);
  set("not_confirmed", ClaimVerdict::not_confirmed);
  set("cannot_be_told", ClaimVerdict::cannot_be_told);
  set("not_run", ClaimVerdict::not_run);
}

}  // namespace

void add_claim_fields(const ReportInput& input, Fields& fields) {
  Counts all{};
  std::size_t claims = 0;
  bool any = false;
  auto& sources = fields.lists["claim_sources"];
  auto& measured = fields.lists["measured_sources"];
  auto& untold = fields.lists["untold_claims"];
  for (const PublishedFigures& figures : input.published) {
    Counts counts{};
    Fields entry;
    auto& rows = entry.lists["rows"];
    std::vector<Fields> not_run;
    for (const PublishedRow& row : figures.rows) {
      const OwnFigure own = own_figure(row, input.blocks);
      any |= own.cell != nullptr;
      const ClaimVerdict verdict = verdict_of(row, own);
      ++counts[static_cast<std::size_t>(verdict)];
      if (!row.cannot_be_told.empty() && own.cell == nullptr) {
        untold.push_back(untold_fields(row));
      } else {
        (verdict == ClaimVerdict::not_run ? not_run : rows).push_back(row_fields(row, own));
      }
    }
    // Where most were run, what is missing is a gap, and stands in the table.
    const bool is_folded = not_run.size() > rows.size();
    if (!is_folded) std::ranges::move(not_run, std::back_inserter(rows));
    shorten_repeated(rows);
    entry.flag("is_folded", is_folded);
    const bool has_rows = !rows.empty();
    for (std::size_t i = 0; i < counts.size(); ++i) all[i] += counts[i];
    claims += figures.rows.size();
    entry.values["title"] = markdown_text(figures.title);
    entry.values["source"] = markdown_text(figures.source);
    entry.values["note"] = markdown_text(figures.note);
    entry.values["count"] = std::to_string(figures.rows.size());
    add_counts(counts, "", entry);
    if (has_rows) measured.push_back(entry);
    sources.push_back(std::move(entry));
  }
  fields.flag("has_untold_claims", !untold.empty());
  fields.flag("has_claims", any);
  fields.values["claim_count"] = std::to_string(claims);
  add_counts(all, "claims_", fields);
  fields.flag("has_claims_not_run", all[static_cast<std::size_t>(ClaimVerdict::not_run)] > 0);
}

}  // namespace vislab
