// depth.masked: tests before it draws: what nearer things hide is neither kept nor drawn, whole
// subtrees at one question.
//
// Idea: nodes and objects of a bounding-volume hierarchy come out of a queue near first. Each box
// is
//   compared with a depth buffer that is drawn by software as the walk goes on: hidden nodes are
//   dropped with all below them, visible objects are kept, and drawn into the buffer if they are
//   large enough to hide others.
// Guarantee: image_exact: boxes are enlarged and occluders' depths lowered by more than what a
//   graphics device snaps and rounds; below full size only pixels that an occluder covers wholly
//   count. What may be cut by the near plane is kept.
// Cost: O(m log m) for m nodes and objects that are not below a hidden node, O(triangles drawn);
//   what is hidden or outside costs nothing by itself. update O(movers and their ancestors). A list
//   of candidates costs O(list) more.
// Limits: an object is seen as its box: what only shows through the box's empty corners is kept.
//   Where little is hidden it costs more than it saves: then it sleeps (worth.h), and what is
//   offered is kept, but for what is outside of the view if everything is offered.
// Sources: Hasselgren, Andersson, Akenine-Moeller 2016, Masked Software Occlusion Culling (layers,
//   test before drawing, order); Greene, Kass, Miller 1993 (hierarchy against depth buffer);
//   Zachmann slides 47, 59.

#include <algorithm>

#include "algorithms/depth/draw_order.h"
#include "algorithms/depth/frame_buffer.h"
#include "algorithms/depth/frustum_walk.h"
#include "algorithms/depth/occluders.h"
#include "algorithms/depth/worth.h"
#include "common/culler/registry.h"
#include "common/culler/stamps.h"
#include "common/geometry/frustum.h"
#include "common/spatial/bvh.h"
#include "common/spatial/followed_structure.h"

