// The city: drawing, testing and accuracy, each with the time that it takes.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <stdexcept>

#include "common/raster/box_queries.h"
#include "common/raster/brute_force_raster.h"
#include "experiments/analysis/statistics.h"
#include "experiments/bench/depth/cases.h"
#include "experiments/bench/depth/city_workload.h"

namespace vislab {
namespace {

constexpr int rounds = 15;
constexpr const char* view_sets[] = {"street", "elevated"};

const CityWorkload& city(const std::string& views) {
  static std::map<std::string, CityWorkload> cities;
  return cities.try_emplace(views, views).first->second;
}

bool same_pixels(const DepthRaster& a, const BruteForceRaster& b) {
  for (int y = 0; y < CityWorkload::size.height; ++y) {
    for (int x = 0; x < CityWorkload::size.width; ++x) {
      if (a.nearness(x, y) != b.nearness(x, y)) return false;
    }
  }
  return true;
}

/// What peers are listed by: a view's time to draw, a box's time to be asked, and what is found.
struct CityFigures {
  double whole_ms = 0.0, whole_mesh_ms = 0.0, test_then_draw_ms = 0.0;  // of a view
  double query_ns = 0.0;               // of a box: frustum, projection and test
  double occluded = 0.0, ideal = 0.0;  // % of the boxes in the view
  double found = 0.0;                  // % of those that are hidden in truth
  double false_culls = 0.0;            // % of those visible by 4 x 4 samples a pixel
  double false_at_centres = 0.0;       // % of those visible at pixel centres: undisputed
  bool same_buffers = true;            // as brute force draws them
};

class CityRun {
 public:
  CityRun(const std::string& views, int threads)
      : city_(city(views)),
        threads_(threads),
        raster_(CityWorkload::size, {{}, false, threads}),
        queries_(city_.boxes()),
        hidden_(CityWorkload::buildings),
        visible_(BoxQueries::words_of(city_.boxes().size())) {}

  void draw_whole(std::size_t view) {
    raster_.begin(city_.camera(view));
    raster_.draw(city_.draws());
  }
  void draw_whole_mesh(std::size_t view) {
    raster_.begin(city_.camera(view));
    raster_.draw({&city_.draw_of_all(), 1});
  }
  void test_then_draw(std::size_t view) {
    raster_.begin(city_.camera(view));
    raster_.draw_visible(city_.draws(), city_.building_boxes(), city_.near_first(view), hidden_);
  }

  /// Are all views, drawn in all ways, what brute force draws?
  bool same_as_brute_force() {
    BruteForceRaster brute(CityWorkload::size, {});
    bool same = true;
    for (std::size_t view = 0; view < city_.view_count(); ++view) {
      brute.begin(city_.camera(view));
      brute.draw(city_.draws());
      draw_whole(view);
      same = same && same_pixels(raster_, brute);
      test_then_draw(view);
      same = same && same_pixels(raster_, brute);
      brute.begin(city_.camera(view));
      brute.draw({&city_.draw_of_all(), 1});
      draw_whole_mesh(view);
      same = same && same_pixels(raster_, brute);
    }
    return same;
  }

  CityFigures figures() {
    CityFigures result;
    result.same_buffers = same_as_brute_force();
    if (threads_ == 1) judge(result);
    // Interleaved, so that what else the machine does falls on all.
    std::vector<double> whole, whole_mesh, tested, asked;
    for (int round = 0; round <= rounds; ++round) {
      double whole_s = 0.0, whole_mesh_s = 0.0, tested_s = 0.0, asked_s = 0.0;
      for (std::size_t view = 0; view < city_.view_count(); ++view) {
        if (threads_ == 1) tested_s += seconds([&] { test_then_draw(view); });
        whole_mesh_s += seconds([&] { draw_whole_mesh(view); });
        whole_s += seconds([&] { draw_whole(view); });
        if (threads_ == 1) asked_s += seconds([&] { queries_.test(raster_, visible_); });
      }
      if (round == 0) continue;  // warms up
      whole.push_back(whole_s);
      whole_mesh.push_back(whole_mesh_s);
      tested.push_back(tested_s);
      asked.push_back(asked_s);
    }
    const auto views = static_cast<double>(city_.view_count());
    result.whole_ms = 1e3 * median(whole) / views;
    result.whole_mesh_ms = 1e3 * median(whole_mesh) / views;
    result.test_then_draw_ms = 1e3 * median(tested) / views;
    result.query_ns = 1e9 * median(asked) / (views * static_cast<double>(city_.boxes().size()));
    return result;
  }

