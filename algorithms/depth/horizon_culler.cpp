#include "algorithms/depth/horizon_culler.h"

#include <algorithm>

#include "common/geometry/random.h"
#include "common/geometry/rounding.h"

namespace vislab::depth_culling {
namespace {

/// In [-1, 1), by the object's id alone.
double noise(ObjectId object) { return Random(object * Random::increment).uniform(-1.0, 1.0); }

/// The nearness of the box's farthest corner.
float farthest_nearness(const WindowTransform& window, const Aabb& box) {
  double farthest = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1) != 0 ? box.max.x : box.min.x,
                            (i & 2) != 0 ? box.max.y : box.min.y,
                            (i & 4) != 0 ? box.max.z : box.min.z);
    const double depth = window.world()(corner).depth;
    farthest = i == 0 ? depth : std::max(farthest, depth);
  }
  return round_down(window.nearness(farthest));
}

// Nearest first; of equals nodes, then by id, so that the order is always the same.
constexpr auto later = [](const auto& a, const auto& b) {
  if (a.place.nearness != b.place.nearness) return a.place.nearness < b.place.nearness;
  if (a.node != b.node) return b.node;
  return a.id > b.id;
};
constexpr auto farther = [](const auto& a, const auto& b) {
  if (a.place.nearness != b.place.nearness) return a.place.nearness < b.place.nearness;
  return a.object > b.object;
};

}  // namespace

HorizonCuller::HorizonCuller(CullerInfo info, const HorizonOptions& options)
    : info_(std::move(info)),
      options_(options),
      tree_(Bvh::Limits{Bvh::Build::top_down, Bvh::Motion::refit, 4}),
      window_(Camera{}, Viewport{}),
      horizon_(options.ground) {}

void HorizonCuller::build(const Scene& scene, const BuildContext&) {
  scene_ = &scene;
  parts_.clear();
  for (const Mesh& mesh : scene.meshes) parts_.push_back(convex_parts(mesh));
  kept_.reserve(scene.object_count());
  offered_.resize(scene.object_count());
  tree_.build(scene);
}

void HorizonCuller::reset(std::uint64_t) {
  frame_ = ~std::uint64_t{0};
  tree_.reset();
}

void HorizonCuller::update(const Frame& frame, const Changes& changes) {
  tree_.update(frame, changes);
}

void HorizonCuller::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  window_ = WindowTransform(frame.camera, frame.viewport);
  horizon_.begin(frame.viewport);
  waiting_.clear();
  kept_.clear();
  const bool everything = candidates.form() == Candidates::Form::everything;
  // What earlier calls of this frame have kept hides as well, but each sweep begins at the eye.
  if (everything || frame.index != frame_) frame_covers_.clear();
  frame_ = frame.index;
  occluders_ = frame_covers_;
  std::ranges::make_heap(occluders_, farther);
  walks_list_ = !everything && note_offered(candidates, frame);
  if (everything || walks_list_) {
    for (const ObjectId object : tree_.structure().unplaced()) add_object(object, frame);
    add_node(SpatialStructure::root, frame);
  } else {
    for (const auto run : candidates.object_runs()) {
      for (const ObjectId object : run) add_object(object, frame);
    }
  }
  look_at_waiting(frame);
  out.objects(kept_);
}

void HorizonCuller::add_node(SpatialStructure::NodeIndex index, const Frame& frame) {
  const SpatialNode& node = tree_.structure().nodes()[index];
  if (node.box.empty()) return;
  ++nodes_tested_;
  Waiting item{{}, index, true};
  switch (project_box(window_, node.box, Coverage::centres, item.place)) {
    case BoxPlace::outside:
      return;
    case BoxPlace::undecided:
      for (std::uint32_t i = 0; i < node.child_count; ++i) add_node(node.first_child + i, frame);
      for (const ObjectId object : tree_.structure().objects_at(index)) add_object(object, frame);
      return;
    case BoxPlace::inside:
      break;
  }
  if (options_.distance_error > 0.0) {
    // Not to be later than what is in it.
    const double least = 1.0 - options_.distance_error;
    item.place.nearness =
        static_cast<float>(item.place.nearness * (window_.perspective() ? 1.0 / least : least));
  }
  waiting_.push_back(item);
  std::ranges::push_heap(waiting_, later);
}