namespace vislab {
namespace {

using depth_culling::DrawKeys;
using depth_culling::DrawOrder;
using depth_culling::FrameBuffer;
using depth_culling::FrustumWalk;
using depth_culling::ObjectOrder;
using depth_culling::OccluderBudget;
using depth_culling::OccluderMeshes;
using depth_culling::Worth;

CullerInfo describe() {
  constexpr auto build = ParameterSpec::Stage::build;
  CullerInfo info;
  info.name = "depth.masked";
  info.family = "depth";
  info.summary =
      "Near first through a hierarchy: boxes are compared with a depth buffer drawn by software, "
      "hidden subtrees are dropped, visible objects are kept and drawn into the buffer.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.parameters = {depth_culling::scale_parameter(), depth_culling::draw_order_parameter()};
  for (ParameterSpec& spec : OccluderBudget::parameters()) {
    info.parameters.push_back(std::move(spec));
  }
  info.parameters.push_back(ParameterSpec::boolean(
      "sleep", true, ParameterSpec::Stage::query,
      "whether it stops for a while when hiding does not pay; without, frames without occlusion "
      "cost what they cost"));
  info.parameters.push_back(ParameterSpec::integer("leaf_size", 4, 1, 64, "objects", build,
                                                   "leaves of the hierarchy have at most so many"));
  info.cost =
      "O(m log m) for m nodes and objects that are not below a hidden node, O(triangles drawn into "
      "the buffer); update O(movers and their ancestors)";
  info.limits =
      "Objects are tested by their boxes. Sleeps while it does not pay, then keeps everything that "
      "it is offered as a list.";
  info.sources = {"Hasselgren, Andersson, Akenine-Moeller 2016, Masked Software Occlusion Culling",
                  "Greene, Kass, Miller 1993, Hierarchical Z-Buffer Visibility",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 47, 59"};
  return info;
}

Bvh::Limits limits_of(const ParameterValues& values) {
  Bvh::Limits limits;
  limits.build = Bvh::Build::top_down;
  limits.motion = Bvh::Motion::refit;
  limits.leaf_objects = static_cast<std::uint32_t>(values.integer("leaf_size"));
  return limits;
}

template <typename Raster>
class MaskedCuller : public ICuller {
 public:
  explicit MaskedCuller(const ParameterValues& values)
      : scale_(depth_culling::read_scale(values)),
        sleeps_(values.boolean("sleep")),
        keys_(depth_culling::read_draw_order(values)),
        budget_(values),
        buffer_(scale_, {depth_culling::conservative_setup(scale_), false, 1}),
        followed_(limits_of(values)) {}

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    meshes_.build(scene);
    followed_.build(scene);
    walk_.build(scene.object_count());
    stamps_.resize(scene.object_count());
    order_.reserve(scene.object_count());
    kept_.reserve(scene.object_count());
    queue_.reserve(1024);
    mean_triangles_ = static_cast<double>(scene.triangle_count()) /
                      static_cast<double>(std::max<std::size_t>(1, scene.object_count()));
  }

  void reset(std::uint64_t seed) override {
    followed_.reset();
    worth_.reset();
    buffer_.forget();
    keys_.reset(seed);
  }

  void update(const Frame& frame, const Changes& changes) override {
    followed_.update(frame, changes);
    worth_.note(frame, changes);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const bool everything = candidates.form() == Candidates::Form::everything;
    if (sleeps_ && !worth_.tries(frame)) {
      if (everything) {
        walk_.emit(followed_.structure(), frame, out);
      } else {
        for (const std::span<const ObjectId> run : candidates.object_runs()) out.objects(run);
      }
      return;
    }
    start(frame);
    if (everything) {
      all_offered_ = true;
      walk(frame);
    } else {
      cull_list(frame, candidates);
    }
    worth_.add(work_);
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return meshes_.bytes() + followed_.bytes() + walk_.bytes() + stamps_.bytes() + order_.bytes() +
           kept_.capacity() * sizeof(ObjectId) + queue_.capacity() * sizeof(Item) + buffer_.bytes();
  }

  Counters counters() const override {
    return {{"queries", queries_},
            {"objects_hidden", objects_hidden_},
            {"triangles_drawn", triangles_drawn_},
            {"frames_asleep", worth_.frames_asleep()}};
  }

 private:
  /// What waits to be looked at: an object by its id, node n as object_count + n.
  struct Item {
    float key;
    std::uint32_t id;
  };
  enum class Verdict { outside, hidden, visible };

  void start(const Frame& frame) {
    work_ = {};
    if (buffer_.start(frame)) {
      budget_.start();
      const Viewport& size = buffer_.raster().viewport();
      work_.buffer_pixels =
          static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
    }
    keys_.start(frame.camera);
    frustum_ = frustum_of(frame.camera);
    kept_.clear();
  }

  /// `box_px`: pixels of the frame that the box may cover, if it is visible.
  Verdict look(const Aabb& box, double& box_px) {
    ++queries_;
    ++work_.queries;
    Raster& raster = buffer_.raster();
    const Coverage coverage = depth_culling::conservative_setup(scale_).coverage;
    BoxWindow place;
    switch (project_box(raster.window(), box, coverage, place)) {
      case BoxPlace::outside:
        return Verdict::outside;
      case BoxPlace::undecided:
        for (const Plane& plane : frustum_.span()) {
          if (surely_outside(plane, box)) return Verdict::outside;
        }
        box_px = 1e9;
        return Verdict::visible;
      case BoxPlace::inside:
        break;
    }
    if (raster.hides(place)) return Verdict::hidden;
    box_px = static_cast<double>(place.x1 - place.x0) * (place.y1 - place.y0) * scale_ * scale_;
    return Verdict::visible;
  }

  void look_at_object(const Frame& frame, ObjectId object) {
    double box_px = 0.0;
    switch (look(frame.objects.bounds[object], box_px)) {
      case Verdict::outside:
        return;
      case Verdict::hidden:
        count_hidden(1, scene_->triangle_count(object));
        return;
      case Verdict::visible:
        break;
    }
    kept_.push_back(object);
    const std::uint32_t triangles = scene_->triangle_count(object);
    if (!budget_.take(box_px, triangles)) return;
    const RasterDraw draw = meshes_.of(object, frame);
    buffer_.raster().draw({&draw, 1});
    work_.drawn_triangles += triangles;
    triangles_drawn_ += triangles;
  }

  void count_hidden(std::uint64_t objects, std::uint64_t triangles) {
    work_.hidden_objects += objects;
    work_.hidden_triangles += triangles;
    objects_hidden_ += objects;
  }

  void cull_list(const Frame& frame, const Candidates& candidates) {
    std::size_t offered = 0;
    for (const std::span<const ObjectId> run : candidates.object_runs()) offered += run.size();
    if (offered * short_list_share >= scene_->object_count()) {
      stamps_.clear();
      for (const std::span<const ObjectId> run : candidates.object_runs()) {
        for (const ObjectId object : run) stamps_.insert(object);
      }
      all_offered_ = false;
      walk(frame);
      return;
    }
    order_.clear();
    for (const std::span<const ObjectId> run : candidates.object_runs()) {
      for (const ObjectId object : run) {
        order_.add(keys_.of(frame.objects.bounds[object], object), object);
      }
    }
    order_.sort();
    for (const ObjectOrder::Place& place : order_.places()) look_at_object(frame, place.object);
  }

  /// From the root of the hierarchy; of what it comes to, only candidates are looked at.
  void walk(const Frame& frame) {
    const auto& structure = followed_.structure();
    const auto object_count = static_cast<std::uint32_t>(scene_->object_count());
    const std::span<const SpatialNode> nodes = structure.nodes();
    queue_.clear();
    for (const ObjectId object : structure.unplaced()) push_object(frame, object);
    push_node(nodes, SpatialStructure::root);
    while (!queue_.empty()) {
      std::ranges::pop_heap(queue_, later);
      const std::uint32_t id = queue_.back().id;
      queue_.pop_back();
      if (id < object_count) {
        look_at_object(frame, id);
        continue;
      }
      const std::uint32_t index = id - object_count;
      const SpatialNode& node = nodes[index];
      double box_px = 0.0;
      const Verdict verdict = look(node.box, box_px);
      if (verdict == Verdict::hidden) {
        const std::uint32_t below = structure.count_below(index);
        count_hidden(below, static_cast<std::uint64_t>(below * mean_triangles_));
      }
      if (verdict != Verdict::visible) continue;
      for (const ObjectId object : structure.objects_at(index)) push_object(frame, object);
      for (std::uint32_t i = 0; i < node.child_count; ++i) push_node(nodes, node.first_child + i);
    }
  }

  void push_object(const Frame& frame, ObjectId object) {
    if (all_offered_ || stamps_.contains(object)) push(frame.objects.bounds[object], object);
  }
  void push_node(std::span<const SpatialNode> nodes, std::uint32_t index) {
    if (nodes[index].box.empty()) return;
    push(nodes[index].box, static_cast<std::uint32_t>(scene_->object_count()) + index);
  }
  void push(const Aabb& box, std::uint32_t id) {
    queue_.push_back({keys_.of(box, id), id});
    std::ranges::push_heap(queue_, later);
  }

  static bool later(const Item& a, const Item& b) {
    return a.key != b.key ? a.key > b.key : a.id > b.id;
  }

  /// Lists of fewer than one in so many objects are sorted instead of looked for in the hierarchy.
  static constexpr std::size_t short_list_share = 16;

  CullerInfo info_ = describe();
  int scale_;
  bool sleeps_;
  const Scene* scene_ = nullptr;
  DrawKeys keys_;
  OccluderBudget budget_;
  OccluderMeshes meshes_;
  FrameBuffer<Raster> buffer_;
  FollowedStructure<Bvh> followed_;
  FrustumWalk walk_;
  Worth worth_;
  double mean_triangles_ = 0.0;

  // Of one call of cull().
  Frustum frustum_;
  Worth::Work work_;
  bool all_offered_ = true;
  ObjectStamps stamps_;  // of what is offered, if that is a list
  std::vector<Item> queue_;
  ObjectOrder order_;
  std::vector<ObjectId> kept_;

  std::uint64_t queries_ = 0;
  std::uint64_t objects_hidden_ = 0;
  std::uint64_t triangles_drawn_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry depth_masked() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<MaskedCuller<DepthRaster>>(values);
          }};
}

}  // namespace cullers
}  // namespace vislab
