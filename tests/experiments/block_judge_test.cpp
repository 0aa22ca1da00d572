#include "experiments/run/block_judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments/context/sources.h"
#include "tests/judge/judge_scenes.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

constexpr Viewport viewport{96, 80};

class JudgeCells : public testing::Test {
 protected:
  JudgeCells() {
    // An upright edge 1/1024 pixel to the right of the centres of column 60, 4 m away: rays pass it
    // there, and the device, which snaps it to the centres, draws it.
    const double ndc = 2.0 * (60.5 + 1.0 / 1024.0) / viewport.width - 1.0;
    const auto x = static_cast<float>(4.0 * std::tan(std::numbers::pi / 6.0) * ndc);
    add_triangle(scene_, {-20.0F, -20.0F, -5.0F}, {20.0F, -20.0F, -5.0F}, {0.0F, 30.0F, -5.0F});
    add_triangle(scene_, {x, -20.0F, 0.0F}, {x + 20.0F, 0.0F, 0.0F}, {x, 20.0F, 0.0F});
    scene_.finish();
    path_.frames.push_back({camera_at({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}), {}});
  }

  /// Of a method that leaves out what lies behind the edge; `painted` is its own image, if any.
  Verdict verdict(Guarantee guarantee, const std::vector<TriangleId>& painted = {}) {
    const TruthSettings settings{.jitter_per_pixel = 1, .seed = 1, .threads = 1};
    RayCaster caster(scene_, settings);
    const PathTruth truth = trace_path(path_, viewport, settings, caster, nullptr);
    const VisibleSet kept({{1, 1}});
    store_.save_set(kept.hash(), kept);
    ResultCell cell;
    cell.key.chain = to_string(guarantee);
    cell.guarantee = guarantee;
    cell.frames.push_back({kept.hash(), "truth", 1, {}});
    if (!painted.empty()) {
      cell.frames.back().surface = surface_hash(painted);
      store_.save_surface(surface_hash(painted), painted);
    }
    Progress progress(true);
    judge_cells({&cell}, scene_, path_, viewport, truth, caster, true, store_, progress);
    return store_.load_verdicts(cell, judge_source_hash()).value().frames.at(0);
  }

  TemporaryFolder temporary_;
  ResultStore store_ = ResultStore::create(temporary_.path());
  Scene scene_;
  Path path_;
};

TEST_F(JudgeCells, HoldsWhatPromisesTheDevicesImageToThatImageBesideAnEdge) {
  const Verdict by_rays = verdict(Guarantee::conservative);
  const Verdict by_image = verdict(Guarantee::image_exact);
  EXPECT_EQ(by_rays.false_px - by_image.false_px, static_cast<std::uint64_t>(viewport.height));
  EXPECT_EQ(by_image.false_px, 60U * viewport.height);
}

TEST_F(JudgeCells, HoldsWhatPaintsToItsOwnImage) {
  const std::size_t pixels = static_cast<std::size_t>(viewport.width) * viewport.height;
  const std::vector<TriangleId> edge_side(pixels, 1);
  const std::vector<TriangleId> background(pixels, none_id);
  EXPECT_EQ(verdict(Guarantee::conservative, edge_side).false_px, 60U * viewport.height);
  EXPECT_EQ(verdict(Guarantee::conservative, background).false_px, 61U * viewport.height);
}

}  // namespace
}  // namespace vislab
