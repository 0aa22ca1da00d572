// Right tests of boxes against wrong frusta.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "algorithms/frustum/wrong_rules.h"
#include "common/geometry/frustum.h"
#include "common/geometry/thesis_frustum.h"

namespace vislab::frustum_culling {
namespace {

using MakeFrustum = Frustum (*)(const Camera& camera, double amount);

class WrongPlanes : public WrongRule {
 public:
  WrongPlanes(MakeFrustum make, double amount) : make_(make), amount_(amount) {}
  void start(const Frame& frame) override { frustum_ = make_(frame.camera, amount_); }
  bool culls(ObjectId object, const Frame& frame) override {
    const Aabb& box = frame.objects.bounds[object];
    return std::ranges::any_of(frustum_.span(),
                               [&](const Plane& plane) { return surely_outside(plane, box); });
  }

 private:
  MakeFrustum make_;
  double amount_;
  Frustum frustum_;
};

/// The thesis's construction with one of its errors. It knows centred perspective lenses with a far
/// plane only: a window is taken as centred, an infinite far plane as very far, and an orthographic
/// lens gets its right planes.
Frustum thesis_planes(const Camera& camera, double reference_m, const glm::dvec3& up,
                      const ThesisErrors& errors) {
  const Lens& lens = camera.lens;
  if (lens.projection == Projection::orthographic) return frustum_of(camera);
  const double width = lens.right - lens.left;
  const double height = lens.top - lens.bottom;
  ThesisCamera thesis;
  thesis.eye = camera.pose.eye;
  thesis.reference = camera.pose.eye - camera.pose.back * reference_m;
  thesis.up = up;
  thesis.angle_deg = 2.0 * std::atan(0.5 * height / lens.near_m) * 180.0 / std::numbers::pi;
  thesis.aspect = width / height;
  thesis.near_m = lens.near_m;
  thesis.far_m = std::min(lens.far_m, 1e6 * lens.near_m);
  return thesis_frustum(thesis, errors).frustum;
}

/// As frustum_of, but all of it in float and in the coordinates of the world.
class FloatPlanes : public WrongRule {
 public:
  void start(const Frame& frame) override {
    const Camera& camera = frame.camera;
    const Frustum exact = frustum_of(camera);
    const glm::vec3 eye(camera.pose.eye);
    const glm::vec3 forward(-camera.pose.back);
    const glm::vec3 right(camera.pose.right);
    const glm::vec3 up(camera.pose.up);
    const Lens& lens = camera.lens;
    const bool perspective = lens.projection == Projection::perspective;
    const auto metres = [](double value) { return static_cast<float>(value); };
    count_ = exact.plane_count;
    for (int i = 0; i < count_; ++i) {
      const auto index = static_cast<std::size_t>(i);
      normals_[index] = glm::vec3(exact.planes[index].normal);
      glm::vec3 point = eye;
      if (i == Frustum::near) point += forward * metres(lens.near_m);
      if (i == Frustum::far) point += forward * metres(lens.far_m);
      if (!perspective) {
        if (i == Frustum::left) point += right * metres(lens.left);
        if (i == Frustum::right) point += right * metres(lens.right);
        if (i == Frustum::bottom) point += up * metres(lens.bottom);
        if (i == Frustum::top) point += up * metres(lens.top);
      }
      distances_[index] = -glm::dot(normals_[index], point);
    }
  }

  bool culls(ObjectId object, const Frame& frame) override {
    const Aabb& box = frame.objects.bounds[object];
    for (int i = 0; i < count_; ++i) {
      const auto index = static_cast<std::size_t>(i);
      const glm::vec3& n = normals_[index];
      const glm::vec3 p(n.x >= 0.0F ? box.max.x : box.min.x, n.y >= 0.0F ? box.max.y : box.min.y,
                        n.z >= 0.0F ? box.max.z : box.min.z);
      if (glm::dot(n, p) + distances_[index] < 0.0F) return true;
    }
    return false;
  }

 private:
  int count_ = 0;
  std::array<glm::vec3, 6> normals_{};
  std::array<float, 6> distances_{};
};

std::unique_ptr<WrongRule> planes(MakeFrustum make, double amount) {
  return std::make_unique<WrongPlanes>(make, amount);
}

}  // namespace

std::unique_ptr<WrongRule> tangent_of_degrees(double amount) {
  return planes(
      [](const Camera& camera, double) {
        ThesisErrors errors;
        errors.angle_in_degrees = true;
        return thesis_planes(camera, 1.0, camera.pose.up, errors);
      },
      amount);
}

std::unique_ptr<WrongRule> direction_not_normalised(double amount) {
  return planes(
      [](const Camera& camera, double) {
        ThesisErrors errors;
        errors.direction_not_normalised = true;
        // In the thesis's example the viewer is 5 m from what it looks at.
        return thesis_planes(camera, 5.0, camera.pose.up, errors);
      },
      amount);
}

std::unique_ptr<WrongRule> up_as_given(double amount) {
  return planes(
      [](const Camera& camera, double) {
        ThesisErrors errors;
        errors.up_as_given = true;
        return thesis_planes(camera, 1.0, {0.0, 1.0, 0.0}, errors);
      },
      amount);
}

std::unique_ptr<WrongRule> symmetric_lens(double amount) {
  return planes(
      [](const Camera& camera, double) {
        Camera centred = camera;
        centred.lens.right = 0.5 * (camera.lens.right - camera.lens.left);
        centred.lens.left = -centred.lens.right;
        centred.lens.top = 0.5 * (camera.lens.top - camera.lens.bottom);
        centred.lens.bottom = -centred.lens.top;
        return frustum_of(centred);
      },
      amount);
}

std::unique_ptr<WrongRule> one_eye(double amount) {
  return planes(
      [](const Camera& camera, double between_eyes_m) {
        Camera left = camera;
        left.pose.eye -= camera.pose.right * between_eyes_m;
        return frustum_of(left);
      },
      amount);
}

std::unique_ptr<WrongRule> float_planes(double) { return std::make_unique<FloatPlanes>(); }

}  // namespace vislab::frustum_culling
