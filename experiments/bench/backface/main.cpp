// ./lab bench backface: cullers of back faces against each other and against other libraries'. One
// thread.
#include "experiments/bench/backface/cases.h"

int main(int argc, char** argv) {
  std::vector<vislab::BenchCase> cases;
  vislab::add_cluster_cases(cases);
  vislab::add_cone_cases(cases);
  vislab::add_mask_cases(cases);
  vislab::add_polygon_cases(cases);
  return vislab::run_benchmarks(argc, argv, cases);
}
