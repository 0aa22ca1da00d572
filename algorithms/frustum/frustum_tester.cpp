#include "algorithms/frustum/frustum_tester.h"

#include <bit>
#include <cmath>
#include <limits>

namespace vislab::frustum_culling {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Share of a box's coordinates by which it must be clear of a plane for something to hold of all
/// boxes inside it: four times the error that surely_outside() grants one point (distance_error),
/// which may be greater for a box inside than for the box itself.
constexpr double clear_share = 64.0 * epsilon;

constexpr std::uint8_t no_plane = 0xFF;

constexpr PlaneMask bit(std::size_t plane) { return static_cast<PlaneMask>(1U << plane); }

/// The planes 2 i and 2 i + 1 of a frustum face each other: left and right, bottom and top, near
/// and far.
constexpr PlaneMask pair_bits(std::size_t pair) { return static_cast<PlaneMask>(3U << (2 * pair)); }

}  // namespace

std::vector<ParameterSpec> switch_parameters(bool hierarchy) {
  const auto query = ParameterSpec::Stage::query;
  std::vector<ParameterSpec> parameters;
  if (hierarchy) {
    parameters.push_back(ParameterSpec::boolean(
        "masking", true, query,
        "planes that a node is inside of are not tested again below it; off tests all six of every "
        "node"));
  }
  parameters.insert(
      parameters.end(),
      {ParameterSpec::boolean("plane_coherence", false, query,
                              "the plane that excluded a box last time is tested first"),
       ParameterSpec::boolean(
           "motion_coherence", false, query,
           "a box outside of a side plane is not tested while the camera only turns away from that "
           "plane by less than 180 degrees - fov, or only translates and stays clear of it"),
       ParameterSpec::boolean(
           "octant", false, query,
           "of two opposite planes only the one that the middle of the box is nearer to is tested"),
       ParameterSpec::choice(
           "meta", "off", {"off", "sphere", "box"}, query,
           "volume around the frustum that a box is compared with first; nothing is gained with an "
           "infinite far plane")});
  return parameters;
}

Switches read_switches(const ParameterValues& values) {
  Switches switches;
  const auto masking = values.all().find("masking");
  if (masking != values.all().end()) switches.masking = values.boolean("masking");
  switches.plane_coherence = values.boolean("plane_coherence");
  switches.motion_coherence = values.boolean("motion_coherence");
  switches.octant = values.boolean("octant");
  const std::string& meta = values.choice("meta");
  if (meta == "sphere") switches.meta = Switches::Meta::sphere;
  if (meta == "box") switches.meta = Switches::Meta::box;
  return switches;
}

/// The coordinates of a box, so that a vertex is three look-ups.
struct FrustumTester::Corners {
  explicit Corners(const Aabb& box)
      : at{box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z} {}

  double to_p_vertex(const TestPlane& plane) const { return distance(plane, plane.p); }
  double to_n_vertex(const TestPlane& plane) const { return distance(plane, plane.n); }
  glm::dvec3 middle() const {
    return {0.5 * (at[0] + at[3]), 0.5 * (at[1] + at[4]), 0.5 * (at[2] + at[5])};
  }
  /// Share of the margin that depends on the box: on the sum of the absolute coordinates that a
  /// point of the box has at most.
  double error() const {
    return clear_share * (std::max(std::abs(at[0]), std::abs(at[3])) +
                          std::max(std::abs(at[1]), std::abs(at[4])) +
                          std::max(std::abs(at[2]), std::abs(at[5])));
  }

  std::array<double, 6> at;

 private:
  double distance(const TestPlane& plane, const std::array<std::uint8_t, 3>& vertex) const {
    return plane.normal.x * at[vertex[0]] + plane.normal.y * at[vertex[1]] +
           plane.normal.z * at[vertex[2]] + plane.d;
  }
};

/// What the octant test says of a box.
struct FrustumTester::Octant {
  PlaneMask skipped = 0;            // planes that cannot exclude the box
  std::array<double, 3> farther{};  // by pair: how much farther the skipped plane is off the middle
};

void FrustumTester::resize(std::size_t slots) {
  if (switches_.plane_coherence && slots > last_plane_.size()) last_plane_.resize(slots, no_plane);
  if (switches_.motion_coherence) motion_.resize(slots);
}

void FrustumTester::forget() {
  std::ranges::fill(last_plane_, no_plane);
  motion_.forget();
}

void FrustumTester::forget(std::uint32_t slot) {
  if (switches_.plane_coherence) last_plane_[slot] = no_plane;
  if (switches_.motion_coherence) motion_.forget(slot);
}

