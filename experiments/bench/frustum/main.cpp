// ./lab bench frustum: frustum cullers against each other, against other libraries' and against
// bare loops. One thread.
#include "experiments/bench/frustum/cases.h"

int main(int argc, char** argv) {
  std::vector<vislab::BenchCase> cases;
  vislab::add_flat_cases(cases);
  vislab::add_bvh_cases(cases);
  vislab::add_moving_cases(cases);
  return vislab::run_benchmarks(argc, argv, cases);
}
