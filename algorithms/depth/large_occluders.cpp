#include "algorithms/depth/large_occluders.h"

#include <numbers>

namespace vislab::depth_culling {
namespace {

constexpr std::size_t most = 4096;
constexpr double times_the_median = 8.0;
constexpr std::uint32_t few_triangles = 256;

Aabb box_as_built(const Scene& scene, ObjectId object) {
  return transformed(scene.mesh_of(object).bounds, scene.objects[object].transform);
}

}  // namespace

void LargeOccluders::build(const Scene& scene) {
  scene_ = &scene;
  objects_.clear();
  std::vector<double> areas(scene.object_count());
  for (ObjectId object = 0; object < areas.size(); ++object) {
    areas[object] = half_area(box_as_built(scene, object));
  }
  std::vector<double> sorted = areas;
  const auto median = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, median);
  for (ObjectId object = 0; object < areas.size(); ++object) {
    if (areas[object] >= times_the_median * *median &&
        scene.triangle_count(object) <= few_triangles) {
      objects_.push_back(object);
    }
  }
  if (objects_.size() > most) {
    std::ranges::stable_sort(objects_, [&](ObjectId a, ObjectId b) { return areas[a] > areas[b]; });
    objects_.resize(most);
    std::ranges::sort(objects_);
  }
  by_key_.reserve(objects_.size());
  order_.reserve(objects_.size());
  draws_.resize(objects_.size());
  hidden_.resize(objects_.size());
  changed_ = true;
  reset();
}

void LargeOccluders::reset() {
  if (!changed_) return;
  shown_.assign(objects_.size(), 1);
  boxes_.assign((objects_.size() + BoxColumns::width - 1) / BoxColumns::width, {});
  for (std::size_t slot = 0; slot < objects_.size(); ++slot) {
    place(slot, box_as_built(*scene_, objects_[slot]));
  }
  changed_ = false;
}

void LargeOccluders::update(const Frame& frame, const Changes& changes) {
  if (changes.empty() || objects_.empty()) return;
  const auto for_each_large = [&](const std::vector<ObjectId>& objects, auto&& f) {
    for (const ObjectId object : objects) {
      const std::size_t slot = slot_of(object);
      if (slot < objects_.size()) f(slot);
    }
  };
  for_each_large(changes.moved,
                 [&](std::size_t slot) { place(slot, frame.objects.bounds[objects_[slot]]); });
  for_each_large(changes.hidden, [&](std::size_t slot) { shown_[slot] = 0; });
  for_each_large(changes.shown, [&](std::size_t slot) { shown_[slot] = 1; });
  changed_ = true;
}

std::size_t LargeOccluders::bytes() const {
  return objects_.capacity() * sizeof(ObjectId) + shown_.capacity() +
         boxes_.capacity() * sizeof(BoxColumns) + by_key_.bytes() +
         order_.capacity() * sizeof(std::uint32_t) + draws_.capacity() * sizeof(RasterDraw) +
         hidden_.capacity();
}

/// Of the circle that the box's sphere is seen as.
double LargeOccluders::about_pixels(const Frame& frame, const Aabb& box) {
  const Lens& lens = frame.camera.lens;
  const double radius = glm::length(box.half_size());
  double px_per_m = frame.viewport.height / (lens.top - lens.bottom);
  if (lens.projection == Projection::perspective) {
    const double distance = std::max(frame.camera.planar_depth(box.center()), radius);
    px_per_m *= lens.near_m / distance;
  }
  return std::numbers::pi * radius * radius * px_per_m * px_per_m;
}

void LargeOccluders::place(std::size_t slot, const Aabb& box) {
  boxes_[slot / BoxColumns::width].put(slot % BoxColumns::width, box);
}

/// objects_.size() if it is none of them.
std::size_t LargeOccluders::slot_of(ObjectId object) const {
  const auto at = std::ranges::lower_bound(objects_, object);
  if (at == objects_.end() || *at != object) return objects_.size();
  return static_cast<std::size_t>(at - objects_.begin());
}

}  // namespace vislab::depth_culling
