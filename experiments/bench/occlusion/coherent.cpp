// CHC++ and what it is held to: frame times beside its ideal's, queries and changes of state beside
// stop-and-wait's, and how much frame times scatter.
#include <algorithm>
#include <map>
#include <numeric>
#include <span>

#include "experiments/analysis/statistics.h"
#include "experiments/bench/occlusion/cases.h"
#include "experiments/bench/occlusion/tour.h"

namespace vislab {
namespace {

constexpr const char* chcpp = "occlusion.chcpp";
constexpr const char* aligned = "occlusion.chcpp[retest=aligned]";
constexpr const char* ideal = "oracle[level=node]";
constexpr const char* frustum_only = "frustum.bvh";
constexpr const char* stop_and_wait = "frustum.bvh > occlusion.stop_and_wait";

struct Place {
  const char* scene;
  const char* path;
  const char* reference;  // what scatters in the frame times of CHC++ is seen beside this
  bool cuts;              // the path is a row of fixed views; else the camera moves on steadily
  std::string name() const { return std::string(scene) + ", " + path; }
};

constexpr Place hiding[] = {{"city_heavy", "city_slow", ideal, false},
                            {"plant_heavy", "plant_slow", ideal, false}};
constexpr Place open[] = {{"open_field", "open_field_above", frustum_only, false},
                          {"open_field_heavy", "open_field_above", frustum_only, false}};
constexpr Place with_cuts[] = {{"city_heavy", "city_cut", ideal, true},
                               {"plant_heavy", "plant_cut", ideal, true}};

/// Walks through a place, and how long their frames took.
class Visits {
 public:
  explicit Visits(const Place& place) : tour_(place.scene, place.path) {}

  Tour& tour() { return tour_; }

  /// Frame times of walks by a method. Those of CHC++ and `reference` are taken in turn, so that
  /// whatever else the machine does falls on both.
  const SampleGrid& frame_ms(const std::string& spec, const char* reference) {
    if (times_.contains(spec)) return times_.at(spec);
    const bool both = spec == chcpp || spec == reference;
    const std::vector<std::string> turns =
        both ? std::vector<std::string>{chcpp, reference} : std::vector{spec};
    for (int walk = 0; walk < walks; ++walk) {
      for (const std::string& each : turns) {
        const PathRun run = tour_.walk(each);
        times_[each].push_back(run.round.frame_ms);
        if (walk == 0) right_[each] = tour_.right(run);
      }
    }
    return times_.at(spec);
  }
  bool right(const std::string& spec) const { return right_.at(spec); }

 private:
  static constexpr int walks = 7;

  Tour tour_;
  std::map<std::string, SampleGrid> times_;
  std::map<std::string, bool> right_;
};

/// Only one place's scene is kept: truth and meshes are large. The cases own it, so that its device
/// goes before Mesa, which is torn down when the program ends.
class Current {
 public:
  Visits& visits(const Place& place) {
    if (name_ != place.name()) {
      visits_.reset();
      visits_ = std::make_unique<Visits>(place);
      name_ = place.name();
    }
    return *visits_;
  }
  Tour& tour(const Place& place) { return visits(place).tour(); }

 private:
  std::string name_;
  std::unique_ptr<Visits> visits_;
};

/// A method against another one on whole walks; reports the median time of a frame.
class WalkContest : public Contest {
 public:
  WalkContest(Tour& tour, const char* method, const char* other)
      : tour_(tour), method_(method), other_(other) {
    tour_.walk(method_);  // cullers are built outside of the contest
    tour_.walk(other_);
  }
  void ours() override { ours_ = tour_.walk(method_); }
  void theirs() override { theirs_ = tour_.walk(other_); }
  bool equal() override {
    frame_ms_ = median(ours_.round.frame_ms);
    return tour_.right(ours_) && tour_.right(theirs_);
  }
  double figure() const override { return frame_ms_; }

 private:
  Tour& tour_;
  const char* method_;
  const char* other_;
  PathRun ours_, theirs_;
  double frame_ms_ = 0.0;
};

std::uint64_t count(const PathRun& run, const char* counter) {
  std::uint64_t all = 0;
  for (const CellFrame& frame : run.frames) all += frame.counters.at(counter);
  return all;
}

/// Share of stop-and-wait's count, per cent.
Measurement share(Tour& tour, const char* counter) {
  const PathRun ours = tour.walk(chcpp);
  const PathRun theirs = tour.walk(stop_and_wait);
  const double ratio =
      static_cast<double>(count(ours, counter)) / static_cast<double>(count(theirs, counter));
  return {100.0 * ratio, tour.right(ours) && tour.right(theirs)};
}

using Starts = std::vector<std::size_t>;

/// The first frames of the path's views; of a path without cuts only 0.
Starts view_starts(const Place& place, const Path& path) {
  const std::vector<PathFrame>& frames = path.frames;
  Starts starts{0};
  for (std::size_t i = 1; place.cuts && i < frames.size(); ++i) {
    if (!(frames[i].camera == frames[i - 1].camera)) starts.push_back(i);
  }
  return starts;
}

/// A statistic of the frame times of all walks: of where views start, and the times.
template <typename Statistic>
Measurement of_frame_times(Visits& all, const Place& place, const std::string& spec,
                           Statistic&& statistic) {
  const SampleGrid& frame_ms = all.frame_ms(spec, place.reference);
  return {statistic(view_starts(place, all.tour().path()), frame_ms), all.right(spec)};
}

/// What the method itself needs for each frame: the least over the walks, since all walks of a
/// method do the same, and whatever else the machine does only adds to that.
std::vector<double> own_times(const SampleGrid& frame_ms) {
  std::vector<double> least = frame_ms.front();
  for (const RoundSamples& walk : frame_ms) {
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], walk[i]);
  }
  return least;
}

