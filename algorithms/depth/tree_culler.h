// What depth.hzb and depth.hzb_two_pass share: a hierarchy that is walked front to back against a
// depth buffer with a Z-pyramid, and the list of what was visible in the last frame, which is drawn
// into the buffer first.
//
// What holds for both:
// - An object that is tested after it was drawn is not hidden by itself: what hides is strictly
//   nearer than all of its box. So last frame's objects are tested like all others, and those that
//   are hidden now leave the list and are not emitted.
// - The list is a guess about occluders only. What is not offered in a call is not drawn for it,
//   and nothing follows for the next frame from its not being offered.
// - cull() may be called for several batches of a frame: the buffer begins with the frame, and what
//   was drawn in earlier calls stays in it.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "algorithms/depth/draw_order.h"
#include "algorithms/depth/frustum_walk.h"
#include "algorithms/depth/occludee_tree.h"
#include "algorithms/depth/occluders.h"
#include "algorithms/depth/pyramid_buffer.h"
#include "algorithms/depth/worth.h"
#include "common/culler/registry.h"
#include "common/culler/stamps.h"

namespace vislab::depth_culling {

/// The declaration as far as it is common; `hierarchy` is the default of that parameter.
CullerInfo tree_culler_info(const char* name, const char* hierarchy);
LooseOctree::Limits octree_limits(const ParameterValues& values);
Bvh::Limits bvh_limits(const ParameterValues& values);

template <typename Structure>
class TreeCuller : public ICuller {
 public:
  TreeCuller(CullerInfo info, const typename Structure::Limits& limits,
             const ParameterValues& values)
      : info_(std::move(info)),
        tree_(limits),
        scale_(read_scale(values)),
        sleeps_(values.boolean("sleep")),
        silhouettes_(values.boolean("silhouettes")),
        keys_(read_draw_order(values)),
        budget_(values) {}

  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    scene_ = &scene;
    meshes_.build(scene);
    tree_.build(scene);
    buffer_.emplace(scale_, context.threads);
    asleep_.build(scene.object_count());
    for (ObjectStamps* stamps : {&offered_, &drawn_, &seen_before_}) {
      stamps->resize(scene.object_count());
    }
    for (std::vector<ObjectId>* list : {&seen_, &seen_before_list_, &kept_}) {
      list->reserve(scene.object_count());
    }
    order_.reserve(scene.object_count());
    queue_.reserve(1024);
    first_node_ = static_cast<std::uint32_t>(scene.object_count());
    triangles_an_object_ =
        static_cast<double>(scene.triangle_count()) / static_cast<double>(scene.object_count());
  }

  void reset(std::uint64_t seed) override {
    tree_.reset();
    buffer_->forget();
    worth_.reset();
    keys_.reset(seed);
    frame_ = no_frame;
    seen_.clear();
    seen_before_list_.clear();
    seen_before_.clear();
  }

  void update(const Frame& frame, const Changes& changes) override {
    tree_.update(frame, changes);
    worth_.note(frame, changes);
    // What is hidden from all is no occluder.
    if (changes.hidden.empty()) return;
    drawn_.clear();
    for (const ObjectId object : changes.hidden) drawn_.insert(object);
    std::erase_if(seen_, [&](ObjectId object) { return drawn_.contains(object); });
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    everything_ = candidates.form() == Candidates::Form::everything;
    if (sleeps_ && !worth_.tries(frame)) {
      if (everything_) {
        asleep_.emit(tree_.structure(), frame, out);
      } else {
        for (const std::span<const ObjectId> run : candidates.object_runs()) out.objects(run);
      }
      return;
    }
    work_ = {};
    hidden_by_themselves_ = 0;
    start(frame);
    const std::size_t offered = take(frame, candidates);
    kept_.clear();
    find_visible(frame, candidates);
    // Each is offered once in a frame, so it is here once.
    seen_.insert(seen_.end(), kept_.begin(), kept_.end());
    out.objects(kept_);
    if (!everything_) {
      work_.hidden_objects = offered - outside_ - kept_.size();
      count_triangles(work_.hidden_objects - hidden_by_themselves_);
    }
    queries_ += work_.queries;
    drawn_triangles_ += work_.drawn_triangles;
    worth_.add(work_);
  }

