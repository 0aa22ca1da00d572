// ./lab bench depth: the software depth buffer and the cullers that use it.
#include <algorithm>
#include <string>

#include "experiments/bench/depth/cases.h"

int main(int argc, char** argv) {
  std::vector<vislab::BenchCase> cases;
  vislab::add_city_cases(cases);
  vislab::add_growth_cases(cases);
  const bool plain = argc == 1;
  const int code = vislab::run_benchmarks(argc, argv, cases);
  if (plain && code < 2) vislab::print_city_table();
  return code;
}
