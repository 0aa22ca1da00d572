#include "common/geometry/frustum_filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/random.h"

namespace vislab {
namespace {

/// Within `reach` of `origin`.
Camera random_camera(Random& random, double reach, const glm::vec3& origin) {
  const auto direction = [&] {
    return glm::dvec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                      random.uniform(-1.0, 1.0));
  };
  const glm::dvec3 eye = glm::dvec3(origin) + direction() * reach;
  Camera camera{look_at(eye, eye + direction()), perspective_lens(1.0, 1.5, 0.1, reach)};
  if (random.below(3) == 0) camera.lens = orthographic_lens(reach, 1.5, 0.1, reach);
  if (random.below(4) == 0 && camera.lens.projection == Projection::perspective) {
    camera.lens.far_m = std::numeric_limits<double>::infinity();
  }
  return camera;
}

/// A point on the plane, moved off it by about `off`, rounded to float.
glm::vec3 point_near(const Plane& plane, Random& random, double reach, double off) {
  glm::dvec3 p(random.uniform(-reach, reach), random.uniform(-reach, reach),
               random.uniform(-reach, reach));
  p -= plane.normal * (plane.signed_distance(p) + random.uniform(-off, off));
  return glm::vec3(p);
}

float p_value(const FilterPlane& plane, const Aabb& box) {
  return plane.value(plane.x >= 0.0F ? box.max.x : box.min.x,
                     plane.y >= 0.0F ? box.max.y : box.min.y,
                     plane.z >= 0.0F ? box.max.z : box.min.z);
}

struct Counts {
  int outside = 0, undecided = 0, kept = 0;
};

/// Boxes whose p-vertex lies near a plane: whatever the filter decides, the double test agrees, for
/// the box and for its p-vertex alone (the most extreme box inside it).
Counts agree(double reach, const glm::vec3& origin, double off_in_margins) {
  Random random(11);
  Counts counts;
  for (int i = 0; i < 60000; ++i) {
    const Frustum frustum = frustum_of(random_camera(random, reach, origin));
    const std::size_t index = random.below(static_cast<std::uint64_t>(frustum.plane_count));
    const Plane& plane = frustum.planes[index];
    const double margin = reach * 1e-6;
    const Plane shifted{plane.normal, plane.d + glm::dot(plane.normal, glm::dvec3(origin)), 0.0};
    const glm::vec3 corner = point_near(shifted, random, reach, margin * off_in_margins) + origin;
    const float size = static_cast<float>(random.uniform(0.0, reach));
    Aabb box{corner, corner};
    for (int axis = 0; axis < 3; ++axis) {
      if (plane.normal[axis] >= 0.0) {
        box.min[axis] -= size;
      } else {
        box.max[axis] += size;
      }
    }
    const Aabb relative{box.min - origin, box.max - origin};
    float extent = 0.0F;
    for (int axis = 0; axis < 3; ++axis) {
      extent = std::max({extent, std::abs(relative.min[axis]), std::abs(relative.max[axis])});
    }
    const FrustumFilter filter(frustum, origin, extent);
    const float value = p_value(filter.planes()[index], relative);
    if (value < -1.0F) {
      ++counts.outside;
      EXPECT_TRUE(surely_outside(plane, box)) << i;
      EXPECT_TRUE(surely_outside(plane, Aabb{corner, corner})) << i;
    } else if (value > 1.0F) {
      ++counts.kept;
      EXPECT_FALSE(surely_outside(plane, box)) << i;
    } else {
      ++counts.undecided;
    }
  }
  return counts;
}

TEST(FrustumFilter, DecidesOnlyWhatTheDoubleTestAgreesWith) {
  for (const double reach : {1e-3, 10.0, 1e4, 1e8}) {
    const Counts near = agree(reach, glm::vec3(0.0F), 1.0);
    EXPECT_GT(near.outside, 1000) << reach;
    EXPECT_GT(near.kept, 1000) << reach;
    EXPECT_GT(near.undecided, 1000) << reach;
  }
}

TEST(FrustumFilter, KnowsScenesFarFromTheOrigin) {
  const Counts far = agree(10.0, {1e6F, -3e5F, 2e6F}, 1e5);
  EXPECT_GT(far.outside, 1000);
  EXPECT_GT(far.kept, 1000);
}

TEST(FrustumFilter, DecidesNearlyAllThatIsNotNearAPlane) {
  const Counts clear = agree(100.0, glm::vec3(0.0F), 1000.0);
  EXPECT_LT(clear.undecided, 200);
}

TEST(FrustumFilter, ConcludesNothingFromNaN) {
  const Camera camera{look_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}),
                      perspective_lens(1.0, 1.0, 0.1, 100.0)};
  const FrustumFilter filter(frustum_of(camera), glm::vec3(0.0F), 10.0F);
  ASSERT_EQ(filter.planes().size(), 6U);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const FilterPlane& plane : filter.planes()) {
    const float value = plane.value(nan, nan, nan);
    EXPECT_FALSE(value < -1.0F);
    EXPECT_FALSE(value > 1.0F);
  }
}

TEST(FrustumFilter, HasNoFarPlaneWithoutAFarDistance) {
  const Camera camera{look_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}),
                      perspective_lens(1.0, 1.0, 0.1, std::numeric_limits<double>::infinity())};
  EXPECT_EQ(FrustumFilter(frustum_of(camera), glm::vec3(0.0F), 10.0F).planes().size(), 5U);
}

}  // namespace
}  // namespace vislab