bool HorizonCuller::note_offered(const Candidates& candidates, const Frame& frame) {
  std::size_t count = 0;
  for (const auto run : candidates.object_runs()) count += run.size();
  if (count * short_list_part < frame.objects.shown.size()) return false;
  offered_.clear();
  for (const auto run : candidates.object_runs()) {
    for (const ObjectId object : run) offered_.insert(object);
  }
  return true;
}

void HorizonCuller::add_object(ObjectId object, const Frame& frame) {
  if (walks_list_ && !offered_.contains(object)) return;
  ++boxes_tested_;
  Waiting item{{}, object, false};
  switch (project_box(window_, frame.objects.bounds[object], Coverage::centres, item.place)) {
    case BoxPlace::outside:
      return;
    case BoxPlace::undecided:
      keep(object, frame, true);
      return;
    case BoxPlace::inside:
      break;
  }
  item.place.nearness = static_cast<float>(item.place.nearness * error_factor(object));
  waiting_.push_back(item);
  std::ranges::push_heap(waiting_, later);
}

void HorizonCuller::look_at_waiting(const Frame& frame) {
  while (!waiting_.empty()) {
    std::ranges::pop_heap(waiting_, later);
    const Waiting item = waiting_.back();
    waiting_.pop_back();
    raise_horizon(item.place.nearness);
    if (horizon_.hides(item.place)) continue;
    if (!item.node) {
      const double pixels =
          static_cast<double>(item.place.x1 - item.place.x0) * (item.place.y1 - item.place.y0);
      keep(item.id, frame, pixels >= options_.occluder_px);
      continue;
    }
    const SpatialNode& node = tree_.structure().nodes()[item.id];
    for (std::uint32_t i = 0; i < node.child_count; ++i) add_node(node.first_child + i, frame);
    for (const ObjectId object : tree_.structure().objects_at(item.id)) add_object(object, frame);
  }
}

void HorizonCuller::keep(ObjectId object, const Frame& frame, bool covers) {
  kept_.push_back(object);
  if (!covers) return;
  const auto add = [&](BoxWindow place) {
    place.nearness = static_cast<float>(place.nearness * error_factor(object));
    frame_covers_.push_back({place, object});
    occluders_.push_back({place, object});
    std::ranges::push_heap(occluders_, farther);
  };
  BoxWindow place;
  if (options_.cover == HorizonOptions::Cover::around) {
    const Aabb& box = frame.objects.bounds[object];
    if (project_box(window_, box, Coverage::centres, place) != BoxPlace::inside) return;
    place.nearness = farthest_nearness(window_, box);
    add(place);
    return;
  }
  for (const ConvexPart& part : parts_[scene_->objects[object].mesh]) {
    if (covered_rectangle(window_, frame.objects.transforms[object], part, place)) add(place);
  }
}

void HorizonCuller::raise_horizon(float nearness) {
  while (!occluders_.empty() && occluders_.front().place.nearness > nearness) {
    horizon_.add(occluders_.front().place);
    ++rectangles_joined_;
    std::ranges::pop_heap(occluders_, farther);
    occluders_.pop_back();
  }
}

double HorizonCuller::error_factor(ObjectId object) const {
  if (options_.distance_error == 0.0) return 1.0;
  const double error = options_.distance_error * noise(object);
  return window_.perspective() ? 1.0 / (1.0 + error) : 1.0 + error;
}

std::size_t HorizonCuller::bytes() const {
  std::size_t bytes =
      tree_.bytes() + horizon_.bytes() + offered_.bytes() + parts_.capacity() * sizeof(parts_[0]);
  for (const std::vector<ConvexPart>& parts : parts_) bytes += bytes_of(parts);
  bytes += waiting_.capacity() * sizeof(Waiting) + kept_.capacity() * sizeof(ObjectId);
  return bytes + (occluders_.capacity() + frame_covers_.capacity()) * sizeof(Occluder);
}

Counters HorizonCuller::counters() const {
  return {{"nodes_tested", nodes_tested_},
          {"objects_tested", boxes_tested_},
          {"rectangles_joined", rectangles_joined_}};
}

}  // namespace vislab::depth_culling
