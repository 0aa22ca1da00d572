// The report's chapters on families of methods: what the source-independent templates say, filled
// with what was measured of the family's methods.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// The family of the chain's last stage: what stands before it only prepares.
std::string family_of(const CellSummary& cell, const Registry* cullers);

/// The families of which a method was measured, oracles and anchors apart: those of `order` first,
/// in that order, then the others by name.
std::vector<std::string> measured_families(const ReportInput& input,
                                           const std::vector<std::string>& order);

/// A chart of a family's methods on one block.
struct FamilyChart {
  std::string family;
  const BlockSummary* block = nullptr;
  std::string file;  // "family-frustum-1.svg"
};

/// For each family the blocks on which most of its methods have a point, those that lie on curves
/// over a dial counting twice: at most two, of different scenes. Blocks `in_diagrams` are left out.
std::vector<FamilyChart> family_charts(const ReportInput& input,
                                       const std::vector<const BlockSummary*>& in_diagrams,
                                       const std::vector<std::string>& families);

std::string family_chart_script(const std::vector<FamilyChart>& charts, const Registry* cullers);

/// The list "families", each with the value "chapter": templates/families/NAME.md, or generic.md
/// for a family without one, in which {{measurements}} is templates/families/measured.md. Writes
/// pictures into `work`.
void add_family_fields(const ReportInput& input,
                       const std::vector<const BlockSummary*>& in_diagrams,
                       const std::vector<FamilyChart>& charts,
                       const std::vector<std::string>& families,
                       const std::filesystem::path& templates, const std::filesystem::path& work,
                       Fields& fields);

}  // namespace vislab
