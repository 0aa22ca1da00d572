// What all bench_* programs share: contests between this lab's code and another way to the same
// result, timed in pairs in one run.
//
// A round runs both sides, in an order drawn anew, so that whatever else the machine does falls on
// both; the ratio of a round is ours / theirs, and what is reported is the median of the rounds'
// ratios with a 95 % interval. Google Benchmark runs the rounds and brings its flags
// (--benchmark_filter and so on).
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace vislab {

/// Two sides of one case, set up and ready. All functions may be called again and again.
class Contest {
 public:
  virtual ~Contest() = default;
  /// The lab's side, once.
  virtual void ours() = 0;
  /// The other side, once.
  virtual void theirs() = 0;
  /// After both ran: are the results the same (or within the guarantee)? Not timed.
  virtual bool equal() = 0;
  /// For rates: how much one call does, in the unit times seconds (1e6 rays for "Mray/s"). 0: the
  /// value is the time of a call, and the unit a unit of time, "ns", "us" or "ms".
  virtual double work() const { return 0.0; }
  /// What is reported in place of our time or rate, once equal() has been asked: how much of
  /// something our side finds, say, beside the ratio of the times. NaN: the time or rate.
  virtual double figure() const { return std::numeric_limits<double>::quiet_NaN(); }
};

/// A figure that is no comparison: a rate of growth, say.
struct Measurement {
  double value = 0.0;
  bool equal = false;  // were the results on the way what they had to be?
};

/// What a case is held to: a contest's ratio, a measurement's value.
struct Bar {
  enum class Side { none, at_most, at_least };
  Side side = Side::none;
  double value = 0.0;

  static Bar at_most(double value) { return {Side::at_most, value}; }
  static Bar at_least(double value) { return {Side::at_least, value}; }
  bool held_by(double figure) const {
    return side == Side::none || (side == Side::at_most ? figure <= value : figure >= value);
  }
};

struct BenchCase {
  std::string bench;    // what is measured: a culler's name, or "truth"
  std::string name;     // the case
  std::string unit;     // of our value
  std::string against;  // the other's name; none if it is a measurement
  /// Sets the case up when its turn comes; it is thrown away before the next.
  std::function<std::unique_ptr<Contest>()> make;
  /// Instead of a contest: takes the figure, once.
  std::function<Measurement()> measure = {};
  Bar bar = {};
};

/// Runs all cases that the flags select and prints a table, or with `--json` one object a line:
/// bench, case, value, unit, against, ratio, ratio_low, ratio_high, equal; measurements are without
/// against and the ratios. Cases with a bar also say bar, bar_side ("at most" or "at least") and
/// held. Returns the exit code: 0; 1 if results differed; 2 for unknown flags or wrong input. A bar
/// that is not held does not count there: on a busy machine that is no fault of the program.
int run_benchmarks(int argc, char** argv, const std::vector<BenchCase>& cases);

}  // namespace vislab
