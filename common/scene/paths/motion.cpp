#include "common/scene/paths/motion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>

#include "common/geometry/random.h"
#include "common/scene/error.h"
#include "common/scene/orientation.h"

namespace vislab {
namespace {

using Times = std::vector<double>;

/// An object's own numbers, whatever others there are.
Random random_of(std::uint64_t seed, ObjectId object) {
  return Random(Random(seed).bits() + object);
}

/// All ids in a seeded order (Fisher and Yates).
std::vector<ObjectId> shuffled_ids(const Scene& scene, std::uint64_t seed) {
  std::vector<ObjectId> ids(scene.object_count());
  std::iota(ids.begin(), ids.end(), 0U);
  Random random(seed);
  for (std::size_t i = ids.size(); i > 1; --i) std::swap(ids[i - 1], ids[random.below(i)]);
  return ids;
}

/// The ids of a share of the objects, ascending.
std::vector<ObjectId> chosen(const Scene& scene, double share, std::uint64_t seed) {
  std::vector<ObjectId> ids = shuffled_ids(scene, seed);
  const auto count =
      static_cast<std::size_t>(std::llround(share * static_cast<double>(ids.size())));
  ids.resize(std::clamp<std::size_t>(count, 1, ids.size()));
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// The middle of an object's mesh box, in the world.
glm::dvec3 middle_of(const Scene& scene, ObjectId object) {
  return scene.objects[object].transform * glm::dvec4(scene.mesh_of(object).bounds.center(), 1.0);
}

/// An object turned about its middle, which is then put elsewhere.
glm::dmat4x3 placed(const Scene& scene, ObjectId object, const glm::dmat3& turn,
                    const glm::dvec3& middle) {
  const glm::dmat4x3& built = scene.objects[object].transform;
  glm::dmat4x3 transform(0.0);
  for (int column = 0; column < 3; ++column) transform[column] = turn * built[column];
  transform[3] = middle + turn * (built[3] - middle_of(scene, object));
  return transform;
}

glm::dmat4x3 shifted(glm::dmat4x3 transform, const glm::dvec3& by) {
  transform[3] += by;
  return transform;
}

/// A coordinate that goes on from `from` by `way` and is thrown back at both borders.
double reflected(double from, double way, double low, double high) {
  const double width = high - low;
  if (!(width > 0.0)) return from;
  const double start = std::clamp(from, low, high) - low;
  const double folded = std::abs(std::remainder(start + way, 2.0 * width));
  return low + std::min(folded, width);
}

/// Gives the transform of an object at a time in [0, 1].
using Mover = std::function<glm::dmat4x3(ObjectId, double)>;

std::vector<Changes> moves(const Scene& scene, const std::vector<ObjectId>& ids, const Times& times,
                           const Mover& mover) {
  if (ids.size() > max_path_moves / times.size()) {
    throw InputError(std::to_string(ids.size()) + " objects that move in " +
                     std::to_string(times.size()) + " frames are more than " +
                     std::to_string(max_path_moves) +
                     " movements; let a smaller share of them move, or take fewer frames");
  }
  std::vector<Changes> changes(times.size());
  for (const ObjectId id : ids) {
    glm::dmat4x3 before = scene.objects[id].transform;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (times[i] == 0.0) continue;
      const glm::dmat4x3 now = mover(id, times[i]);
      if (now == before) continue;
      changes[i].moved.push_back(id);
      changes[i].transforms.push_back(now);
      before = now;
    }
  }
  return changes;
}

class Maker {
 public:
  Maker(const Motion& motion, const Scene& scene, const Times& times)
      : motion_(motion), scene_(scene), times_(times) {}

  std::vector<Changes> operator()(const RevolveMotion& revolve) const {
    std::vector<ObjectId> ids(scene_.object_count());
    std::iota(ids.begin(), ids.end(), 0U);
    return moves(scene_, ids, times_, [&](ObjectId id, double time) {
      Random random = random_of(motion_.seed, id);
      const double seconds = time * motion_.duration_s;
      const double speed_m_s = random.uniform(revolve.min_speed_m_s, revolve.max_speed_m_s);
      const double spin_deg_s = random.uniform(0.0, revolve.max_spin_deg_s);
      const glm::dvec3 axis = random_direction(random);
      const glm::dvec3 arm = middle_of(scene_, id) - revolve.center;
      const double distance = std::hypot(arm.x, arm.z);
      const double angle = distance > 0.0 ? speed_m_s * seconds / distance : 0.0;
      return placed(scene_, id, rotation(axis, spin_deg_s * seconds * std::numbers::pi / 180.0),
                    revolve.center + rotation({0.0, 1.0, 0.0}, angle) * arm);
    });
  }

