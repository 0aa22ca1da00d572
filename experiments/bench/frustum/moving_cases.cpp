// Updating and culling when a share of the objects moves: frustum.bvh against a full rebuild of
// itself, and against frustum.flat; and that rebuild against Embree's.
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "common/geometry/random.h"
#include "common/spatial/wide_bvh.h"
#include "experiments/bench/frustum/cases.h"
#include "experiments/bench/frustum/culler_side.h"
#include "experiments/bench/frustum/workload.h"

namespace vislab {
namespace {

constexpr std::size_t object_count = 100'000;

/// The workload's boxes, of which a share moves straight on, a metre a frame, for 32 frames and
/// then back: far enough for neighbours to part.
class Motion {
 public:
  Motion(std::shared_ptr<const FrustumWorkload> workload, double share)
      : workload_(std::move(workload)) {
    Random random(7);
    std::vector<glm::vec3> ways;
    for (ObjectId object = 0; object < object_count; ++object) {
      if (random.uniform() >= share) continue;
      changes_.moved.push_back(object);
      changes_.transforms.push_back(workload_->scene().objects[object].transform);
      const double x = random.uniform(-1.0, 1.0);
      const double y = random.uniform(-1.0, 1.0);
      ways.push_back(glm::normalize(glm::vec3(x, y, random.uniform(-1.0, 1.0))));
    }
    for (std::size_t step = 0; step < boxes_.size(); ++step) {
      for (std::size_t i = 0; i < ways.size(); ++i) {
        const Aabb& box = workload_->boxes()[changes_.moved[i]];
        const glm::vec3 way = ways[i] * static_cast<float>(step);
        boxes_[step].push_back({box.min + way, box.max + way});
      }
    }
  }

  const FrustumWorkload& workload() const { return *workload_; }
  const Changes& changes() const { return changes_; }
  /// What moved lies there at that frame.
  void place(std::size_t frame, std::vector<Aabb>& bounds) const {
    const std::size_t phase = frame % (2 * boxes_.size());
    const std::size_t step = phase < boxes_.size() ? phase : 2 * boxes_.size() - 1 - phase;
    for (std::size_t i = 0; i < changes_.moved.size(); ++i) {
      bounds[changes_.moved[i]] = boxes_[step][i];
    }
  }

 private:
  std::shared_ptr<const FrustumWorkload> workload_;
  Changes changes_;
  std::array<std::vector<Aabb>, 32> boxes_;
};

/// A culler that follows the motion, a frame a call. The new boxes are written within the call, as
/// a scene that has just moved leaves them in the cache.
class MovingSide {
 public:
  MovingSide(const Motion& motion, const std::string& spec)
      : motion_(motion),
        culler_(spec, motion.workload().scene()),
        bounds_(motion.workload().boxes().begin(), motion.workload().boxes().end()) {}

  void step() {
    ++frame_;
    motion_.place(frame_, bounds_);
    const Frame frame = now();
    culler_.update(frame, motion_.changes());
    culler_.cull(frame);
  }

  /// Does the answer of the last step agree with the definition?
  bool is_right() const {
    const Frustum frustum = frustum_of(now().camera);
    std::vector<ObjectId> answer = joined(culler_.runs());
    std::ranges::sort(answer);
    std::vector<ObjectId> expected;
    for (ObjectId object = 0; object < bounds_.size(); ++object) {
      const bool outside = std::ranges::any_of(frustum.span(), [&](const Plane& plane) {
        return surely_outside(plane, bounds_[object]);
      });
      if (!outside) expected.push_back(object);
    }
    return answer == expected;
  }

 private:
  Frame now() const {
    Frame frame = motion_.workload().frame(frame_ % motion_.workload().view_count());
    frame.index = frame_;
    frame.objects.bounds = bounds_;
    return frame;
  }

  const Motion& motion_;
  CullerSide culler_;
  std::vector<Aabb> bounds_;
  std::size_t frame_ = 0;
};

class MovingContest : public Contest {
 public:
  MovingContest(std::shared_ptr<const FrustumWorkload> workload, double share,
                const std::string& ours, const std::string& theirs)
      : motion_(std::move(workload), share), ours_(motion_, ours), theirs_(motion_, theirs) {}

  void ours() override { ours_.step(); }
  void theirs() override { theirs_.step(); }
  bool equal() override {
    for (int step = 0; step < 40; ++step) {
      ours_.step();
      theirs_.step();
      if (!ours_.is_right() || !theirs_.is_right()) return false;
    }
    return true;
  }

 private:
  Motion motion_;
  MovingSide ours_, theirs_;
};

/// The rebuild that moving objects would need each frame, against Embree's fastest.
class BuildContest : public Contest {
 public:
  explicit BuildContest(std::shared_ptr<const FrustumWorkload> workload)
      : workload_(std::move(workload)), device_(rtcNewDevice("threads=1")) {
    bvh_.build(workload_->boxes(), WideBvh::Order::median);
    for (std::size_t i = 0; i < workload_->boxes().size(); ++i) {
      const Aabb& box = workload_->boxes()[i];
      primitives_.push_back({box.min.x, box.min.y, box.min.z, 0, box.max.x, box.max.y, box.max.z,
                             static_cast<unsigned>(i)});
    }
  }
  ~BuildContest() override {
    if (tree_ != nullptr) rtcReleaseBVH(tree_);
    rtcReleaseDevice(device_);
  }
  BuildContest(const BuildContest&) = delete;
  BuildContest& operator=(const BuildContest&) = delete;

