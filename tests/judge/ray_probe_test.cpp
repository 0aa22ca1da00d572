#include <gtest/gtest.h>

#include "common/judge/ray_probes.h"
#include "common/scene/error.h"
#include "tests/judge/judge_scenes.h"

namespace vislab {
namespace {

constexpr Viewport viewport{64, 64};

/// A cube, one behind it that is hidden, and one beside them.
class RayProbes : public testing::Test {
 protected:
  std::vector<ObjectId> objects(const RaySampling& sampling) {
    const auto probe = make_ray_probe(stage_.scene, sampling);
    probe->look(stage_.frame);
    const auto seen = probe->visible_objects(0);
    return {seen.begin(), seen.end()};
  }
  RayFindings findings(const RaySampling& sampling) {
    return make_ray_probe(stage_.scene, sampling)->look(stage_.frame);
  }

  Stage stage_{cubes_at({{0.0, 0.0, 0.0}, {0.0, 0.0, -5.0}, {3.0, 0.0, 0.0}}),
               camera_at({0.0, 0.0, 9.0}, {0.0, 0.0, 0.0}), viewport};
};

RaySampling lattice(double x, double y) {
  RaySampling sampling;
  sampling.aim = RaySampling::Aim::lattice;
  sampling.offset_x_px = x;
  sampling.offset_y_px = y;
  return sampling;
}

TEST_F(RayProbes, see_what_the_truth_sees_with_as_many_rays) {
  RayCaster caster(stage_.scene, {});
  const std::vector<TriangleId> truth = caster.trace(stage_.frame).visible();
  const auto probe = make_ray_probe(stage_.scene, {});
  const RayFindings& found = probe->look(stage_.frame);
  EXPECT_EQ(found.rays, 64U * 64U * 16U);
  EXPECT_EQ(found.triangles, truth.size());
  EXPECT_EQ(objects({}), (std::vector<ObjectId>{0, 2}));
}

TEST_F(RayProbes, lose_what_lies_between_few_rays) {
  RaySampling sampling = lattice(32.5, 32.3);
  sampling.every_px = 64;
  EXPECT_EQ(findings(sampling).rays, 1U);
  EXPECT_EQ(objects(sampling), (std::vector<ObjectId>{0}));
  EXPECT_EQ(findings(sampling).seen_once, 1U);
}

TEST_F(RayProbes, meet_both_triangles_of_an_edge_that_they_are_aimed_at) {
  RaySampling on_diagonal = lattice(0.5, 0.5);
  on_diagonal.every_nearest = true;
  RaySampling beside = lattice(0.5, 0.3);
  beside.every_nearest = true;
  EXPECT_GT(findings(on_diagonal).ties, 0U);
  EXPECT_EQ(findings(beside).ties, 0U);
  EXPECT_EQ(findings(beside).other, 0U) << "away from edges all tracers agree";
}

TEST_F(RayProbes, follow_the_frame_and_answer_a_frame_once) {
  const auto probe = make_ray_probe(stage_.scene, {});
  const std::uint64_t before = probe->look(stage_.frame).hits;
  stage_.apply(changes({}, {}, {}, {0}));
  EXPECT_EQ(probe->look(stage_.frame).hits, before) << "the answer for this index is kept";
  stage_.frame.index = 1;
  probe->look(stage_.frame);
  const auto seen = probe->visible_objects(1);
  EXPECT_EQ(std::vector<ObjectId>(seen.begin(), seen.end()), (std::vector<ObjectId>{1, 2}));
}

TEST_F(RayProbes, refuse_settings_out_of_range) {
  RaySampling sampling;
  sampling.samples = 0;
  EXPECT_THROW(make_ray_probe(stage_.scene, sampling), InputError);
  EXPECT_THROW(make_ray_probe(stage_.scene, lattice(1.5, 0.5)), InputError)
      << "beyond its square of one pixel";
  sampling = {};
  sampling.instruction_set = "mmx";
  EXPECT_THROW(make_ray_probe(stage_.scene, sampling), InputError);
}

}  // namespace
}  // namespace vislab
