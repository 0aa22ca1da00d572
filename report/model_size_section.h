// The report's section on how large models have to be.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/knees.h"
#include "report/template.h"

namespace vislab {

/// Adds the fields of templates/model_size.md: every size sweep that was measured, with the curve
/// of each of its methods and its knees. What is missing stands there with its reason. Charts are
/// those of size_charts_script(). Without such a sweep the section is empty.
void add_model_size_fields(const std::vector<SizeResult>& sizes, Fields& fields);

/// gnuplot commands for all charts of the section; "" without any.
std::string size_charts_script(const std::vector<SizeResult>& sizes);

}  // namespace vislab