  void ours() override { bvh_.rebuild(workload_->boxes(), WideBvh::Order::morton); }

  void theirs() override {
    if (tree_ != nullptr) rtcReleaseBVH(tree_);
    tree_ = rtcNewBVH(device_);
    shuffled_ = primitives_;  // the builder sorts them in place
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.buildQuality = RTC_BUILD_QUALITY_LOW;
    arguments.maxBranchingFactor = 8;
    arguments.maxLeafSize = 8;
    arguments.bvh = tree_;
    arguments.primitives = shuffled_.data();
    arguments.primitiveCount = shuffled_.size();
    arguments.primitiveArrayCapacity = shuffled_.size();
    arguments.createNode = [](RTCThreadLocalAllocator allocator, unsigned, void*) -> void* {
      Part* node = new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node{};
      return node;
    };
    arguments.setNodeChildren = [](void* node, void** children, unsigned count, void*) {
      auto* at = static_cast<Node*>(static_cast<Part*>(node));
      at->count = count;
      for (unsigned i = 0; i < count; ++i) at->children[i] = static_cast<Part*>(children[i]);
    };
    arguments.setNodeBounds = [](void* node, const RTCBounds** bounds, unsigned count, void*) {
      auto* at = static_cast<Node*>(static_cast<Part*>(node));
      for (unsigned i = 0; i < count; ++i) at->bounds[i] = *bounds[i];
    };
    arguments.createLeaf = [](RTCThreadLocalAllocator allocator,
                              const RTCBuildPrimitive* primitives, std::size_t count,
                              void*) -> void* {
      auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(Leaf), alignof(Leaf))) Leaf{};
      leaf->is_leaf = true;
      leaf->count = static_cast<unsigned>(count);
      for (std::size_t i = 0; i < count; ++i) leaf->ids[i] = primitives[i].primID;
      return static_cast<Part*>(leaf);
    };
    root_ = static_cast<const Part*>(rtcBuildBVH(&arguments));
  }

  /// Both hold every object.
  bool equal() override {
    bvh_.audit(workload_->boxes());
    std::vector<ObjectId> ids;
    gather(root_, ids);
    std::ranges::sort(ids);
    for (ObjectId object = 0; object < ids.size(); ++object) {
      if (ids[object] != object) return false;
    }
    return ids.size() == workload_->boxes().size();
  }

 private:
  struct Part {
    bool is_leaf = false;
    unsigned count = 0;
  };
  struct alignas(16) Node : Part {
    std::array<Part*, 8> children;
    std::array<RTCBounds, 8> bounds;
  };
  struct alignas(16) Leaf : Part {
    std::array<ObjectId, 8> ids;
  };

  static void gather(const Part* part, std::vector<ObjectId>& ids) {
    for (unsigned i = 0; i < part->count; ++i) {
      if (part->is_leaf) {
        ids.push_back(static_cast<const Leaf*>(part)->ids[i]);
      } else {
        gather(static_cast<const Node*>(part)->children[i], ids);
      }
    }
  }

  std::shared_ptr<const FrustumWorkload> workload_;
  WideBvh bvh_;
  RTCDevice device_;
  RTCBVH tree_ = nullptr;
  const Part* root_ = nullptr;
  std::vector<RTCBuildPrimitive> primitives_, shuffled_;
};

}  // namespace

void add_moving_cases(std::vector<BenchCase>& cases) {
  const auto shared = std::make_shared<std::weak_ptr<FrustumWorkload>>();
  const auto workload = [shared] {
    std::shared_ptr<FrustumWorkload> made = shared->lock();
    if (!made) *shared = made = std::make_shared<FrustumWorkload>(object_count);
    return made;
  };
  const std::string boxes = std::to_string(object_count) + " boxes, ";
  cases.push_back({"frustum.bvh", boxes + "rebuild", "ms", "rtcBuildBVH at low quality",
                   [=] { return std::make_unique<BuildContest>(workload()); }});
  for (const char* percent : {"0.1", "1", "10", "30", "100"}) {
    const double share = std::stod(percent) / 100.0;
    const auto add = [&](const std::string& ours, const std::string& theirs) {
      cases.push_back({ours, boxes + percent + " % move", "us", theirs, [=] {
                         return std::make_unique<MovingContest>(workload(), share, ours, theirs);
                       }});
    };
    add("frustum.bvh", "frustum.bvh[motion=rebuild]");
    add("frustum.bvh", "frustum.flat");
    add("frustum.bvh", "frustum.flat[early_out=off]");
    for (const std::string motion : {"refit", "enlarge", "reinsert"}) {
      // Some ten microseconds an object: seconds a frame.
      if (motion == "reinsert" && share > 0.1) continue;
      add("frustum.bvh[layout=binary,motion=" + motion + "]", "frustum.bvh");
    }
  }
}

}  // namespace vislab
