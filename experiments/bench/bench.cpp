#include "experiments/bench/bench.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/geometry/random.h"
#include "common/scene/error.h"
#include "experiments/analysis/statistics.h"

namespace vislab {
namespace {

constexpr int rounds = 15;
/// A side that takes less is repeated within its round: clocks and caches blur shorter samples.
constexpr double shortest_sample_s = 2e-3;

struct Result {
  double value = 0.0;
  Estimate ratio;
  bool equal = false;
};

double seconds_of(const std::function<void()>& side, int repetitions) {
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < repetitions; ++i) side();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / repetitions;
}

double units_per_second(const std::string& unit) {
  if (unit == "ns") return 1e9;
  if (unit == "us") return 1e6;
  if (unit == "ms") return 1e3;
  return 1.0;
}

Result measure(const BenchCase& bench_case, benchmark::State& state) {
  Result result;
  for ([[maybe_unused]] auto _ : state) {
    const Measurement measurement = bench_case.measure();
    result.value = measurement.value;
    result.equal = measurement.equal;
    state.SetIterationTime(1.0);
  }
  return result;
}

Result contest(const BenchCase& bench_case, benchmark::State& state) {
  const std::unique_ptr<Contest> sides = bench_case.make();
  const auto ours = [&] { sides->ours(); };
  const auto theirs = [&] { sides->theirs(); };
  // The first calls warm up, and show how often a round must repeat.
  const double shortest = std::min(seconds_of(ours, 1), seconds_of(theirs, 1));
  const int repetitions =
      static_cast<int>(std::clamp(shortest_sample_s / std::max(shortest, 1e-9), 1.0, 1e6));
  Result result;
  result.equal = sides->equal();
  Random random(1);
  SampleGrid our_times;
  SampleGrid their_times;
  std::vector<double> all_ours;
  for ([[maybe_unused]] auto _ : state) {
    double our_s = 0.0;
    double their_s = 0.0;
    if (random.below(2) == 0) {
      our_s = seconds_of(ours, repetitions);
      their_s = seconds_of(theirs, repetitions);
    } else {
      their_s = seconds_of(theirs, repetitions);
      our_s = seconds_of(ours, repetitions);
    }
    our_times.push_back({our_s});
    their_times.push_back({their_s});
    all_ours.push_back(our_s);
    state.SetIterationTime(our_s);
  }
  const double typical_s = median(all_ours);
  result.value = sides->work() > 0.0 ? sides->work() / typical_s
                                     : typical_s * units_per_second(bench_case.unit);
  if (!std::isnan(sides->figure())) result.value = sides->figure();
  result.ratio = paired_ratio(our_times, their_times);
  return result;
}

/// What a case's bar is put to.
double held_figure(const BenchCase& bench_case, const Result& result) {
  return bench_case.measure ? result.value : result.ratio.value;
}

const char* name_of(Bar::Side side) { return side == Bar::Side::at_most ? "at most" : "at least"; }

/// Prints nothing: results are printed by run_benchmarks.
class SilentReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& /*runs*/) override {}
};

void print_json(const BenchCase& bench_case, const Result& result) {
  nlohmann::ordered_json line;
  line["bench"] = bench_case.bench;
  line["case"] = bench_case.name;
  line["value"] = result.value;
  line["unit"] = bench_case.unit;
  if (!bench_case.measure) {
    line["against"] = bench_case.against;
    line["ratio"] = result.ratio.value;
    line["ratio_low"] = result.ratio.low;
    line["ratio_high"] = result.ratio.high;
  }
  line["equal"] = result.equal;
  if (bench_case.bar.side != Bar::Side::none) {
    line["bar"] = bench_case.bar.value;
    line["bar_side"] = name_of(bench_case.bar.side);
    line["held"] = bench_case.bar.held_by(held_figure(bench_case, result));
  }
  std::printf("%s\n", line.dump().c_str());
}

void print_row(const BenchCase& bench_case, const Result& result) {
  std::printf("%-12s %-14s %9.4g %-7s ", bench_case.bench.c_str(), bench_case.name.c_str(),
              result.value, bench_case.unit.c_str());
  if (!bench_case.measure) {
    std::printf("%6.3f [%.3f, %.3f] of the time of %s, ", result.ratio.value, result.ratio.low,
                result.ratio.high, bench_case.against.c_str());
  }
  std::printf("%s", result.equal ? "equal" : "NOT EQUAL");
  if (bench_case.bar.side != Bar::Side::none) {
    std::printf(", bar %s %g: %s", name_of(bench_case.bar.side), bench_case.bar.value,
                bench_case.bar.held_by(held_figure(bench_case, result)) ? "held" : "NOT HELD");
  }
  std::printf("\n");
}

}  // namespace

int run_benchmarks(int argc, char** argv, const std::vector<BenchCase>& cases) {
  bool json = false;
  int kept = 1;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--json") == 0) {
      json = true;
    } else {
      argv[kept++] = argv[i];
    }
  }
  argc = kept;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  int code = 0;
  for (const BenchCase& bench_case : cases) {
    const auto run = [&](benchmark::State& state) {
      try {
        const Result result =
            bench_case.measure ? measure(bench_case, state) : contest(bench_case, state);
        (json ? print_json : print_row)(bench_case, result);
        std::fflush(stdout);
        if (!result.equal) code = std::max(code, 1);
      } catch (const InputError& error) {
        std::fprintf(stderr, "%s %s: %s\n", bench_case.bench.c_str(), bench_case.name.c_str(),
                     error.what());
        state.SkipWithError(error.what());
        code = 2;
      }
    };
    benchmark::RegisterBenchmark((bench_case.bench + "/" + bench_case.name).c_str(), run)
        ->UseManualTime()
        ->Iterations(bench_case.measure ? 1 : rounds);
  }
  SilentReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return code;
}

}  // namespace vislab