void FrustumTester::start(const Frame& frame) {
  const Camera& camera = frame.camera;
  frustum_ = frustum_of(camera);
  all_planes_ = static_cast<PlaneMask>((1U << static_cast<unsigned>(frustum_.plane_count)) - 1U);
  const auto prepared = [](const Plane& plane) {
    TestPlane test;
    test.normal = plane.normal;
    test.d = plane.d;
    test.error = clear_share * std::max(std::abs(plane.d), plane.magnitude);
    for (std::uint8_t axis = 0; axis < 3; ++axis) {
      const bool rises = plane.normal[axis] >= 0.0;
      test.p[axis] = static_cast<std::uint8_t>(rises ? axis + 3 : axis);
      test.n[axis] = static_cast<std::uint8_t>(rises ? axis : axis + 3);
    }
    return test;
  };
  for (std::size_t i = 0; i < planes_.size(); ++i) planes_[i] = prepared(frustum_.planes[i]);
  if (switches_.octant) {
    for (std::size_t pair = 0; pair < middles_.size(); ++pair) {
      const TestPlane& first = planes_[2 * pair];
      const TestPlane& second = planes_[2 * pair + 1];
      middles_[pair].normal = second.normal - first.normal;
      middles_[pair].d = second.d - first.d;
      middles_[pair].error = 2.0 * (first.error + second.error);
    }
    eye_to_near_m_ = camera.lens.projection == Projection::perspective
                         ? camera.lens.near_m
                         : std::numeric_limits<double>::infinity();
  }
  if (switches_.meta != Switches::Meta::off) meta_ = MetaVolumes(camera);
  if (switches_.motion_coherence) motion_.start(camera, frustum_);
}

Side FrustumTester::side(const Aabb& box, std::uint32_t slot, PlaneMask& mask) {
  if (!switches_.masking) mask = all_planes_;
  if (!box.valid()) return Side::intersecting;
  if (!switches_.plain()) return side_switched(box, slot, mask);
  const Corners corners(box);
  const double error = corners.error();
  for (PlaneMask rest = mask; rest != 0; rest &= rest - 1U) {
    const auto i = static_cast<std::size_t>(std::countr_zero(rest));
    ++plane_tests_;
    const double limit = error + planes_[i].error;
    if (corners.to_p_vertex(planes_[i]) < -limit) return Side::outside;
    if (corners.to_n_vertex(planes_[i]) > limit) mask &= static_cast<PlaneMask>(~bit(i));
  }
  return mask == 0 ? Side::inside : Side::intersecting;
}

bool FrustumTester::outside(const Aabb& box, std::uint32_t slot, PlaneMask mask) {
  if (!switches_.masking) mask = all_planes_;
  if (!switches_.plain()) return outside_switched(box, slot, mask);
  for (PlaneMask rest = mask; rest != 0; rest &= rest - 1U) {
    ++plane_tests_;
    const auto i = static_cast<std::size_t>(std::countr_zero(rest));
    if (surely_outside(frustum_.planes[i], box)) return true;
  }
  return false;
}

bool FrustumTester::decided_early(const Aabb& box, std::uint32_t slot) {
  const bool outside = (switches_.motion_coherence && motion_.still_outside(slot)) ||
                       (switches_.meta == Switches::Meta::sphere && meta_.outside_sphere(box)) ||
                       (switches_.meta == Switches::Meta::box && meta_.outside_box(box));
  skipped_tests_ += outside ? 1 : 0;
  return outside;
}

// The octant test. The middle planes run where the distances to two opposite planes are equal,
// which for a lens that is not centred is not the camera's own vertical and horizontal. If the
// middle of a box lies in front of the eye and nearer to plane A than to the opposite B, then it is
// not outside of B (what is outside of both lies behind the eye), and so neither is the box: B need
// not be asked whether it excludes the box. The source asks for small boxes instead (a bounding
// sphere smaller than the distance from the frustum's centre to its planes); then B may be taken
// for a plane that the box is inside of, which near the eye, where opposite planes come close, is
// not true. Here B is masked only where the box's sphere is clear of it. A plane that is not in
// `mask` is one that the box is inside of; `rest` are those of the mask that are still to be
// tested.
FrustumTester::Octant FrustumTester::octant_of(const Corners& corners, PlaneMask mask,
                                               PlaneMask rest) {
  Octant octant;
  const glm::dvec3 middle = corners.middle();
  const double error = corners.error();
  const auto distance = [&](const TestPlane& plane) {
    ++octant_tests_;
    return glm::dot(plane.normal, middle) + plane.d;
  };
  if ((mask & bit(Frustum::near)) != 0) {
    const TestPlane& near = planes_[Frustum::near];
    if (!(distance(near) + eye_to_near_m_ > error + near.error)) return octant;  // behind the eye
  }
  for (std::size_t pair = 0; pair < 3; ++pair) {
    if ((rest & pair_bits(pair)) != pair_bits(pair)) continue;
    const double difference = distance(middles_[pair]);
    if (!(std::abs(difference) > 4.0 * error + middles_[pair].error)) continue;
    octant.skipped |= bit(2 * pair + (difference > 0.0 ? 1 : 0));
    octant.farther[pair] = std::abs(difference);
  }
  return octant;
}

