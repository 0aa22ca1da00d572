// The report's chapters on families of methods: what the source-independent templates say, filled
// with what was measured of the family's methods.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// What the report has of single families only, by family: the texts of the templates in the folder
/// `templates`/FAMILY, in the order of their names, filled with `fields`. A family whose texts are
/// all empty is not in it. Throws InputError like fill_template().
using FamilyTexts = std::map<std::string, std::string>;
FamilyTexts family_texts(const std::filesystem::path& templates, const Fields& fields);

/// The families of which a method was measured, oracles and anchors apart, or that have a text:
/// those of `order` first, in that order, then the others by name.
std::vector<std::string> measured_families(const ReportInput& input,
                                           const std::vector<std::string>& order,
                                           const FamilyTexts& texts);

/// A chart of a family's methods on one block.
struct FamilyChart {
  std::string family;
  const BlockSummary* block = nullptr;
  std::string file;  // "family-frustum-1.svg"
};

/// For each family the blocks on which most of its methods have a point, those that lie on curves
/// over a dial counting twice, and of these the ones on which the family saves most: at most two,
/// of different scenes. Blocks `in_diagrams` are left out. Beside the family's methods stand the
/// chains that they were added to.
std::vector<FamilyChart> family_charts(const ReportInput& input,
                                       const std::vector<const BlockSummary*>& in_diagrams,
                                       const std::vector<std::string>& families);

std::string family_chart_script(const std::vector<FamilyChart>& charts, const Registry* cullers);

/// The list "families", each with the value "chapter": templates/families/NAME.md, or generic.md
/// for a family without one, in which {{measurements}} is templates/families/measured.md, and
/// {{sections}} in that the family's own text. Writes pictures into `work`.
void add_family_fields(const ReportInput& input,
                       const std::vector<const BlockSummary*>& in_diagrams,
                       const std::vector<FamilyChart>& charts,
                       const std::vector<std::string>& families, const FamilyTexts& texts,
                       const std::filesystem::path& templates, const std::filesystem::path& work,
                       Fields& fields);

}  // namespace vislab
