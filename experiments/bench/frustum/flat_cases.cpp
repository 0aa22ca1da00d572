// frustum.flat against what else there is, on the same boxes and views.
#include <bit>
#include <cstdio>
#include <limits>
#include <map>

#include "algorithms/all_cullers.h"
#include "algorithms/frustum/flat_boxes.h"
#include "common/geometry/frustum.h"
#include "experiments/bench/frustum/bare_loop.h"
#include "experiments/bench/frustum/cases.h"
#include "experiments/bench/frustum/workload.h"
#ifdef VISLAB_HAS_FILAMENT
#include "algorithms/peers/filament_boxes.h"
#endif

namespace vislab {
namespace {

using frustum_culling::FlatBoxes;
using Words = std::vector<std::uint64_t>;

void set_bit(Words& words, std::size_t i) { words[i / 64] |= std::uint64_t{1} << (i % 64); }

/// What float sums of terms of up to 1,000 m may be off by.
constexpr double float_sum_error_m = 1e-3;

/// The same for planes taken from a matrix in float, in which near and far are a rest of 1 -
/// near / far.
double float_matrix_error_m(const Lens& lens) {
  return lens.far_m * (lens.far_m / lens.near_m) * std::numeric_limits<float>::epsilon();
}

/// One way to answer which boxes a view keeps.
class Way {
 public:
  virtual ~Way() = default;
  virtual void run(std::size_t view) = 0;
  /// The answer of the last run, one bit a box in the order of ids. Not timed.
  virtual Words answer() const = 0;
  /// How near to a plane a box may be misjudged, metres; 0 for exact ways.
  virtual double error_m(std::size_t /*view*/) const { return 0.0; }
};

/// frustum.flat's boxes without the culler around them.
class FlatWay : public Way {
 public:
  enum class Output { bits_by_slot, bits_by_id, ids };

  FlatWay(const FrustumWorkload& workload, FlatBoxes::Order order, Output output)
      : workload_(workload), boxes_(order), output_(output) {
    boxes_.build(workload.boxes());
    ids_.resize(workload.boxes().size());
    by_id_.resize((ids_.size() + 63) / 64);
  }

  void run(std::size_t view) override {
    bits_ = boxes_.cull(frustum_of(workload_.frame(view).camera), workload_.boxes());
    if (output_ == Output::bits_by_slot) return;
    kept_ = frustum_culling::select_ids(bits_, boxes_.objects_by_slot(), ids_.data());
    if (output_ == Output::ids) return;
    std::ranges::fill(by_id_, 0);
    for (const ObjectId object : std::span(ids_).first(kept_)) set_bit(by_id_, object);
  }

  Words answer() const override {
    if (output_ == Output::bits_by_id) return by_id_;
    Words words(by_id_.size(), 0);
    if (output_ == Output::ids) {
      for (const ObjectId object : std::span(ids_).first(kept_)) set_bit(words, object);
      return words;
    }
    for (ObjectId object = 0; object < ids_.size(); ++object) {
      const std::uint32_t slot = boxes_.slot_of(object);
      if ((bits_[slot / 64] >> (slot % 64) & 1) != 0) set_bit(words, object);
    }
    return words;
  }

 private:
  const FrustumWorkload& workload_;
  FlatBoxes boxes_;
  Output output_;
  std::span<const std::uint64_t> bits_;
  std::vector<ObjectId> ids_;
  std::size_t kept_ = 0;
  Words by_id_;
};

/// bare_loop(), with or without the list of ids that a renderer wants.
class BareWay : public Way {
 public:
  BareWay(const FrustumWorkload& workload, bool ids) : workload_(workload), wants_ids_(ids) {
    const std::size_t count = workload.boxes().size();
    const std::size_t padded = (count + 63) / 64 * 64;
    for (std::size_t row = 0; row < 6; ++row) {
      const auto axis = static_cast<int>(row % 3);
      arrays_[row].assign(padded, std::numeric_limits<float>::max() * (row < 3 ? 1.0F : -1.0F));
      for (std::size_t i = 0; i < count; ++i) {
        const Aabb& box = workload.boxes()[i];
        arrays_[row][i] = row < 3 ? box.min[axis] : box.max[axis];
      }
      rows_[row] = arrays_[row].data();
    }
    bits_.resize(padded / 64);
    ids_.resize(padded);
  }

