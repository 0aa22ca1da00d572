// The city: drawing, testing and accuracy, each with the time that it takes.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <stdexcept>
#include <tuple>

#include "common/raster/box_queries.h"
#include "common/raster/brute_force_raster.h"
#include "experiments/analysis/statistics.h"
#include "experiments/bench/depth/cases.h"
#include "experiments/bench/depth/city_workload.h"

namespace vislab {
namespace {

constexpr const char* view_sets[] = {"street", "elevated"};

const CityWorkload& city(const std::string& views) {
  static std::map<std::string, CityWorkload> cities;
  return cities.try_emplace(views, views).first->second;
}

bool same_pixels(const DepthRaster& a, const BruteForceRaster& b) {
  for (int y = 0; y < a.viewport().height; ++y) {
    for (int x = 0; x < a.viewport().width; ++x) {
      if (a.nearness(x, y) != b.nearness(x, y)) return false;
    }
  }
  return true;
}

/// Where a buffer has its samples. Peers are judged by 4 x 4 samples a pixel of the image; what is
/// hidden at the image's own pixels need not be hidden at those.
struct Sampling {
  const char* name;
  int scale;  // pixels of the buffer along a side of one of the image's
  Coverage coverage;
  int rounds;
};
constexpr Sampling at_image{"the image's pixels", 1, Coverage::centres, 15};
constexpr Sampling others[] = {
    {"4 x 4 a pixel", 4, Coverage::centres, 5},
    {"pixels covered wholly: right for all samples", 1, Coverage::whole_pixels, 5}};

/// What peers are listed by: a view's time to draw, a box's time to be asked, and what is found.
struct CityFigures {
  double whole_ms = 0.0, whole_mesh_ms = 0.0, test_then_draw_ms = 0.0;  // of a view
  double query_ns = 0.0;               // of a box: frustum, projection and test
  double occluded = 0.0, ideal = 0.0;  // % of the boxes in the view; ideal by 4 x 4 samples a pixel
  double ideal_at_centres = 0.0;       // by pixel centres
  double found = 0.0;                  // % of those that are hidden in truth
  double false_culls = 0.0;            // % of those visible by 4 x 4 samples a pixel
  double false_at_centres = 0.0;       // % of those visible at pixel centres: undisputed
  bool same_buffers = true;            // as brute force draws them
};

class CityRun {
 public:
  CityRun(const std::string& views, int threads, const Sampling& sampling)
      : city_(city(views)),
        threads_(threads),
        sampling_(sampling),
        raster_(
            {sampling.scale * CityWorkload::size.width, sampling.scale * CityWorkload::size.height},
            {{sampling.coverage, DepthRounding::nearest}, false, threads}),
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
    if (sampling_.name == at_image.name) result.same_buffers = same_as_brute_force();
    if (threads_ == 1) judge(result);
    // Interleaved, so that what else the machine does falls on all.
    std::vector<double> whole, whole_mesh, tested, asked;
    for (int round = 0; round <= sampling_.rounds; ++round) {
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
    result.ideal_at_centres = 100.0 * (in_view - at_centre) / in_view;
    result.found = 100.0 * hidden_found / hidden;
    result.false_culls = 100.0 * visible_culled / visible;
    result.false_at_centres = 100.0 * at_centre_culled / at_centre;
  }

  const CityWorkload& city_;
  int threads_;
  Sampling sampling_;
  DepthRaster raster_;
  BoxQueries queries_;
  std::vector<std::uint8_t> hidden_;
  std::vector<std::uint64_t> visible_;
};

const CityFigures& figures(const std::string& views, int threads,
                           const Sampling& sampling = at_image) {
  static std::map<std::tuple<std::string, int, std::string>, CityFigures> all;
  const auto key = std::make_tuple(views, threads, std::string(sampling.name));
  const auto found = all.find(key);
  if (found != all.end()) return found->second;
  return all.emplace(key, CityRun(views, threads, sampling).figures()).first->second;
}

/// All views once: by tiles against brute force.
class BruteForceContest : public Contest {
 public:
  BruteForceContest(const std::string& views, int threads)
      : city_(city(views)), run_(views, threads, at_image), brute_(CityWorkload::size, {}) {}

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
    for (const DepthRaster& raster : rasters_) ask_one_by_one(raster);
  }
  /// But for what margins of float and double decide otherwise: we may keep more, one in a hundred
  /// of the visible, and hide what is not seen in truth.
  bool equal() override {
    std::size_t kept = 0, more = 0;
    for (std::size_t view = 0; view < rasters_.size(); ++view) {
      queries_.test(rasters_[view], ours_);
      ask_one_by_one(rasters_[view]);
      for (std::size_t i = 0; i < city_.boxes().size(); ++i) {
        const bool we = bit(ours_, i), they = bit(theirs_, i);
        kept += they ? 1 : 0;
        more += we && !they ? 1 : 0;
        if (they && !we && city_.truth()[view].at_centre[i]) return false;
      }
    }
    return more * 100 <= kept;
  }
  double work() const override {
    return 1e-6 * static_cast<double>(city_.view_count() * city_.boxes().size());
  }