double p99(const Starts& /*starts*/, const SampleGrid& frame_ms) {
  std::vector<double> all;
  for (const RoundSamples& walk : frame_ms) all.insert(all.end(), walk.begin(), walk.end());
  return quantile(std::move(all), 0.99);
}

double variance(const Starts& /*starts*/, const SampleGrid& frame_ms) {
  const std::vector<double> times = own_times(frame_ms);
  const auto n = static_cast<double>(times.size());
  const double mean = std::accumulate(times.begin(), times.end(), 0.0) / n;
  double squares = 0.0;
  for (const double time : times) squares += (time - mean) * (time - mean);
  return squares / n;
}

/// Frames of a view that are no part of what is settled. In the first one all is new to CHC++; what
/// it draws then although it is hidden is asked about again in the next four (its `interval`) and
/// left out from there on. The rows "settled after" show whether that is so.
constexpr std::size_t settling = 5;

/// visit(times of one view), for the path's views; without cuts, the whole path is one.
template <typename Visit>
void for_each_view(const Starts& starts, const std::vector<double>& times, Visit&& visit) {
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : times.size();
    visit(std::span(times).subspan(starts[i], end - starts[i]));
  }
}

double median_of(std::span<const double> times) {
  return median(std::vector<double>(times.begin(), times.end()));
}

/// Worst frame ÷ median of a settled view, in the worst of all views.
double worst_settled(const Starts& starts, const std::vector<double>& times) {
  double worst = 0.0;
  for_each_view(starts, times, [&](std::span<const double> view) {
    const std::span<const double> settled = view.subspan(settling);
    worst = std::max(worst, *std::ranges::max_element(settled) / median_of(settled));
  });
  return worst;
}

double own_worst(const Starts& starts, const SampleGrid& frame_ms) {
  return worst_settled(starts, own_times(frame_ms));
}

/// The same of single walks, with whatever else the machine did: the median over the walks.
double raw_worst(const Starts& starts, const SampleGrid& frame_ms) {
  std::vector<double> worst;
  for (const RoundSamples& walk : frame_ms) worst.push_back(worst_settled(starts, walk));
  return median(std::move(worst));
}

/// After how many frames of a view the first one takes no more than 1.1 times the median of the
/// view's later half, in the slowest of all views: what `settling` is chosen by.
double frames_to_settle(const Starts& starts, const SampleGrid& frame_ms) {
  std::ptrdiff_t slowest = 0;
  for_each_view(starts, own_times(frame_ms), [&](std::span<const double> view) {
    const double usual = median_of(view.subspan(view.size() / 2));
    const auto settled = std::ranges::find_if(view, [&](double ms) { return ms <= 1.1 * usual; });
    slowest = std::max(slowest, settled - view.begin());
  });
  return static_cast<double>(slowest);
}

}  // namespace

void add_coherent_cases(std::vector<BenchCase>& cases) {
  const auto current = std::make_shared<Current>();
  const auto contest = [&](const Place& place, const char* method, const char* other,
                           const Bar& bar) {
    cases.push_back(
        {method,
         place.name(),
         "ms",
         other,
         [=] { return std::make_unique<WalkContest>(current->tour(place), method, other); },
         {},
         bar});
  };
  const auto measure = [&](const Place& place, const std::string& spec, const std::string& name,
                           const char* unit, auto statistic, const Bar& bar = {}) {
    cases.push_back({spec,
                     place.name() + ", " + name,
                     unit,
                     "",
                     {},
                     [=] { return of_frame_times(current->visits(place), place, spec, statistic); },
                     bar});
  };
  const auto part = [&](const Place& place, const char* what, const char* counter, double most) {
    cases.push_back({chcpp,
                     place.name() + ", " + what + " of stop-and-wait's",
                     "%",
                     "",
                     {},
                     [=] { return share(current->tour(place), counter); },
                     Bar::at_most(most)});
  };
  const auto scatter = [&](const Place& place) {
    for (const char* method : {chcpp, place.reference}) {
      measure(place, method, "99 % of frames", "ms", p99);
    }
    const std::string after = place.cuts ? ", 5 frames after a cut" : "";
    measure(place, chcpp, "worst by median" + after, "1", own_worst, Bar::at_most(1.5));
    for (const char* method : {chcpp, place.reference}) {
      measure(place, method, "worst by median of single walks" + after, "1", raw_worst);
    }
    if (place.cuts) measure(place, chcpp, "settled after", "frames", frames_to_settle);
  };
  for (const Place& place : hiding) {
    contest(place, chcpp, ideal, Bar::at_most(1.11));
    contest(place, ideal, ideal, {});
    part(place, "queries", "queries", 15.0);
    part(place, "state changes", "state_changes", 10.0);
    scatter(place);
    measure(place, chcpp, "variance with random re-tests", "ms^2", variance);
    measure(place, aligned, "variance with aligned re-tests", "ms^2", variance);
  }
  for (const Place& place : open) {
    contest(place, chcpp, frustum_only, Bar::at_most(1.03));
    contest(place, frustum_only, frustum_only, {});
    scatter(place);
  }
  for (const Place& place : with_cuts) {
    contest(place, chcpp, ideal, {});
    scatter(place);
  }
}

}  // namespace vislab