  void run(std::size_t view) override {
    const Frustum frustum = frustum_of(workload_.frame(view).camera);
    float planes[6][4];
    for (std::size_t i = 0; i < 6; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        planes[i][axis] = static_cast<float>(frustum.planes[i].normal[axis]);
      }
      planes[i][3] = static_cast<float>(frustum.planes[i].d);
    }
    bare_loop(planes, rows_.data(), arrays_[0].size(), bits_.data());
    if (!wants_ids_) return;
    kept_ = 0;
    for (std::size_t w = 0; w < bits_.size(); ++w) {
      for (std::uint64_t left = bits_[w]; left != 0; left &= left - 1) {
        ids_[kept_++] =
            static_cast<ObjectId>(w * 64) + static_cast<ObjectId>(std::countr_zero(left));
      }
    }
  }

  Words answer() const override {
    if (!wants_ids_) return bits_;
    Words words(bits_.size(), 0);
    for (const ObjectId object : std::span(ids_).first(kept_)) set_bit(words, object);
    return words;
  }
  double error_m(std::size_t /*view*/) const override { return float_sum_error_m; }

 private:
  const FrustumWorkload& workload_;
  bool wants_ids_;
  std::array<std::vector<float>, 6> arrays_;
  std::array<const float*, 6> rows_{};
  Words bits_;
  std::vector<ObjectId> ids_;
  std::size_t kept_ = 0;
};

#ifdef VISLAB_HAS_FILAMENT
/// Filament's loop: a byte an object, its array of results cleared.
class FilamentWay : public Way {
 public:
  explicit FilamentWay(const FrustumWorkload& workload) : workload_(workload) {
    boxes_.build(workload.boxes());
  }
  void run(std::size_t view) override { bytes_ = boxes_.cull(workload_.frame(view).camera); }
  Words answer() const override {
    Words words((bytes_.size() + 63) / 64, 0);
    for (std::size_t i = 0; i < bytes_.size(); ++i) {
      if (bytes_[i] != 0) set_bit(words, i);
    }
    return words;
  }
  double error_m(std::size_t view) const override {
    return float_matrix_error_m(workload_.frame(view).camera.lens);
  }

 private:
  const FrustumWorkload& workload_;
  peers::FilamentBoxes boxes_;
  std::span<const std::uint8_t> bytes_;
};
#endif

/// A culler of the registry, as a chain would call it.
class CullerWay : public Way {
 public:
  CullerWay(const FrustumWorkload& workload, const std::string& spec) : workload_(workload) {
    register_all_cullers(registry_);
    culler_ = registry_.make(spec);
    BuildContext context;
    context.cullers = &registry_;
    culler_->build(workload.scene(), context);
    culler_->reset(1);
  }
  void run(std::size_t view) override {
    sink_.runs.clear();
    culler_->cull(workload_.frame(view), Candidates::everything(), sink_);
  }
  Words answer() const override {
    Words words((workload_.boxes().size() + 63) / 64, 0);
    for (const auto run : sink_.runs) {
      for (const ObjectId object : run) set_bit(words, object);
    }
    return words;
  }
  double error_m(std::size_t view) const override {
    if (culler_->info().guarantee == Guarantee::conservative) return 0.0;
    if (culler_->info().name != "peer.filament") return float_sum_error_m;
    return float_matrix_error_m(workload_.frame(view).camera.lens);
  }

 private:
  struct Sink : DrawSink {
    std::vector<std::span<const ObjectId>> runs;

    void everything() override { throw std::logic_error("a culler of the bench kept everything"); }
    void objects(std::span<const ObjectId> ids) override { runs.push_back(ids); }
    void ranges(std::span<const TriangleRange>) override {
      throw std::logic_error("a culler of the bench emitted triangles");
    }
    void flush() override {}
  };

  const FrustumWorkload& workload_;
  Registry registry_;
  std::unique_ptr<ICuller> culler_;
  Sink sink_;
};

using MakeWay = std::function<std::unique_ptr<Way>(const FrustumWorkload&)>;

/// All views, one after the other, in one call.
class FlatContest : public Contest {
 public:
  FlatContest(std::shared_ptr<const FrustumWorkload> workload, const MakeWay& ours,
              const MakeWay& theirs)
      : workload_(std::move(workload)), ours_(ours(*workload_)), theirs_(theirs(*workload_)) {}