 private:
  static double seconds(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  void judge(CityFigures& result) {
    double in_view = 0.0, culled = 0.0, hidden = 0.0, hidden_found = 0.0;
    double visible = 0.0, visible_culled = 0.0, at_centre = 0.0, at_centre_culled = 0.0;
    for (std::size_t view = 0; view < city_.view_count(); ++view) {
      const CityWorkload::Truth& truth = city_.truth()[view];
      draw_whole(view);
      queries_.test(raster_, visible_);
      for (std::size_t i = 0; i < city_.boxes().size(); ++i) {
        const bool is_culled = ((visible_[i / 64] >> (i % 64)) & 1U) == 0;
        if (!truth.in_view[i]) continue;
        in_view += 1.0;
        culled += is_culled ? 1.0 : 0.0;
        hidden += truth.visible[i] ? 0.0 : 1.0;
        hidden_found += !truth.visible[i] && is_culled ? 1.0 : 0.0;
        visible += truth.visible[i] ? 1.0 : 0.0;
        visible_culled += truth.visible[i] && is_culled ? 1.0 : 0.0;
        at_centre += truth.at_centre[i] ? 1.0 : 0.0;
        at_centre_culled += truth.at_centre[i] && is_culled ? 1.0 : 0.0;
      }
    }
    result.occluded = 100.0 * culled / in_view;
    result.ideal = 100.0 * hidden / in_view;
    result.found = 100.0 * hidden_found / hidden;
    result.false_culls = 100.0 * visible_culled / visible;
    result.false_at_centres = 100.0 * at_centre_culled / at_centre;
  }

  const CityWorkload& city_;
  int threads_;
  DepthRaster raster_;
  BoxQueries queries_;
  std::vector<std::uint8_t> hidden_;
  std::vector<std::uint64_t> visible_;
};

const CityFigures& figures(const std::string& views, int threads) {
  static std::map<std::pair<std::string, int>, CityFigures> all;
  const auto key = std::make_pair(views, threads);
  const auto found = all.find(key);
  if (found != all.end()) return found->second;
  return all.emplace(key, CityRun(views, threads).figures()).first->second;
}

/// All views once: by tiles against brute force.
class BruteForceContest : public Contest {
 public:
  BruteForceContest(const std::string& views, int threads)
      : city_(city(views)), run_(views, threads), brute_(CityWorkload::size, {}) {}

  void ours() override {
    for (std::size_t view = 0; view < city_.view_count(); ++view) run_.draw_whole(view);
  }
  void theirs() override {
    for (std::size_t view = 0; view < city_.view_count(); ++view) {
      brute_.begin(city_.camera(view));
      brute_.draw(city_.draws());
    }
  }
  bool equal() override { return run_.same_as_brute_force(); }
  double work() const override {
    return 1e-6 * 12.0 * static_cast<double>(city_.view_count() * CityWorkload::buildings);
  }

 private:
  const CityWorkload& city_;
  CityRun run_;
  BruteForceRaster brute_;
};

/// The boxes of all views: a hierarchy of blocks against one box after the other.
class OneByOneContest : public Contest {
 public:
  explicit OneByOneContest(const std::string& views)
      : city_(city(views)),
        queries_(city_.boxes()),
        ours_(BoxQueries::words_of(city_.boxes().size())),
        theirs_(ours_.size()) {
    for (std::size_t view = 0; view < city_.view_count(); ++view) {
      rasters_.emplace_back(CityWorkload::size, RasterOptions{});
      rasters_.back().begin(city_.camera(view));
      rasters_.back().draw(city_.draws());
    }
  }

  void ours() override {
    for (const DepthRaster& raster : rasters_) queries_.test(raster, ours_);
  }
  void theirs() override {
    for (const DepthRaster& raster : rasters_) {
      std::ranges::fill(theirs_, 0);
      for (std::size_t i = 0; i < city_.boxes().size(); ++i) {
        if (!raster.hides(city_.boxes()[i])) theirs_[i / 64] |= std::uint64_t{1} << (i % 64);
      }
    }
  }
  /// But for what margins of float and double decide otherwise, one in a thousand of the visible.
  bool equal() override {
    ours();
    theirs();
    std::size_t kept = 0, different = 0;
    for (std::size_t i = 0; i < ours_.size(); ++i) {
      kept += static_cast<std::size_t>(std::popcount(theirs_[i]));
      different += static_cast<std::size_t>(std::popcount(ours_[i] ^ theirs_[i]));
    }
    return different * 100 <= kept;
  }
  double work() const override {
    return 1e-6 * static_cast<double>(city_.view_count() * city_.boxes().size());
  }

