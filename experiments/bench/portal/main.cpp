// ./lab bench portal: cells, portals and potentially visible sets of real worlds.
#include "experiments/bench/portal/cases.h"

int main(int argc, char** argv) {
  std::vector<vislab::BenchCase> cases;
  vislab::add_walk_cases(cases);
  vislab::add_set_cases(cases);
  return vislab::run_benchmarks(argc, argv, cases);
}
