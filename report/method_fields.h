// The report's method pages, from the cullers' own declarations.
#pragma once

#include <string_view>
#include <vector>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// One entry for each registered culler, measured or not, by name; empty without a registry.
std::vector<Fields> method_fields(const ReportInput& input);

/// Puts citations behind the sources in `markdown` fields named "source": a source that names the
/// author and the year of an entry of the bibliography, as in "Clark 1976, …" for clark1976, gets
/// "[@clark1976]". `bibliography` is BibTeX text.
void cite_sources(std::string_view bibliography, std::vector<Fields>& methods);

}  // namespace vislab