 private:
  const CityWorkload& city_;
  BoxQueries queries_;
  std::vector<DepthRaster> rasters_;
  std::vector<std::uint64_t> ours_, theirs_;
};

}  // namespace

void add_city_cases(std::vector<BenchCase>& cases) {
  using Value = double CityFigures::*;
  const auto add = [&](const std::string& views, int threads, const std::string& name,
                       const std::string& unit, Value value, auto&& right) {
    cases.push_back({"depth", "city, " + views + ", " + name, unit, "", nullptr, [=] {
                       const CityFigures& f = figures(views, threads);
                       return Measurement{f.*value, right(f)};
                     }});
  };
  const auto same_buffers = [](const CityFigures& f) { return f.same_buffers; };
  const auto none_false = [](const CityFigures& f) { return f.false_at_centres == 0.0; };
  const auto any = [](const CityFigures&) { return true; };
  for (const std::string views : view_sets) {
    add(views, 1, "render whole, 1 thread", "ms", &CityFigures::whole_ms, same_buffers);
    add(views, 1, "render whole, one mesh, 1 thread", "ms", &CityFigures::whole_mesh_ms,
        same_buffers);
    add(views, 1, "render test-then-draw, 1 thread", "ms", &CityFigures::test_then_draw_ms,
        same_buffers);
    add(views, 1, "query, 1 thread", "ns", &CityFigures::query_ns, none_false);
    add(views, 1, "ideal", "%", &CityFigures::ideal, any);
    add(views, 1, "occluded", "%", &CityFigures::occluded, none_false);
    add(views, 1, "found of the hidden", "%", &CityFigures::found, any);
    add(views, 1, "false culls, 4x4 samples", "%", &CityFigures::false_culls, any);
    add(views, 1, "false culls, pixel centres", "%", &CityFigures::false_at_centres, none_false);
    add(views, 2, "render whole, 2 threads", "ms", &CityFigures::whole_ms, same_buffers);
    add(views, 2, "render whole, one mesh, 2 threads", "ms", &CityFigures::whole_mesh_ms,
        same_buffers);
    for (const int threads : {1, 2}) {
      cases.push_back({"depth",
                       "city, " + views + ", drawn, " + std::to_string(threads) + " threads",
                       "Mtriangle/s", "brute force",
                       [=] { return std::make_unique<BruteForceContest>(views, threads); }});
    }
    cases.push_back({"depth", "city, " + views + ", boxes", "Mbox/s", "one box after the other",
                     [=] { return std::make_unique<OneByOneContest>(views); }});
  }
}

void print_city_table() {
  const auto pair = [](int threads, double CityFigures::*value, double factor, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f / %.*f", digits,
                  factor * (figures("street", threads).*value), digits,
                  factor * (figures("elevated", threads).*value));
    return std::string(text);
  };
  const std::string occluded = pair(1, &CityFigures::occluded, 1.0, 2);
  const std::string query = pair(1, &CityFigures::query_ns, 1.0, 2);
  const std::string false_culls = pair(1, &CityFigures::false_culls, 1.0, 2);
  const std::string same = " | " + query + " | " + occluded + " | " + false_culls + " |";
  std::printf(
      "\n24k occluder triangles (2,000 box buildings), 100k box queries, 1024x512; street / "
      "elevated "
      "camera\n| | render ms | query ns | occluded %% | false culls, %% of visible |\n"
      "|---|---|---|---|---|\n");
  std::printf("| ideal | - | - | %s | 0 |\n", pair(1, &CityFigures::ideal, 1.0, 2).c_str());
  const auto row = [&](const char* name, int threads, double CityFigures::*value) {
    std::printf("| %s, %d thread%s | %s%s\n", name, threads, threads == 1 ? "" : "s",
                pair(threads, value, 1.0, 3).c_str(), same.c_str());
  };
  row("whole, one call of 2,000 draws", 1, &CityFigures::whole_ms);
  row("whole, one mesh", 1, &CityFigures::whole_mesh_ms);
  row("test-then-draw per building", 1, &CityFigures::test_then_draw_ms);
  row("whole, one call of 2,000 draws", 2, &CityFigures::whole_ms);
  row("whole, one mesh", 2, &CityFigures::whole_mesh_ms);
  const auto rate = [](const char* views) { return 1e3 / figures(views, 1).query_ns; };
  std::printf(
      "Whole pass of 100k queries (frustum + projection + test): %.0f / %.0f M/s, 1 thread.\n"
      "Occluded: of the boxes that may cover a pixel. False culls: seen by one of 4x4 samples a "
      "pixel, but by no pixel's centre;\nof those that a centre sees without dispute: %s %%. Found "
      "of what the 4x4 samples say is hidden: %s %%.\n",
      rate("street"), rate("elevated"), pair(1, &CityFigures::false_at_centres, 1.0, 3).c_str(),
      pair(1, &CityFigures::found, 1.0, 2).c_str());
}

}  // namespace vislab
