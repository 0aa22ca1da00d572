#include "common/scene/paths/motion_settings.h"

#include <limits>

#include "common/scene/error.h"

namespace vislab {
namespace {

constexpr double fastest_m_s = 1e9;

RevolveMotion read_revolve(const Settings& table, const PathPoints& points, const Scene& scene) {
  RevolveMotion revolve;
  revolve.center = table.has("center") ? points.one(table, "center") : scene.bounds().center();
  revolve.min_speed_m_s = table.number("min_speed_m_s", 0.0, fastest_m_s);
  revolve.max_speed_m_s = table.number("max_speed_m_s", revolve.min_speed_m_s, fastest_m_s);
  revolve.max_spin_deg_s = table.number("max_spin_deg_s", 0.0, 36'000.0, revolve.max_spin_deg_s);
  return revolve;
}

double read_share(const Settings& table) { return table.number("share", 1e-9, 1.0, 1.0); }

DriftMotion read_drift(const Settings& table) {
  DriftMotion drift;
  drift.share = read_share(table);
  drift.min_speed_m_s = table.number("min_speed_m_s", 0.0, fastest_m_s);
  drift.max_speed_m_s = table.number("max_speed_m_s", drift.min_speed_m_s, fastest_m_s);
  drift.border = table.number("border", 1.0, 1000.0, drift.border);
  return drift;
}

DepartMotion read_depart(const Settings& table) {
  DepartMotion depart;
  depart.share = read_share(table);
  depart.factor = table.number("factor", 0.0, 1000.0, depart.factor);
  return depart;
}

ObjectId read_object(const Settings& table) {
  return static_cast<ObjectId>(table.whole("object", 0, none_id - 1, 0));
}

SlideMotion read_slide(const Settings& table) {
  SlideMotion slide;
  slide.object = read_object(table);
  slide.velocity_m_s = table.point("velocity_m_s");
  if (!(glm::length(slide.velocity_m_s) <= fastest_m_s)) {
    throw InputError(table.where() + ": `velocity_m_s` is wrong; it must be at most 1e9 m/s");
  }
  slide.reach_m = table.number("reach_m", 1e-6, slide.reach_m, slide.reach_m);
  return slide;
}

}  // namespace

Motion read_motion(const Settings& table, const PathPoints& points, const Scene& scene) {
  Motion motion;
  motion.duration_s = table.number("duration_s", 0.0, 1e6, motion.duration_s);
  motion.seed = static_cast<std::uint64_t>(
      table.whole("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  const std::string kind = table.text("kind");
  if (kind == "revolve") {
    motion.kind = read_revolve(table, points, scene);
  } else if (kind == "drift") {
    motion.kind = read_drift(table);
  } else if (kind == "churn") {
    motion.kind = ChurnMotion{static_cast<std::uint32_t>(table.whole("count", 1, 1'000'000'000))};
  } else if (kind == "depart") {
    motion.kind = read_depart(table);
  } else if (kind == "slide") {
    motion.kind = read_slide(table);
  } else if (kind == "toggle") {
    motion.kind = ToggleMotion{read_object(table), table.number("toggles_per_s", 0.0, 1e6)};
  } else {
    throw InputError(table.where() + ": " +
                     unknown_name("kind of motion", kind,
                                  {"churn", "depart", "drift", "revolve", "slide", "toggle"})
                         .what());
  }
  table.done();
  return motion;
}

}  // namespace vislab
