#include "report/family_measures.h"

#include <algorithm>
#include <limits>

#include "report/finding.h"

namespace vislab {
namespace {

constexpr const char* between_stages = " > ";

/// Of two ratios to none. Their intervals say nothing of how the two vary together, so the ends
/// that lie farthest apart are taken.
Estimate quotient(const Estimate& a, const Estimate& b) {
  return {a.value / b.value, a.low / b.high, a.high / b.low};
}

bool is_chain(const CellSummary& cell) {
  return cell.canonical.find(between_stages) != std::string::npos;
}

FamilyMethod method_of(const BlockSummary& block, const CellSummary& cell) {
  FamilyMethod method;
  method.cell = &cell;
  method.before = without_last_stage(block, cell);
  if (method.before != nullptr) {
    method.ratio = quotient(cell.against_none, method.before->against_none);
    method.kept = cell.submitted_triangles / method.before->submitted_triangles;
  } else if (is_chain(cell)) {  // what its last stage adds is not known
    method.ratio = Estimate::none();
    method.kept = std::numeric_limits<double>::quiet_NaN();
  } else {
    method.ratio = cell.against_none;
    method.kept = cell.submitted_triangles / static_cast<double>(block.triangles);
  }
  return method;
}

double frames_outside(const CellSummary& cell) {
  const auto found = cell.counters.find("frames_outside");
  return found == cell.counters.end() ? 0.0 : found->second;
}

/// Did a method that knows of cells and portals never have its viewer in any? Then it had nothing
/// to work on: as a rule the scene has no cells. A chain's counters are of all its stages.
bool was_outside_of_all_cells(const FamilyMethod& method) {
  if (method.before != nullptr) {
    return frames_outside(*method.cell) - frames_outside(*method.before) >= 1.0;
  }
  return !is_chain(*method.cell) && frames_outside(*method.cell) >= 1.0;
}

double worth(const BlockSummary& block, const FamilyMethod& method) {
  return block.drawn ? method.ratio.value : method.kept;
}

bool is_better(const BlockSummary& block, const FamilyMethod& a, const FamilyMethod& b) {
  return block.drawn ? is_sooner(block, a.ratio, b.ratio) : worth(block, a) < worth(block, b);
}

}  // namespace

std::string family_of_stage(const std::string& name, const Registry* cullers) {
  if (cullers != nullptr) {
    const auto found = cullers->entries().find(name);
    if (found != cullers->entries().end()) return found->second.info.family;
  }
  return name.substr(0, name.find('.'));
}

std::string family_of(const CellSummary& cell, const Registry* cullers) {
  const std::vector<CullerSpec> chain = parse_chain(cell.canonical);
  return chain.empty() ? "" : family_of_stage(chain.back().name, cullers);
}

const CellSummary* without_last_stage(const BlockSummary& block, const CellSummary& cell) {
  const std::size_t last = cell.canonical.rfind(between_stages);
  if (last == std::string::npos) return nullptr;
  const std::string chain = cell.canonical.substr(0, last);
  const auto found = std::ranges::find_if(block.cells, [&](const CellSummary& other) {
    return other.canonical == chain && other.judged && other.status == ResultCell::Status::done &&
           (!block.drawn || other.against_none.measured());
  });
  return found == block.cells.end() ? nullptr : &*found;
}

FamilyOn family_on(const BlockSummary& block, const std::string& family, const Registry* cullers) {
  FamilyOn found;
  for (const CellSummary& cell : block.cells) {
    if (cell.anchor || !cell.judged || cell.status != ResultCell::Status::done) continue;
    if (family_of(cell, cullers) != family) continue;
    const FamilyMethod method = method_of(block, cell);
    if (!was_outside_of_all_cells(method)) found.methods.push_back(method);
  }
  for (const FamilyMethod& method : found.methods) {
    const CellSummary& cell = *method.cell;
    if (cell.false_px > 0 && (found.worst == nullptr || cell.false_px > found.worst->false_px)) {
      found.worst = &cell;
    }
    if (wrong_pixels(cell) > 0 &&
        (found.most_wrong == nullptr || wrong_pixels(cell) > wrong_pixels(*found.most_wrong))) {
      found.most_wrong = &cell;
    }
    if (!is_free_of_errors(cell)) {
      ++found.erring;
      continue;
    }
    if (cell.guarantee == Guarantee::erroneous || !(worth(block, method) >= 0.0)) continue;
    if (found.best == nullptr || is_better(block, method, *found.best)) {
      found.best = &method;
    }
  }
  return found;
}

bool saves_time(const BlockSummary& block, const FamilyMethod& method) {
  return block.drawn && told_against_none(block, method.ratio) == AgainstNone::faster;
}

}  // namespace vislab
