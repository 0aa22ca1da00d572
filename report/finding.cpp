#include "report/finding.h"

#include <algorithm>
#include <cmath>

#include "report/format.h"

namespace vislab {
namespace {

/// The one of the two for which `value` is less; `a` may be null.
template <typename Value>
const CellSummary* lesser(const CellSummary* a, const CellSummary* b, Value&& value) {
  if (a == nullptr) return b;
  return value(*b) < value(*a) ? b : a;
}

double time_ratio(const CellSummary& cell) { return cell.against_none.value; }
double over(const CellSummary& cell) { return cell.over; }

/// One that is told the truth itself (oracle.rays is told what other rays find).
bool is_oracle(const CellSummary& cell) {
  return cell.anchor && cell.canonical != "none" && cell.guarantee != Guarantee::approximate;
}

FindingKind kind_of(const BlockSummary& block, const Estimate& ratio) {
  switch (told_against_none(block, ratio)) {
    case AgainstNone::faster:
      return FindingKind::saves;
    case AgainstNone::slower:
      return FindingKind::loses;
    case AgainstNone::alike:
      break;
  }
  return FindingKind::within_noise;
}

/// Where nothing is drawn: what counts is what is left over.
Finding find_undrawn(const BlockSummary& block) {
  Finding finding;
  finding.kind = FindingKind::not_drawn;
  for (const CellSummary& cell : block.cells) {
    if (cell.anchor || cell.status != ResultCell::Status::done) continue;
    if (!cell.judged || std::isnan(cell.over)) continue;
    const bool is_clean = is_free_of_errors(cell);
    if (is_clean && cell.guarantee == Guarantee::erroneous) continue;
    const CellSummary*& place = is_clean ? finding.best : finding.erring;
    place = lesser(place, &cell, over);
  }
  if (finding.best != nullptr && finding.erring != nullptr &&
      finding.erring->over >= finding.best->over) {
    finding.erring = nullptr;
  }
  return finding;
}

/// What is wrong with the method, the worst first: pixels, objects between them, or rays.
void add_errors(const CellSummary& cell, Fields& fields) {
  const bool pixels = wrong_pixels(cell) > 0;
  const bool objects = !pixels && cell.false_objects > 0;
  fields.flag("erring_pixels", pixels);
  fields.flag("erring_objects", objects);
  fields.flag("erring_rays", !pixels && !objects);
  fields.values["fast_errors_of"] = format_of(wrong_pixels(cell), cell.pixels);
  fields.values["fast_objects"] = format_count(cell.false_objects);
  fields.values["fast_rays_of"] = format_of(cell.false_jittered, cell.jittered);
}

}  // namespace

std::uint64_t wrong_pixels(const CellSummary& cell) {
  return std::max({cell.false_px, cell.drawn ? cell.image_px : 0, cell.surface_px});
}

Finding find(const BlockSummary& block) {
  if (!block.drawn) return find_undrawn(block);
  Finding finding;
  for (const CellSummary& cell : block.cells) {
    if (cell.status != ResultCell::Status::done || !cell.against_none.measured()) continue;
    if (!cell.judged) continue;
    if (is_oracle(cell) && wrong_pixels(cell) == 0) {
      finding.oracle = lesser(finding.oracle, &cell, time_ratio);
    }
    if (cell.anchor) continue;
    const bool is_clean = is_free_of_errors(cell);
    if (is_clean && cell.guarantee == Guarantee::erroneous) continue;
    if (!is_clean) {
      finding.erring = lesser(finding.erring, &cell, time_ratio);
    } else if (finding.best == nullptr ||
               is_sooner(block, cell.against_none, finding.best->against_none)) {
      finding.best = &cell;
    }
  }
  if (finding.best != nullptr) {
    finding.kind = kind_of(block, finding.best->against_none);
  } else if (finding.erring != nullptr) {
    finding.kind = FindingKind::none_clean;
  }
  const double bar =
      finding.best == nullptr ? 1.0 : std::min(1.0, finding.best->against_none.value);
  if (finding.erring != nullptr && finding.erring->against_none.value >= bar) {
    finding.erring = nullptr;
  }
  return finding;
}

Fields finding_fields(const BlockSummary& block, const std::string& scene) {
  const Finding finding = find(block);
  Fields fields;
  fields.values["scene"] = scene;
  fields.flag("saves", finding.kind == FindingKind::saves);
  fields.flag("within_noise", finding.kind == FindingKind::within_noise);
  fields.flag("loses", finding.kind == FindingKind::loses);
  fields.flag("none_clean", finding.kind == FindingKind::none_clean);
  fields.flag("no_method", finding.kind == FindingKind::no_method);
  const bool drawn = finding.kind != FindingKind::not_drawn;
  fields.flag("not_drawn", !drawn);
  fields.flag("undrawn_best", !drawn && finding.best != nullptr);
  if (finding.best != nullptr) {
    fields.values["over"] = format_number(finding.best->over);
    fields.values["cull_us"] = format_number(finding.best->cull_us.median.value);
    const Estimate& ratio = finding.best->against_none;
    fields.values["best"] = markdown_code(finding.best->culler);
    fields.values["errors_of"] = format_of(wrong_pixels(*finding.best), finding.best->pixels);
    fields.values["saving"] = format_percent(1.0 - ratio.value);
    fields.values["ratio"] = format_number(ratio.value);
    fields.values["interval"] = finding.kind == FindingKind::saves
                                    ? format_percents(1.0 - ratio.high, 1.0 - ratio.low)
                                    : format_number(ratio.low) + "–" + format_number(ratio.high);
    fields.values["noise"] = block.noise.measured()
                                 ? "±" + format_percent(std::max(std::fabs(block.noise.low - 1.0),
                                                                 std::fabs(block.noise.high - 1.0)))
                                 : "not measured";
  }
  fields.flag("oracle", finding.oracle != nullptr && finding.oracle->against_none.value < 1.0);
  if (finding.oracle != nullptr) {
    fields.values["oracle"] = markdown_code(finding.oracle->culler);
    fields.values["oracle_saving"] = format_percent(1.0 - finding.oracle->against_none.value);
  }
  fields.flag("erring", finding.erring != nullptr);
  fields.flag("erring_drawn", drawn);
  if (finding.erring != nullptr) {
    fields.values["fast"] = markdown_code(finding.erring->culler);
    fields.values["fast_ratio"] = format_number(finding.erring->against_none.value);
    fields.values["fast_over"] = format_number(finding.erring->over);
    fields.values["fast_cull_us"] = format_number(finding.erring->cull_us.median.value);
    add_errors(*finding.erring, fields);
  }
  return fields;
}

}  // namespace vislab
