// ./lab bench occlusion: methods that ask the device what is hidden.
#include "experiments/bench/occlusion/cases.h"

int main(int argc, char** argv) {
  std::vector<vislab::BenchCase> cases;
  vislab::add_coherent_cases(cases);
  vislab::add_prediction_cases(cases);
  vislab::add_bunch_cases(cases);
  return vislab::run_benchmarks(argc, argv, cases);
}