  void ours() override { run_all(*ours_); }
  void theirs() override { run_all(*theirs_); }
  bool equal() override { return is_right(*ours_) && is_right(*theirs_); }
  /// Millions of boxes.
  double work() const override {
    return static_cast<double>(workload_->boxes().size() * workload_->view_count()) * 1e-6;
  }

 private:
  void run_all(Way& way) {
    for (std::size_t view = 0; view < workload_->view_count(); ++view) way.run(view);
  }
  bool is_right(Way& way) {
    for (std::size_t view = 0; view < workload_->view_count(); ++view) {
      way.run(view);
      if (!workload_->is_right(view, way.answer(), way.error_m(view))) return false;
    }
    return true;
  }

  std::shared_ptr<const FrustumWorkload> workload_;
  std::unique_ptr<Way> ours_;
  std::unique_ptr<Way> theirs_;
};

MakeWay flat(FlatBoxes::Order order, FlatWay::Output output) {
  return [=](const FrustumWorkload& w) { return std::make_unique<FlatWay>(w, order, output); };
}
MakeWay bare(bool ids) {
  return [=](const FrustumWorkload& w) { return std::make_unique<BareWay>(w, ids); };
}
MakeWay culler(const std::string& spec) {
  return [=](const FrustumWorkload& w) { return std::make_unique<CullerWay>(w, spec); };
}

}  // namespace

void add_flat_cases(std::vector<BenchCase>& cases) {
  using Order = FlatBoxes::Order;
  using Output = FlatWay::Output;
  Registry registry;
  register_all_cullers(registry);
  const auto has = [&](std::string_view name) { return registry.entries().contains(name); };
  // Cases of one size share their boxes as long as one of them is at hand.
  const auto shared = std::make_shared<std::map<std::size_t, std::weak_ptr<FrustumWorkload>>>();
  const auto workload = [shared](std::size_t count) {
    std::shared_ptr<FrustumWorkload> made = (*shared)[count].lock();
    if (!made) {
      made = std::make_shared<FrustumWorkload>(count);
      (*shared)[count] = made;
    }
    return made;
  };
  for (const std::size_t count : {10'000, 100'000, 1'000'000}) {
    const std::string boxes = std::to_string(count) + " boxes";
    const auto add = [&](const std::string& bench, const std::string& output,
                         const std::string& against, const MakeWay& ours, const MakeWay& theirs) {
      cases.push_back({bench, boxes + ", " + output, "Mbox/s", against, [=] {
                         return std::make_unique<FlatContest>(workload(count), ours, theirs);
                       }});
    };
    const MakeWay groups = flat(Order::groups, Output::bits_by_slot);
    const MakeWay off = flat(Order::ids, Output::bits_by_slot);
    const std::string flat_off = "frustum.flat[early_out=off]";
#ifdef VISLAB_HAS_FILAMENT
    const MakeWay filament = [](const FrustumWorkload& w) {
      return std::make_unique<FilamentWay>(w);
    };
    add("frustum.flat", "bitmask", "peer.filament", groups, filament);
    add(flat_off, "bitmask", "peer.filament", off, filament);
#endif
    if (bare_loop_runs()) {
      add("frustum.flat", "bitmask", "bare AVX2 loop", groups, bare(false));
      add("frustum.flat", "bitmask by id", "bare AVX2 loop",
          flat(Order::groups, Output::bits_by_id), bare(false));
      add("frustum.flat", "ids", "bare AVX2 loop", flat(Order::groups, Output::ids), bare(true));
      add(flat_off, "bitmask", "bare AVX2 loop", off, bare(false));
      add(flat_off, "ids", "bare AVX2 loop", flat(Order::ids, Output::ids), bare(true));
    }
    add("frustum.flat", "bitmask", flat_off, groups, off);
    add("frustum.flat", "culler", "frustum.flat[kernel=scalar]", culler("frustum.flat"),
        culler("frustum.flat[kernel=scalar]"));
    for (const char* peer : {"peer.filament", "peer.bullet"}) {
      if (has(peer)) add("frustum.flat", "culler", peer, culler("frustum.flat"), culler(peer));
    }
  }
  if (!bare_loop_runs()) {
    std::fprintf(stderr, "frustum.flat: no contest with the bare AVX2 loop: no AVX2 here\n");
  }
  for (const char* peer : {"peer.filament", "peer.bullet"}) {
    if (!has(peer)) {
      std::fprintf(stderr, "frustum.flat: no contest with %s: it is not built\n", peer);
    }
  }
}

}  // namespace vislab
