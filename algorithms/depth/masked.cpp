// depth.masked: tests before it draws: what nearer things hide is neither kept nor drawn, whole
// subtrees at one question.
//
// Idea: nodes and objects of a bounding-volume hierarchy come out of a queue near first. Each box
//   is compared with a depth buffer that is drawn by software as the walk goes on: hidden nodes are
//   dropped with all below them, visible objects are kept, and drawn into the buffer if they are
//   large enough to hide others. What is far larger than the rest is drawn before the walk
//   (large_occluders.h).
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
#include <optional>
#include <type_traits>

#include "algorithms/depth/draw_order.h"
#include "algorithms/depth/frame_buffer.h"
#include "algorithms/depth/frustum_walk.h"
#include "algorithms/depth/large_occluders.h"
#include "algorithms/depth/occluders.h"
#include "algorithms/depth/worth.h"
#include "common/culler/registry.h"
#include "common/culler/stamps.h"
#include "common/geometry/frustum.h"
#include "common/raster/box_silhouette.h"
#include "common/raster/masked_depth.h"
#include "common/spatial/bvh.h"
#include "common/spatial/followed_structure.h"

namespace vislab {
namespace {

using depth_culling::DrawKeys;
using depth_culling::DrawOrder;
using depth_culling::FrameBuffer;
using depth_culling::FrustumWalk;
using depth_culling::LargeOccluders;
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
  info.parameters = {
      ParameterSpec::choice(
          "buffer", "exact", {"exact", "masked", "masked_volume"}, build,
          "a depth for each pixel, or two layers and a mask for each tile, joined by the paper's "
          "rule of distances or by the volume they hide: less memory and work, and less is found "
          "hidden, also because boxes then count as their rectangles"),
      depth_culling::scale_parameter(), depth_culling::draw_order_parameter()};
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

/// Is a box that a rectangle leaves visible hidden where it is really seen? Only a buffer of pixels
/// can say.
bool hidden_in_outline(const DepthRaster& raster, const PixelRays& rays, const BoxWindow& rectangle,
                       const Aabb& box) {
  return hides_silhouette(raster.tiles(), rectangle, rays.planes_of(box));
}
bool hidden_in_outline(const MaskedDepth&, const PixelRays&, const BoxWindow&, const Aabb&) {
  return false;
}

/// With the other rule for layers.
class VolumeMaskedDepth : public MaskedDepth {
 public:
  VolumeMaskedDepth(const Viewport& size, const RasterOptions& options)
      : MaskedDepth(size, options, LayerMerge::volume) {}
};

template <typename Raster>
class MaskedCuller : public ICuller {
 public:
  explicit MaskedCuller(const ParameterValues& values)
      : scale_(depth_culling::read_scale(values)),
        coverage_(depth_culling::conservative_setup(scale_).coverage),
        sleeps_(values.boolean("sleep")),
        keys_(depth_culling::read_draw_order(values)),
        budget_(values),
        buffer_(scale_, {depth_culling::conservative_setup(scale_), false, 1}),
        followed_(limits_of(values)) {}

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    meshes_.build(scene);
    large_.build(scene);
    drawn_.resize(scene.object_count());
    followed_.build(scene);
    walk_.build(scene.object_count());
    stamps_.resize(scene.object_count());
    order_.reserve(scene.object_count());
    kept_.reserve(scene.object_count());
    emission_.reserve(scene.object_count());
    queue_.reserve(1024);
    small_.reserve(1024);
    stack_.reserve(256);
    mean_triangles_ = static_cast<double>(scene.triangle_count()) /
                      static_cast<double>(std::max<std::size_t>(1, scene.object_count()));
  }

  void reset(std::uint64_t seed) override {
    followed_.reset();
    large_.reset();
    worth_.reset();
    buffer_.forget();
    keys_.reset(seed);
  }

