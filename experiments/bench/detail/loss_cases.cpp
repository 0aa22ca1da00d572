// What an object loses at most. The objects are convex, so that what each covers of the image is a
// convex polygon: its area, its perimeter and the pixel centres in it are found without any of the
// culler's formulas, and without what other objects hide of it.
#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/bench/detail/cases.h"
#include "experiments/bench/detail/workload.h"

namespace vislab {
namespace {

constexpr Viewport viewport{512, 512};
constexpr double thresholds_px[] = {1.0, 4.0, 16.0, 64.0, 256.0};

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// Convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<glm::dvec2> hull_of(std::vector<glm::dvec2> points) {
  std::ranges::sort(points, [](const glm::dvec2& a, const glm::dvec2& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  });
  std::vector<glm::dvec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const glm::dvec2& p : points) {
      while (hull.size() > start + 1 &&
             cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();  // it begins the other side
    std::ranges::reverse(points);
  }
  return hull;
}

struct Outline {
  double area_px = 0.0, perimeter_px = 0.0;
  std::size_t centres = 0;
};

bool holds(const std::vector<glm::dvec2>& hull, const glm::dvec2& p) {
  for (std::size_t i = 0; i < hull.size(); ++i) {
    if (cross(hull[(i + 1) % hull.size()] - hull[i], p - hull[i]) < 0.0) return false;
  }
  return true;
}

Outline outline_of(const std::vector<glm::dvec2>& hull) {
  Outline outline;
  glm::dvec2 low = hull[0], high = hull[0];
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const glm::dvec2& next = hull[(i + 1) % hull.size()];
    outline.area_px += 0.5 * cross(hull[i] - hull[0], next - hull[0]);
    outline.perimeter_px += glm::distance(hull[i], next);
    low = glm::min(low, next);
    high = glm::max(high, next);
  }
  for (double y = std::floor(low.y) + 0.5; y <= high.y; y += 1.0) {
    for (double x = std::floor(low.x) + 0.5; x <= high.x; x += 1.0) {
      if (holds(hull, {x, y})) ++outline.centres;
    }
  }
  return outline;
}

/// Of all objects that are left out and lie behind the near plane.
struct Losses {
  double worst_area = 0.0;     // ÷ threshold
  double worst_centres = 0.0;  // ÷ (threshold + P / 2 + 1)
  std::size_t objects = 0;
};

Losses losses_of(const std::string& culler, Shape shape) {
  const Scene scene = all_around(shape);
  const SceneState state(scene);
  const Camera camera = wide_camera();
  const glm::dmat4 view_projection = camera.view_projection();
  Losses losses;
  for (const double threshold_px : thresholds_px) {
    const std::string comma = culler.back() == ']' ? "," : "[";
    const std::string head = culler.back() == ']' ? culler.substr(0, culler.size() - 1) : culler;
    DetailSide side(head + comma + "threshold_px=" + std::to_string(threshold_px) + "]", scene);
    side.cull({0, camera, viewport, state.view(), 0.0});
    std::vector<std::uint8_t> is_kept(scene.object_count(), 0);
    for (const ObjectId object : side.kept()) is_kept[object] = 1;
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      if (is_kept[object] != 0) continue;
      std::vector<glm::dvec2> corners;
      bool in_front = true;
      for (const glm::vec3& corner : scene.mesh_of(object).positions) {
        const glm::dvec3 world = scene.objects[object].transform * glm::dvec4(corner, 1.0);
        const glm::dvec4 clip = view_projection * glm::dvec4(world, 1.0);
        in_front = in_front && clip.z > -clip.w;
        corners.push_back((0.5 * glm::dvec2(clip) / clip.w + 0.5) *
                          glm::dvec2(viewport.width, viewport.height));
      }
      if (!in_front) continue;
      const Outline outline = outline_of(hull_of(std::move(corners)));
      const double allowed = threshold_px + 0.5 * outline.perimeter_px + 1.0;
      losses.worst_area = std::max(losses.worst_area, outline.area_px / threshold_px);
      losses.worst_centres =
          std::max(losses.worst_centres, static_cast<double>(outline.centres) / allowed);
      ++losses.objects;
    }
  }
  return losses;
}

const Losses& known_losses_of(const std::string& culler, Shape shape) {
  static std::map<std::string, Losses> all;
  const auto known = all.find(culler);
  return known != all.end() ? known->second
                            : all.emplace(culler, losses_of(culler, shape)).first->second;
}

}  // namespace

void add_loss_cases(std::vector<BenchCase>& cases) {
  struct Row {
    const char* culler;
    Shape shape;
    Bar bar;
  };
  // What the printed estimate loses is a figure, not a promise.
  const Row rows[] = {{"detail.screen_size", Shape::sphere, Bar::at_most(1.0)},
                      {"detail.screen_size[area=box]", Shape::box, Bar::at_most(1.0)},
                      {"detail.wrong[error=printed_formula]", Shape::sphere, Bar()}};
  for (const Row& row : rows) {
    const std::string culler = row.culler;
    const Shape shape = row.shape;
    const auto some = [=] { return known_losses_of(culler, shape).objects > 1000; };
    cases.push_back({culler, "most covered area that an object loses, in thresholds", "times", "",
                     nullptr,
                     [=] {
                       return Measurement{known_losses_of(culler, shape).worst_area, some()};
                     },
                     row.bar});
    cases.push_back({culler, "most pixel centres that an object loses, in thresholds + P / 2 + 1",
                     "times", "", nullptr,
                     [=] {
                       return Measurement{known_losses_of(culler, shape).worst_centres, some()};
                     },
                     row.bar});
  }
}

}  // namespace vislab