 private:
  static bool bit(const std::vector<std::uint64_t>& bits, std::size_t i) {
    return ((bits[i / 64] >> (i % 64)) & 1U) != 0;
  }
  void ask_one_by_one(const DepthRaster& raster) {
    std::ranges::fill(theirs_, 0);
    for (std::size_t i = 0; i < city_.boxes().size(); ++i) {
      if (!raster.hides(city_.boxes()[i])) theirs_[i / 64] |= std::uint64_t{1} << (i % 64);
    }
  }

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
    add(views, 1, "ideal, 4x4 samples", "%", &CityFigures::ideal, any);
    add(views, 1, "ideal, pixel centres", "%", &CityFigures::ideal_at_centres, any);
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
  const auto pair = [](int threads, const Sampling& sampling, double CityFigures::*value,
                       int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f / %.*f", digits,
                  figures("street", threads, sampling).*value, digits,
                  figures("elevated", threads, sampling).*value);
    return std::string(text);
  };
  const auto row = [&](const std::string& name, int threads, const Sampling& sampling,
                       double CityFigures::*render) {
    std::printf("| %s, %d thread%s | %s", name.c_str(), threads, threads == 1 ? "" : "s",
                pair(threads, sampling, render, 3).c_str());
    for (const auto& [value, digits] :
         {std::pair{&CityFigures::query_ns, 2}, std::pair{&CityFigures::occluded, 2},
          std::pair{&CityFigures::found, 2}, std::pair{&CityFigures::false_culls, 2},
          std::pair{&CityFigures::false_at_centres, 3}}) {
      std::printf(" | %s", pair(1, sampling, value, digits).c_str());
    }
    std::printf(" |\n");
  };
  std::printf(
      "\n24k occluder triangles (2,000 box buildings), 100k box queries, image of 1024x512; street "
      "/ elevated camera\n"
      "| | render ms | query ns | occluded %% | of the hidden %% | false culls, %% of what 4x4 "
      "samples see | %% of what pixel centres see |\n|---|---|---|---|---|---|---|\n");
  std::printf("| ideal, by 4x4 samples a pixel, as for peers | - | - | %s | 100 | 0 | 0 |\n",
              pair(1, at_image, &CityFigures::ideal, 2).c_str());
  std::printf("| ideal, by pixel centres | - | - | %s | - | - | 0 |\n",
              pair(1, at_image, &CityFigures::ideal_at_centres, 2).c_str());
  for (const int threads : {1, 2}) {
    row("whole, one call of 2,000 draws", threads, at_image, &CityFigures::whole_ms);
    row("whole, one mesh", threads, at_image, &CityFigures::whole_mesh_ms);
    if (threads == 1) {
      row("test-then-draw per building", 1, at_image, &CityFigures::test_then_draw_ms);
    }
  }
  for (const Sampling& sampling : others) {
    row(std::string("whole, one call, ") + sampling.name, 1, sampling, &CityFigures::whole_ms);
  }
  const auto rate = [](const char* views) { return 1e3 / figures(views, 1).query_ns; };
  std::printf(
      "Whole pass of 100k queries (frustum + projection + test): %.0f / %.0f M/s. Queries and "
      "test-then-draw use one thread.\n"
      "Occluded: of the boxes that may cover a pixel. Of the hidden: of those that no 4x4 sample "
      "sees.\nA culler for this image may leave out what no pixel's centre sees (last column). "
      "Peers "
      "are judged by 4x4 samples a pixel,\nwhich see boxes that show between centres only: the "
      "last "
      "row is made for that, and is the one to lay beside theirs.\n",
      rate("street"), rate("elevated"));
}

}  // namespace vislab
