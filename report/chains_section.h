// The report's section on which chain to use for which scene.
#pragma once

#include "report/report.h"
#include "report/template.h"

namespace vislab {

/// Adds what templates/chains.md asks for: the fastest on each scene, the families beside each
/// other, and a guide for each kind of culling.
void add_chain_fields(const ReportInput& input, Fields& fields);

}  // namespace vislab
