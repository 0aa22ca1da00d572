// Where methods break: the figures of a stress sweep, and the first value of its dial at which a
// method is beyond the limit.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/analysis/summary.h"
#include "experiments/matrix/sweep.h"

namespace vislab {

/// A method at one value of the dial.
struct SweepPoint {
  enum class State { missing, failed, measured };

  State state = State::missing;
  std::string reason;   // of a failure
  double figure = 0.0;  // of the sweep's metric or counter; NaN if not measured
  Guarantee guarantee = Guarantee::conservative;
  bool breaks_promise = false;
};

/// Did a judged method not hold what it promises? A conservative one must not lose an undisputed
/// pixel, jittered sample or object, nor something that is seen from a cell; an image_exact one
/// must not get a pixel wrong: of the image that it paints; else of the device's image; else
/// (nothing was drawn) of truth.
bool breaks_its_promise(const CellSummary& cell);

/// What a sweep says of one of its methods.
struct SweepVerdict {
  /// `unknown`: so much of the sweep is missing that it cannot be told.
  enum class Agreement { nothing_expected, agrees, differs, unknown };

  std::string culler;                             // as SweepMethod::culler
  Guarantee guarantee = Guarantee::conservative;  // the weakest of all values
  std::vector<SweepPoint> points;                 // one for each value of the dial
  double limit = 0.0;  // the worst figure that is not beyond it; NaN if unknown
  /// The first value of the dial whose figure is beyond the limit, or at which the method failed.
  std::optional<std::size_t> break_point;
  /// Every value up to the break point, or without one every value, was measured or failed.
  bool is_complete = false;
  std::optional<std::size_t> worst, best;  // values of the dial with the worst, best figure
  std::optional<SweepExpectation> expectation;
  Agreement agreement = Agreement::nothing_expected;
  /// "METHOD has no counter 'x'; it has a, b", or empty.
  std::string missing_counter;
  /// The first value of the dial at which breaks_its_promise() says so.
  std::optional<std::size_t> broken_promise;

  bool was_measured() const;
  /// A promise is broken, or a method breaks that never should.
  /// A break elsewhere than predicted is a finding, not an alarm.
  bool is_alarming() const {
    return broken_promise || (agreement == Agreement::differs && expectation->never);
  }
};

struct SweepResult {
  Sweep sweep;
  std::vector<SweepVerdict> verdicts;  // one for each of the sweep's methods, in their order

  bool was_measured() const;
};

/// The cell of a canonical chain at a value of the dial (by index); null if there is none.
using CellAtValue = std::function<const CellSummary*(std::size_t value, const std::string& chain)>;

SweepResult find_break_points(const Sweep& sweep, const CellAtValue& cell);

/// Where [limit] gives only a metric: may its figure be twice that at the first value? Else it may
/// be no more than 0.
bool may_double(const std::string& metric);

/// What is wrong if all methods were measured and none has the counter that the sweep asks for;
/// else empty.
std::string missing_counter(const SweepResult& result);

/// "agrees", "differs", "unknown", or "" where nothing is expected.
std::string to_string(SweepVerdict::Agreement agreement);

}  // namespace vislab
