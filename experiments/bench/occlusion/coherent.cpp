// CHC++ and what it is held to: frame times beside its ideal's, queries and changes of state beside
// stop-and-wait's, and how much frame times scatter.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "experiments/analysis/statistics.h"
#include "experiments/bench/occlusion/cases.h"
#include "experiments/bench/occlusion/tour.h"

namespace vislab {
namespace {

constexpr const char* chcpp = "occlusion.chcpp";
constexpr const char* ideal = "oracle[level=node]";
constexpr const char* frustum_only = "frustum.bvh";
constexpr const char* stop_and_wait = "frustum.bvh > occlusion.stop_and_wait";

struct Place {
  const char* scene;
  const char* path;
  std::string name() const { return std::string(scene) + ", " + path; }
};

constexpr Place hiding[] = {{"city_heavy", "city_slow"}, {"plant_heavy", "plant_slow"}};
constexpr Place open[] = {{"open_field", "open_field_above"},
                          {"open_field_heavy", "open_field_above"}};
constexpr Place with_cuts[] = {{"city_heavy", "city_cut"}, {"plant_heavy", "plant_cut"}};

/// Only one place's scene is kept: truth and meshes are large.
Tour& tour(const Place& place) {
  static std::string name;
  static std::unique_ptr<Tour> current;
  if (name != place.name()) {
    current.reset();
    current = std::make_unique<Tour>(place.scene, place.path);
    name = place.name();
  }
  return *current;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// CHC++ against another method on whole walks; reports the median time of a frame.
class WalkContest : public Contest {
 public:
  WalkContest(const Place& place, const char* other) : place_(place), other_(other) {
    tour(place_).walk(chcpp);  // cullers are built outside of the contest
    tour(place_).walk(other_);
  }
  void ours() override { ours_ = tour(place_).walk(chcpp); }
  void theirs() override { theirs_ = tour(place_).walk(other_); }
  bool equal() override {
    frame_ms_ = median(ours_.round.frame_ms);
    return tour(place_).right(ours_) && tour(place_).right(theirs_);
  }
  double figure() const override { return frame_ms_; }

 private:
  Place place_;
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
Measurement share(const Place& place, const char* counter) {
  const PathRun ours = tour(place).walk(chcpp);
  const PathRun theirs = tour(place).walk(stop_and_wait);
  const double ratio =
      static_cast<double>(count(ours, counter)) / static_cast<double>(count(theirs, counter));
  return {100.0 * ratio, tour(place).right(ours) && tour(place).right(theirs)};
}

constexpr int walks = 7;

/// A statistic of the frame times of several walks: of each frame the median over the walks, so
/// that what else the machine does falls out.
template <typename Statistic>
Measurement of_frame_times(const Place& place, const std::string& spec, Statistic&& statistic) {
  std::vector<std::vector<double>> frames(tour(place).frame_count());
  PathRun last;
  for (int walk = 0; walk < walks; ++walk) {
    last = tour(place).walk(spec);
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].push_back(last.round.frame_ms[i]);
  }
  std::vector<double> times;
  for (std::vector<double>& frame : frames) times.push_back(median(frame));
  return {statistic(times), tour(place).right(last)};
}

/// The frame that 99 in 100 are no slower than.
double p99(std::vector<double> times) {
  std::ranges::sort(times);
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(times.size())));
  return times[std::max<std::size_t>(rank, 1) - 1];
}

double variance(const std::vector<double>& times) {
  const auto n = static_cast<double>(times.size());
  const double mean = sum(times) / n;
  double squares = 0.0;
  for (const double time : times) squares += (time - mean) * (time - mean);
  return squares / n;
}

/// Worst frame against the median, the first frames of the path (in which all is new) left out.
double worst_settled(const std::vector<double>& times) {
  constexpr std::ptrdiff_t settling = 3;
  const std::vector<double> settled(times.begin() + settling, times.end());
  return *std::ranges::max_element(settled) / median(settled);
}

}  // namespace

void add_coherent_cases(std::vector<BenchCase>& cases) {
  const auto contest = [&](const Place& place, const char* other) {
    cases.push_back({chcpp, place.name(), "ms", other,
                     [=] { return std::make_unique<WalkContest>(place, other); }});
  };
  const auto measure = [&](const std::string& name, const char* unit, auto take) {
    cases.push_back({chcpp, name, unit, "", {}, take});
  };
  for (const Place& place : hiding) {
    contest(place, ideal);
    contest(place, frustum_only);
    measure(place.name() + ", 99 % of frames", "ms",
            [=] { return of_frame_times(place, chcpp, p99); });
    measure(place.name() + ", worst by median", "1",
            [=] { return of_frame_times(place, chcpp, worst_settled); });
    measure(place.name() + ", queries of stop-and-wait's", "%",
            [=] { return share(place, "queries"); });
    measure(place.name() + ", state changes of stop-and-wait's", "%",
            [=] { return share(place, "state_changes"); });
    for (const char* retest : {"random", "aligned"}) {
      const std::string spec = std::string(chcpp) + "[retest=" + retest + "]";
      measure(place.name() + ", variance with " + retest + " re-tests", "ms^2",
              [=] { return of_frame_times(place, spec, variance); });
    }
  }
  for (const Place& place : open) {
    contest(place, frustum_only);
    measure(place.name() + ", 99 % of frames", "ms",
            [=] { return of_frame_times(place, chcpp, p99); });
  }
  for (const Place& place : with_cuts) contest(place, ideal);
}

}  // namespace vislab
