// peer.meshopt_cones: what it promises, held to exact arithmetic where it gives no promise.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/algorithms/facing_worlds.h"
#include "tests/geometry/exact_facing.h"

namespace vislab {
namespace {

using test::count_facings;
using test::exact_facings;
using test::FacingCounts;

constexpr const char* peer = "peer.meshopt_cones[triangles=8]";

FacingCounts judged(CullerRun& run, const Scene& scene, const Camera& camera) {
  run.update(camera, {});
  const Frame frame = run.frame(camera);
  return count_facings(scene, frame, exact_facings(scene, frame), run.emitted(camera));
}

TEST(PeerMeshoptCones, LeavesOutOnlyBackFacesBeforeOrdinaryEyes) {
  Random random(61);
  BumpySphereParameters bumpy;
  bumpy.subdivisions = 20;
  bumpy.bumps = Bumps::low;
  Scene scene;
  scene.meshes = {bumpy_sphere_mesh(bumpy)};
  const glm::dmat4x3 sheared(glm::dvec3(0.5, 0.1, 0.0), glm::dvec3(0.2, -0.4, 0.1),
                             glm::dvec3(0.0, 0.3, 0.5), glm::dvec3(2.5, 0.0, -1.0));
  scene.objects = {{0, placed({0.0, 0.0, 0.0}), none_id}, {0, sheared, none_id}};
  scene.finish();
  CullerRun run(peer, scene);
  FacingCounts sum;
  for (int i = 0; i < 40; ++i) {
    Camera camera = camera_at(glm::dvec3(0.0, 0.0, 6.0) + test::vector_in(random, 2.0), {});
    if (i % 4 == 0) camera.lens = orthographic_lens(9.0, 1.0, 0.1, 100.0);
    sum += judged(run, scene, camera);
  }
  EXPECT_TRUE(sum.all_right());
  EXPECT_GT(sum.recall(), 0.5);
}

TEST(PeerMeshoptCones, HasNoErrorBoundSoItIsApproximate) {
  Random random(62);
  FacingCounts sum;
  for (int world = 0; world < 30; ++world) {
    const Scene scene = test::facing_world(random, world % 2 == 0, true);
    CullerRun run(peer, scene);
    EXPECT_EQ(run.culler().info().guarantee, Guarantee::approximate);
    for (int i = 0; i < 20; ++i) sum += judged(run, scene, test::facing_camera(random, scene));
  }
  std::cout << sum.back << " back faces, " << sum.back_left_out << " left out; of others "
            << sum.front_left_out << " front faces and " << sum.edge_on_left_out << " edge-on\n";
  EXPECT_EQ(sum.twice, 0U);
  EXPECT_GT(sum.front_left_out + sum.edge_on_left_out, 0U);
}

TEST(PeerMeshoptCones, RefusesSizesThatTheLibraryDoesNotTake) {
  Registry registry;
  register_all_cullers(registry);
  EXPECT_THROW(registry.make("peer.meshopt_cones[triangles=10]"), std::runtime_error);
  EXPECT_NO_THROW(registry.make("peer.meshopt_cones[triangles=124]"));
}

}  // namespace
}  // namespace vislab