  std::size_t bytes() const override {
    return meshes_.bytes() + tree_.bytes() + (buffer_ ? buffer_->bytes() : 0) + asleep_.bytes() +
           offered_.bytes() + drawn_.bytes() + seen_before_.bytes() + order_.bytes() +
           (seen_.capacity() + seen_before_list_.capacity() + kept_.capacity()) * sizeof(ObjectId) +
           queue_.capacity() * sizeof(Item) + draws_.capacity() * sizeof(RasterDraw) +
           drawn_places_.capacity() * sizeof(BoxWindow);
  }

  Counters counters() const override {
    return {{"queries", queries_},
            {"drawn_triangles", drawn_triangles_},
            {"pyramid_texels", buffer_ ? buffer_->texels_touched() : 0}};
  }

 protected:
  /// Fills kept(). The buffer is ready; what was drawn in earlier calls of the frame is in it.
  virtual void find_visible(const Frame& frame, const Candidates& candidates) = 0;

  std::vector<ObjectId>& kept() { return kept_; }

  /// Is an object hidden by now that was not when its place was found? By its rectangle: another
  /// look at silhouettes would cost more than it saves.
  bool hides_now(ObjectId object, const BoxWindow& place) {
    ++work_.queries;
    const bool hidden = buffer_->hides(place);
    if (hidden) count_hidden(object);
    return hidden;
  }

