// The report's museum of errata: what the sources got wrong, and every wrong variant beside a right
// method with the damage that was measured.
#pragma once

#include <filesystem>

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Adds what templates/errata.md asks for; pictures go into `folder`. Nothing is shown if no wrong
/// variant was measured on any block, stress sweeps included; one that was not says so.
void add_errata_fields(const ReportInput& input, const std::filesystem::path& folder,
                       Fields& fields);

}  // namespace vislab