  void update(const Frame& frame, const Changes& changes) override {
    followed_.update(frame, changes);
    large_.update(frame, changes);
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
    emission_.sort();
    kept_.clear();
    for (const ObjectOrder::Place& place : emission_.places()) kept_.push_back(place.object);
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return meshes_.bytes() + large_.bytes() + drawn_.bytes() + followed_.bytes() + walk_.bytes() +
           stamps_.bytes() + order_.bytes() + emission_.bytes() +
           kept_.capacity() * sizeof(ObjectId) + queue_.capacity() * sizeof(Item) +
           small_.capacity() * sizeof(Small) + stack_.capacity() * sizeof(std::uint32_t) +
           buffer_.bytes();
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
  enum class Verdict { outside, hidden, visible, undecided };  // the last two are kept
  struct Small {
    BoxWindow place;
    Item item;
  };

  void start(const Frame& frame) {
    work_ = {};
    begins_ = buffer_.start(frame);
    if (begins_) {
      budget_.start();
      drawn_.clear();
      const Viewport& size = buffer_.raster().viewport();
      work_.buffer_pixels =
          static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
    }
    keys_.start(frame.camera);
    frustum_ = frustum_of(frame.camera);
    rays_.emplace(buffer_.raster().window(), coverage_);
    emission_.clear();
  }

  /// Where a box lies, and what is found of it by its rectangle.
  Verdict look(const Aabb& box, BoxWindow& place) {
    ++queries_;
    ++work_.queries;
    Raster& raster = buffer_.raster();
    switch (project_box(raster.window(), box, coverage_, place)) {
      case BoxPlace::outside:
        return Verdict::outside;
      case BoxPlace::undecided:
        for (const Plane& plane : frustum_.span()) {
          if (surely_outside(plane, box)) return Verdict::outside;
        }
        return Verdict::undecided;
      case BoxPlace::inside:
        break;
    }
    return raster.hides(place) ? Verdict::hidden : Verdict::visible;
  }

  /// Pixels of the frame that the box may cover.
  double pixels(Verdict verdict, const BoxWindow& place) const {
    if (verdict == Verdict::undecided) return 1e9;
    return static_cast<double>(place.x1 - place.x0) * (place.y1 - place.y0) * scale_ * scale_;
  }

  /// Of an object whose rectangle is not hidden.
  void take(const Frame& frame, ObjectId object, float key, Verdict verdict,
            const BoxWindow& place) {
    const Aabb& box = frame.objects.bounds[object];
    if (verdict == Verdict::visible && hidden_in_outline(buffer_.raster(), *rays_, place, box)) {
      count_hidden(1, scene_->triangle_count(object));
      return;
    }
    emission_.add(key, object);
    const std::uint32_t triangles = scene_->triangle_count(object);
    if (drawn_.contains(object) || !budget_.take(pixels(verdict, place), triangles)) return;
    const RasterDraw draw = meshes_.of(object, frame);
    buffer_.raster().draw({&draw, 1});
    count_drawn(object);
  }

  /// Not into layers: what far large things leave there is lost when near things come.
  void draw_large(const Frame& frame) {
    large_.draw(
        frame, meshes_, keys_, budget_, buffer_.raster(),
        [&](ObjectId object) { return all_offered_ || stamps_.contains(object); },
        [&](ObjectId object) { count_drawn(object); });
  }

  void count_drawn(ObjectId object) {
    drawn_.insert(object);
    const std::uint32_t triangles = scene_->triangle_count(object);
    work_.drawn_triangles += triangles;
    triangles_drawn_ += triangles;
  }

  void count_hidden(std::uint64_t objects, std::uint64_t triangles) {
    work_.hidden_objects += objects;
    work_.hidden_triangles += triangles;
    objects_hidden_ += objects;
  }
  void count_hidden_node(std::uint32_t index) {
    const std::uint32_t below = followed_.structure().count_below(index);
    count_hidden(below, static_cast<std::uint64_t>(below * mean_triangles_));
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
    for (const ObjectOrder::Place& at : order_.places()) {
      BoxWindow place;
      const Verdict verdict = look(frame.objects.bounds[at.object], place);
      if (verdict == Verdict::hidden) count_hidden(1, scene_->triangle_count(at.object));
      if (verdict >= Verdict::visible) take(frame, at.object, at.key, verdict, place);
    }
  }

  /// From the root of the hierarchy; of what it comes to, only candidates are looked at. What is
  /// too small to hide others waits until everything that is not has been drawn.
  void walk(const Frame& frame) {
    const auto& structure = followed_.structure();
    const auto object_count = static_cast<std::uint32_t>(scene_->object_count());
    const std::span<const SpatialNode> nodes = structure.nodes();
    // The other orders show what it is worth to have what is near, and large, first.
    if constexpr (std::is_same_v<Raster, DepthRaster>) {
      if (begins_ && keys_.order() == DrawOrder::near_first) draw_large(frame);
    }
    queue_.clear();
    small_.clear();
    for (const ObjectId object : structure.unplaced()) push_object(frame, object);
    push_node(nodes, SpatialStructure::root);
    while (!queue_.empty()) {
      std::ranges::pop_heap(queue_, later);
      const Item item = queue_.back();
      queue_.pop_back();
      const bool is_object = item.id < object_count;
      const std::uint32_t index = item.id - object_count;
      BoxWindow place;
      const Verdict verdict =
          look(is_object ? frame.objects.bounds[item.id] : nodes[index].box, place);
      if (verdict == Verdict::outside) continue;
      if (verdict == Verdict::hidden) {
        if (is_object) {
          count_hidden(1, scene_->triangle_count(item.id));
        } else {
          count_hidden_node(index);
        }
        continue;
      }
      if (pixels(verdict, place) < budget_.least_px()) {
        small_.push_back({place, item});
        continue;
      }
      if (is_object) {
        take(frame, item.id, item.key, verdict, place);
        continue;
      }
      if (hidden_by_outline(index, nodes[index].box, verdict, place)) continue;
      for (const ObjectId object : structure.objects_at(index)) push_object(frame, object);
      for (std::uint32_t i = 0; i < nodes[index].child_count; ++i) {
        push_node(nodes, nodes[index].first_child + i);
      }
    }
    for (const Small& small : small_) {
      if (small.item.id < object_count) {
        if (buffer_.raster().hides(small.place)) {
          count_hidden(1, scene_->triangle_count(small.item.id));
        } else {
          take(frame, small.item.id, small.item.key, Verdict::visible, small.place);
        }
      } else if (buffer_.raster().hides(small.place)) {
        count_hidden_node(small.item.id - object_count);
      } else {
        take_small_below(frame, small.item.id - object_count);
      }
    }
  }

  /// Objects at and below a node that is not hidden, none of which is drawn into the buffer.
  void take_small_below(const Frame& frame, std::uint32_t top) {
    const auto& structure = followed_.structure();
    const std::span<const SpatialNode> nodes = structure.nodes();
    stack_.clear();
    stack_.push_back(top);
    while (!stack_.empty()) {
      const std::uint32_t index = stack_.back();
      stack_.pop_back();
      BoxWindow place;
      for (const ObjectId object : structure.objects_at(index)) {
        if (!all_offered_ && !stamps_.contains(object)) continue;
        const Aabb& box = frame.objects.bounds[object];
        const Verdict verdict = look(box, place);
        if (verdict == Verdict::hidden) count_hidden(1, scene_->triangle_count(object));
        if (verdict >= Verdict::visible) {
          take(frame, object, keys_.of(box, object), verdict, place);
        }
      }
      for (std::uint32_t i = 0; i < nodes[index].child_count; ++i) {
        const std::uint32_t child = nodes[index].first_child + i;
        if (nodes[child].box.empty()) continue;
        const Verdict verdict = look(nodes[child].box, place);
        if (verdict == Verdict::hidden) count_hidden_node(child);
        if (verdict >= Verdict::visible &&
            !hidden_by_outline(child, nodes[child].box, verdict, place)) {
          stack_.push_back(child);
        }
      }
    }
  }

  /// Of a node that its rectangle leaves visible: is it hidden where it is really seen? Only asked
  /// where the answer is worth more than it costs: of many objects on few pixels.
  bool hidden_by_outline(std::uint32_t index, const Aabb& box, Verdict verdict,
                         const BoxWindow& place) {
    if (verdict != Verdict::visible || place.x1 - place.x0 > widest_outline_px ||
        place.y1 - place.y0 > widest_outline_px ||
        followed_.structure().count_below(index) < fewest_behind_outline ||
        !hidden_in_outline(buffer_.raster(), *rays_, place, box)) {
      return false;
    }
    count_hidden_node(index);
    return true;
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
  static constexpr int widest_outline_px = 64;
  static constexpr std::uint32_t fewest_behind_outline = 4;

  CullerInfo info_ = describe();
  int scale_;
  Coverage coverage_;
  bool sleeps_;
  const Scene* scene_ = nullptr;
  DrawKeys keys_;
  OccluderBudget budget_;
  OccluderMeshes meshes_;
  LargeOccluders large_;
  FrameBuffer<Raster> buffer_;
  FollowedStructure<Bvh> followed_;
  FrustumWalk walk_;
  Worth worth_;
  double mean_triangles_ = 0.0;

  // Of one call of cull().
  Frustum frustum_;
  Worth::Work work_;
  bool begins_ = true;  // it is the frame's first
  ObjectStamps drawn_;  // into the buffer, in this frame
  bool all_offered_ = true;
  ObjectStamps stamps_;  // of what is offered, if that is a list
  std::optional<PixelRays> rays_;
  std::vector<Item> queue_;
  std::vector<Small> small_;
  std::vector<std::uint32_t> stack_;  // nodes
  ObjectOrder order_;                 // of a list of candidates
  ObjectOrder emission_;
  std::vector<ObjectId> kept_;

  std::uint64_t queries_ = 0;
  std::uint64_t objects_hidden_ = 0;
  std::uint64_t triangles_drawn_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry depth_masked() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            const std::string& buffer = values.choice("buffer");
            if (buffer == "masked") return std::make_unique<MaskedCuller<MaskedDepth>>(values);
            if (buffer == "masked_volume") {
              return std::make_unique<MaskedCuller<VolumeMaskedDepth>>(values);
            }
            return std::make_unique<MaskedCuller<DepthRaster>>(values);
          }};
}

}  // namespace cullers
}  // namespace vislab