  /// Draws those candidates that were visible in the last frame, as the budget allows, and lets the
  /// pyramid follow.
  void draw_seen_before(const Frame& frame, const Candidates& candidates) {
    const auto draw_if_seen = [&](ObjectId object) {
      if (!seen_before_.contains(object)) return;
      BoxWindow place;
      const BoxVerdict verdict = look_at(frame.objects.bounds[object], place);
      if (verdict != BoxVerdict::outside) draw_later(object, verdict, place, frame);
    };
    if (everything_) {
      for (const ObjectId object : seen_before_list_) draw_if_seen(object);
    } else {
      for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
        for (const ObjectId object : run) draw_if_seen(object);
      });
    }
    draw_now();
  }

  /// The object is drawn by the next draw_now(), if it is large enough, the budget allows it, and
  /// it has not been drawn in this frame.
  void draw_later(ObjectId object, BoxVerdict verdict, const BoxWindow& place, const Frame& frame) {
    const BoxWindow where = verdict == BoxVerdict::undecided ? everywhere() : place;
    const std::uint32_t triangles = scene_->triangle_count(object);
    if (drawn_.contains(object) || !budget_.take(buffer_->frame_pixels(where), triangles)) return;
    drawn_.insert(object);
    draws_.push_back(meshes_.of(object, frame));
    drawn_places_.push_back(where);
    waiting_px_ += buffer_->frame_pixels(where);
    work_.drawn_triangles += triangles;
  }

  /// Returns whether anything was drawn.
  bool draw_now() {
    if (draws_.empty()) return false;
    buffer_->draw(draws_);
    if (draws_.size() > few_draws) {
      build_pyramid();
    } else {
      for (const BoxWindow& place : drawn_places_) follow(place);
    }
    draws_.clear();
    drawn_places_.clear();
    waiting_px_ = 0.0;
    return true;
  }

  /// Draws now if what waits covers a good part of the image: what comes later will meet it.
  /// Returns whether anything was drawn.
  bool draw_if_much() {
    return waiting_px_ * much_of_the_image >= buffer_->frame_pixels(everywhere()) && draw_now();
  }

  /// Walks all candidates that are not hidden or outside by themselves or by a node, in the order
  /// of the dial: see(object, verdict, place).
  template <typename See>
  void walk(const Frame& frame, const Candidates& candidates, See&& see) {
    const auto see_object = [&](ObjectId object) {
      BoxWindow place;
      const Aabb& box = frame.objects.bounds[object];
      BoxVerdict verdict = look_at(box, place);
      if (silhouettes_ && verdict == BoxVerdict::visible &&
          buffer_->hides_silhouette_of(box, place)) {
        verdict = BoxVerdict::hidden;
      }
      if (verdict == BoxVerdict::outside) {
        ++outside_;
      } else if (verdict == BoxVerdict::hidden) {
        count_hidden(object);
      } else {
        see(object, verdict, place);
      }
    };
    if (!everything_ && few_offered_) {
      order_.clear();
      for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
        for (const ObjectId object : run) {
          order_.add(keys_.of(frame.objects.bounds[object], object), object);
        }
      });
      order_.sort();
      for (const ObjectOrder::Place& next : order_.places()) see_object(next.object);
      return;
    }
    queue_.clear();
    push_objects(tree_.structure().unplaced(), frame);
    push_node(SpatialStructure::root);
    while (!queue_.empty()) {
      std::ranges::pop_heap(queue_, later);
      const std::uint32_t id = queue_.back().id;
      queue_.pop_back();
      if (id < first_node_) {
        see_object(id);
      } else {
        open(id - first_node_, frame);
      }
    }
  }

 private:
  using NodeIndex = SpatialStructure::NodeIndex;
  /// What waits to be looked at: an object by its id, node n as first_node_ + n.
  struct Item {
    float key;
    std::uint32_t id;
  };

  static constexpr std::uint64_t no_frame = ~std::uint64_t{0};
  /// Beyond so many draws at once the pyramid is built anew.
  static constexpr std::size_t few_draws = 16;
  static constexpr double much_of_the_image = 32.0;
  /// Lists shorter than this part of what is shown are sorted and tested one by one.
  static constexpr std::size_t short_list_part = 16;

  void build_pyramid() {
    buffer_->build_pyramid();
    build_waits_ = false;
  }

  /// Things of which it is not known where they are in the image come first, several of them. The
  /// pyramid is built once for them all; until then it knows less, and is right.
  void follow(const BoxWindow& drawn) {
    if (drawn == everywhere()) {
      build_waits_ = true;
    } else if (build_waits_) {
      build_pyramid();
    } else {
      buffer_->update_pyramid(drawn);
    }
  }

  /// An object that was asked about by itself: of a scene's objects, those that hide and are hidden
  /// may be of very different sizes.
  void count_hidden(ObjectId object) {
    ++hidden_by_themselves_;
    work_.hidden_triangles += scene_->triangle_count(object);
    if (everything_) ++work_.hidden_objects;
  }
  /// Of objects that were hidden with a node.
  void count_triangles(std::uint64_t objects) {
    work_.hidden_triangles +=
        static_cast<std::uint64_t>(static_cast<double>(objects) * triangles_an_object_);
  }

  BoxVerdict look_at(const Aabb& box, BoxWindow& place) {
    ++work_.queries;
    return buffer_->look_at(box, place);
  }

  void start(const Frame& frame) {
    tree_.start(frame);
    keys_.start(frame.camera);
    buffer_->start(frame);
    if (frame.index == frame_) return;
    frame_ = frame.index;
    budget_.start();
    drawn_.clear();
    build_waits_ = false;
    std::swap(seen_, seen_before_list_);
    seen_.clear();
    seen_before_.clear();
    for (const ObjectId object : seen_before_list_) seen_before_.insert(object);
    work_.buffer_pixels = buffer_->pixel_count();
  }

  /// Notes what is offered, if it is not everything. Returns how many objects.
  std::size_t take(const Frame& frame, const Candidates& candidates) {
    outside_ = 0;
    if (everything_) return frame.objects.shown.size();
    std::size_t count = 0;
    for (const std::span<const ObjectId> run : candidates.object_runs()) count += run.size();
    few_offered_ = count * short_list_part < frame.objects.shown.size();
    if (few_offered_) return count;
    offered_.clear();
    for (const std::span<const ObjectId> run : candidates.object_runs()) {
      for (const ObjectId object : run) offered_.insert(object);
    }
    return count;
  }

  /// Looks at a node; if something in it may be visible, what is in it is to be looked at.
  void open(NodeIndex node, const Frame& frame) {
    BoxWindow place;
    const BoxVerdict verdict = look_at(tree_.box(node), place);
    if (verdict == BoxVerdict::hidden && everything_) {
      work_.hidden_objects += tree_.count_below(node);
      count_triangles(tree_.count_below(node));
    }
    if (verdict == BoxVerdict::outside || verdict == BoxVerdict::hidden) return;
    push_objects(tree_.structure().objects_at(node), frame);
    const SpatialNode& opened = tree_.structure().nodes()[node];
    for (std::uint32_t i = 0; i < opened.child_count; ++i) push_node(opened.first_child + i);
  }

  void push_objects(std::span<const ObjectId> objects, const Frame& frame) {
    for (const ObjectId object : objects) {
      if (everything_ || offered_.contains(object)) push(frame.objects.bounds[object], object);
    }
  }
  void push_node(NodeIndex node) {
    if (!tree_.box(node).empty()) push(tree_.box(node), first_node_ + node);
  }
  void push(const Aabb& box, std::uint32_t id) {
    queue_.push_back({keys_.of(box, id), id});
    std::ranges::push_heap(queue_, later);
  }
  static bool later(const Item& a, const Item& b) {
    return a.key != b.key ? a.key > b.key : a.id > b.id;
  }
  BoxWindow everywhere() const { return buffer_->everywhere(); }

  CullerInfo info_;
  const Scene* scene_ = nullptr;
  OccludeeTree<Structure> tree_;
  int scale_;
  bool sleeps_;
  bool silhouettes_;
  DrawKeys keys_;
  OccluderBudget budget_;
  OccluderMeshes meshes_;
  std::optional<PyramidBuffer> buffer_;
  Worth worth_;
  FrustumWalk asleep_;
  double triangles_an_object_ = 0.0;
  std::uint32_t first_node_ = 0;

  std::uint64_t frame_ = no_frame;          // that seen_ and the buffer belong to
  std::vector<ObjectId> seen_;              // visible in this frame, so far
  std::vector<ObjectId> seen_before_list_;  // visible in the frame before
  ObjectStamps seen_before_;                // the same
  ObjectStamps drawn_;                      // into the buffer, in this frame

  // Of a call of cull().
  bool everything_ = true;
  bool few_offered_ = false;
  ObjectStamps offered_;     // unless it is everything or few
  std::size_t outside_ = 0;  // objects found outside one by one
  std::size_t hidden_by_themselves_ = 0;
  std::vector<ObjectId> kept_;
  ObjectOrder order_;
  std::vector<Item> queue_;  // a heap
  std::vector<RasterDraw> draws_;
  std::vector<BoxWindow> drawn_places_;
  bool build_waits_ = false;
  double waiting_px_ = 0.0;  // of the frame, by boxes, not drawn yet
  Worth::Work work_;

  std::uint64_t queries_ = 0;
  std::uint64_t drawn_triangles_ = 0;
};

/// A culler over the hierarchy that the parameter names.
template <template <typename> typename Culler>
std::unique_ptr<ICuller> make_tree_culler(const CullerInfo& info, const ParameterValues& values) {
  if (values.choice("hierarchy") == "octree") {
    return std::make_unique<Culler<LooseOctree>>(info, octree_limits(values), values);
  }
  return std::make_unique<Culler<Bvh>>(info, bvh_limits(values), values);
}

}  // namespace vislab::depth_culling
