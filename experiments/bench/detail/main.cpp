// ./lab bench detail: what detail culling may lose, and what it costs to ask.
#include "experiments/bench/detail/cases.h"

int main(int argc, char** argv) {
  std::vector<vislab::BenchCase> cases;
  vislab::add_loss_cases(cases);
  vislab::add_time_cases(cases);
  return vislab::run_benchmarks(argc, argv, cases);
}