void FrustumTester::remember(std::uint32_t slot, std::size_t plane, const Aabb& box) {
  if (switches_.plane_coherence) last_plane_[slot] = static_cast<std::uint8_t>(plane);
  if (switches_.motion_coherence) {
    const Plane& p = frustum_.planes[plane];
    motion_.remember(slot, static_cast<int>(plane), p.signed_distance(p_vertex(p, box)), box);
  }
}

template <typename Excluded>
bool FrustumTester::last_plane_excludes(std::uint32_t slot, PlaneMask& rest, Excluded&& excluded) {
  if (!switches_.plane_coherence || last_plane_[slot] == no_plane) return false;
  const std::size_t last = last_plane_[slot];
  if ((rest & bit(last)) == 0) return false;
  rest &= static_cast<PlaneMask>(~bit(last));
  return excluded(last);
}

Side FrustumTester::side_switched(const Aabb& box, std::uint32_t slot, PlaneMask& mask) {
  if (decided_early(box, slot)) return Side::outside;
  const Corners corners(box);
  const double error = corners.error();
  std::array<double, 6> to_middle{};  // of the planes that are tested
  const auto excluded = [&](std::size_t i) {
    ++plane_tests_;
    const double limit = error + planes_[i].error;
    const double to_p = corners.to_p_vertex(planes_[i]);
    if (to_p < -limit) {
      remember(slot, i, box);
      return true;
    }
    const double to_n = corners.to_n_vertex(planes_[i]);
    if (to_n > limit) mask &= static_cast<PlaneMask>(~bit(i));
    to_middle[i] = 0.5 * (to_p + to_n);
    return false;
  };

  PlaneMask rest = mask;
  if (last_plane_excludes(slot, rest, excluded)) return Side::outside;
  const Octant octant = switches_.octant ? octant_of(corners, mask, rest) : Octant{};
  rest &= static_cast<PlaneMask>(~octant.skipped);
  for (; rest != 0; rest &= rest - 1U) {
    if (excluded(static_cast<std::size_t>(std::countr_zero(rest)))) return Side::outside;
  }
  if (octant.skipped != 0) {
    const double radius = glm::length(box.half_size());
    for (PlaneMask skipped = octant.skipped; skipped != 0; skipped &= skipped - 1U) {
      const auto i = static_cast<std::size_t>(std::countr_zero(skipped));
      const double to_skipped = to_middle[i ^ 1U] + octant.farther[i / 2];
      if (to_skipped > radius + 8.0 * (error + planes_[i].error + planes_[i ^ 1U].error)) {
        mask &= static_cast<PlaneMask>(~bit(i));
      }
    }
  }
  return mask == 0 ? Side::inside : Side::intersecting;
}

bool FrustumTester::outside_switched(const Aabb& box, std::uint32_t slot, PlaneMask mask) {
  if (decided_early(box, slot)) return true;
  const auto excluded = [&](std::size_t i) {
    ++plane_tests_;
    if (!surely_outside(frustum_.planes[i], box)) return false;
    remember(slot, i, box);
    return true;
  };
  PlaneMask rest = mask;
  if (last_plane_excludes(slot, rest, excluded)) return true;
  if (switches_.octant)
    rest &= static_cast<PlaneMask>(~octant_of(Corners(box), mask, rest).skipped);
  for (; rest != 0; rest &= rest - 1U) {
    if (excluded(static_cast<std::size_t>(std::countr_zero(rest)))) return true;
  }
  return false;
}

void FrustumTester::append_counters(Counters& counters) const {
  counters.emplace_back("plane_tests", plane_tests_);
  if (switches_.motion_coherence || switches_.meta != Switches::Meta::off) {
    counters.emplace_back("skipped_tests", skipped_tests_);
  }
  if (switches_.octant) counters.emplace_back("octant_tests", octant_tests_);
}

}  // namespace vislab::frustum_culling