  std::vector<Changes> operator()(const DriftMotion& drift) const {
    const Aabb& box = scene_.bounds();
    const glm::dvec3 low = box.center() - box.half_size() * drift.border;
    const glm::dvec3 high = box.center() + box.half_size() * drift.border;
    const std::vector<ObjectId> ids = chosen(scene_, drift.share, motion_.seed);
    return moves(scene_, ids, times_, [&](ObjectId id, double time) {
      Random random = random_of(motion_.seed, id);
      const double speed_m_s = random.uniform(drift.min_speed_m_s, drift.max_speed_m_s);
      const glm::dvec3 way = random_direction(random) * (speed_m_s * time * motion_.duration_s);
      const glm::dvec3 from = middle_of(scene_, id);
      glm::dvec3 to;
      for (int axis = 0; axis < 3; ++axis) {
        to[axis] = reflected(from[axis], way[axis], low[axis], high[axis]);
      }
      return shifted(scene_.objects[id].transform, to - from);
    });
  }

  std::vector<Changes> operator()(const ChurnMotion& churn) const {
    const std::vector<ObjectId> order = shuffled_ids(scene_, motion_.seed);
    if (churn.count > order.size() / 2) {
      throw InputError("a churn of " + std::to_string(churn.count) + " objects needs twice as " +
                       "many in the scene; it has " + std::to_string(order.size()));
    }
    std::vector<Changes> changes(times_.size());
    std::size_t next = 0;
    for (std::size_t i = 1; i < changes.size(); ++i) {
      changes[i].shown = changes[i - 1].hidden;
      for (std::uint32_t j = 0; j < churn.count; ++j) {
        changes[i].hidden.push_back(order[next]);
        next = (next + 1) % order.size();
      }
      std::sort(changes[i].hidden.begin(), changes[i].hidden.end());
    }
    return changes;
  }

  std::vector<Changes> operator()(const DepartMotion& depart) const {
    const Aabb& box = scene_.bounds();
    const glm::dvec3 half = box.half_size();
    const double reach_m = depart.factor * std::max({half.x, half.y, half.z});
    const std::vector<ObjectId> ids = chosen(scene_, depart.share, motion_.seed);
    return moves(scene_, ids, times_, [&](ObjectId id, double time) {
      const glm::dvec3 from = middle_of(scene_, id);
      glm::dvec3 ray = from - box.center();
      if (ray == glm::dvec3(0.0)) {
        Random random = random_of(motion_.seed, id);
        ray = random_direction(random);
      }
      const double largest = std::max({std::abs(ray.x), std::abs(ray.y), std::abs(ray.z)});
      const glm::dvec3 to = box.center() + ray * (reach_m / largest);
      return shifted(scene_.objects[id].transform, (to - from) * time);
    });
  }

  std::vector<Changes> operator()(const SlideMotion& slide) const {
    require(slide.object);
    const double speed_m_s = glm::length(slide.velocity_m_s);
    return moves(scene_, {slide.object}, times_, [&](ObjectId id, double time) {
      const glm::dmat4x3& built = scene_.objects[id].transform;
      if (speed_m_s == 0.0) return built;
      const double way_m =
          reflected(0.0, speed_m_s * time * motion_.duration_s, -slide.reach_m, slide.reach_m);
      return shifted(built, slide.velocity_m_s * (way_m / speed_m_s));
    });
  }

  std::vector<Changes> operator()(const ToggleMotion& toggle) const {
    require(toggle.object);
    std::vector<Changes> changes(times_.size());
    bool was_hidden = false;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      const double toggles = std::floor(times_[i] * motion_.duration_s * toggle.toggles_per_s);
      const bool hidden = std::fmod(toggles, 2.0) == 1.0;
      if (hidden != was_hidden) {
        (hidden ? changes[i].hidden : changes[i].shown).push_back(toggle.object);
      }
      was_hidden = hidden;
    }
    return changes;
  }

 private:
  void require(ObjectId object) const {
    if (object < scene_.object_count()) return;
    throw InputError("object " + std::to_string(object) +
                     " cannot slide or toggle; the scene has " + "objects 0 to " +
                     std::to_string(scene_.object_count() - 1));
  }

  const Motion& motion_;
  const Scene& scene_;
  const Times& times_;
};

}  // namespace

std::vector<Changes> changes_of(const Motion& motion, const Scene& scene,
                                const std::vector<double>& times) {
  return std::visit(Maker(motion, scene, times), motion.kind);
}

Aabb reach_of(const Scene& scene, const std::vector<Changes>& changes) {
  Aabb reach = scene.bounds();
  for (const Changes& step : changes) {
    for (std::size_t i = 0; i < step.moved.size(); ++i) {
      reach.extend(transformed(scene.mesh_of(step.moved[i]).bounds, step.transforms[i]));
    }
  }
  return reach;
}

}  // namespace vislab
